"""The usual test in one entry: approach until a force is reached, dwell, retract."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact_scene.errors import SceneError, finite, not_negative, positive


@dataclass(frozen=True)
class Approach:
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
        Speed of the retraction; default (0): ``rate``.
    to : float
        Greatest penetration (or position of the stage) of the approach; a run that gets there without the
        force ends, and says so.
    away : float, optional
        Where the retraction ends, if the contact is not lost before; default: ``-to``, as far above the
        surface as ``to`` is below.
    """

    rate: float
    force: float
    to: float
    dwell: float = 0.0
    retract: float = 0.0
    away: float = math.nan
    kind: ClassVar[str] = "approach"

    def __post_init__(self) -> None:
        for key, check in (("rate", positive), ("force", finite), ("to", positive), ("dwell", not_negative)):
            object.__setattr__(self, key, check(getattr(self, key), key))
        retract = positive(self.retract, "retract") if self.retract != 0.0 else self.rate
        away = finite(self.away, "away") if self.away == self.away else -self.to
        if away >= self.to:
            raise SceneError("away", f"got {away!r}", f"less than to = {self.to:g}")
        object.__setattr__(self, "retract", retract)
        object.__setattr__(self, "away", away)
