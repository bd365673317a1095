"""The usual test in one entry: approach until a force is reached, dwell, retract."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from contact_scene.errors import SceneError
from contact_scene.segment import Segment, Step
from contact_scene.trigger import Trigger
from contact_scene.value_checks import finite, not_negative, positive


@dataclass(frozen=True)
class Approach(Step):
    """Approach at ``rate`` until ``force``, stay for ``dwell``, go back at speed ``retract``.

    Parameters
    ----------
    rate : float
        Speed of the approach.
    force : float
        Force at which it ends.
    dwell : float
        Time for which penetration (or stage) stays.
    retract : float, optional
        Speed of the retraction; default: ``rate``.
    to : float, optional
        Greatest penetration (or position of the stage) of the approach; a run that gets there without the
        force ends, and says so. Default: a bound before which the force is reached for certain, which the
        scene states where it can (:mod:`contact_scene.approach_bound`).
    away : float, optional
        Where the retraction ends, if the contact is not lost before; default: ``-to``, as far above the
        surface as ``to`` is below.
    """

    rate: float
    force: float
    to: float | None = None
    dwell: float = 0.0
    retract: float | None = None
    away: float | None = None
    kind: ClassVar[str] = "approach"

    def __post_init__(self) -> None:
        for key, check in (("rate", positive), ("force", finite), ("dwell", not_negative)):
            object.__setattr__(self, key, check(getattr(self, key), key))
        retract = self.rate if self.retract is None else positive(self.retract, "retract")
        object.__setattr__(self, "retract", retract)
        if self.away is not None:
            object.__setattr__(self, "away", finite(self.away, "away"))
        if self.to is None:
            return
        to = positive(self.to, "to")
        object.__setattr__(self, "to", to)
        away = -to if self.away is None else self.away
        object.__setattr__(self, "away", away)
        if away >= to:
            raise SceneError("away", f"got {away!r}", f"less than to = {to:g}")

    @property
    def trigger(self) -> Trigger:
        """What ends the approach."""
        return Trigger("force", self.force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """No control law of its own: it stands for other steps once its bound is known.

        Parameters
        ----------
        time : float
            At which it starts.
        penetration, force : float
            From which it starts.

        Raises
        ------
        SceneError
            Always.
        """
        raise SceneError("to", "is missing in a loading without a scene", "a bound of the approach")
