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
        Where the retraction ends, if the contact is not lost before; default: as far above the surface as
        ``to`` is below, and where adhesion holds farther, as far as the scene knows it to hold at most.
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
        object.__setattr__(self, "to", positive(self.to, "to"))
        if self.away is not None and self.away >= self.to:
            raise SceneError("away", f"got {self.away!r}", f"less than to = {self.to:g}")

    @property
    def is_bounded(self) -> bool:
        """Whether it is known how far the approach and the retraction go."""
        return self.to is not None and self.away is not None

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
        key = "to" if self.to is None else "away"
        raise SceneError(key, "is missing in a loading without a scene", "a bound of the approach")
