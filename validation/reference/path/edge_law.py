"""What the edge asks for.

An edge that opens takes up ``work``, or ``w(v)``; one that closes ``closing``. In between it rests, as it
does at the rim of a flat face as long as it does not open, and where it has a rate law at fixed time. Without
adhesion no tension is left at the edge and no overlap next to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact_scene import Adhesion
from validation.reference.path.numerics import ROUNDING
from validation.reference.rated_edge import opening_speed


@dataclass(frozen=True)
class EdgeLaw:
    """``rim``: radius beyond which there is no indenter; ``tip``: of a plane tip without adhesion, or 0."""

    adhesion: Adhesion | None
    rim: float = math.inf
    tip: float = 0.0

    @property
    def zone(self) -> float:
        """Length of the process zone; 0 without adhesion."""
        return self.adhesion.zone if self.adhesion else 0.0

    @property
    def cohesive(self) -> float:
        """Stress of a zone whose length follows from it; 0 of one whose length is fixed."""
        return (self.adhesion.stress or 0.0) if self.adhesion else 0.0

    @property
    def rated(self) -> bool:
        """Whether an opening edge takes up what its speed tells."""
        return self.adhesion is not None and self.adhesion.rate is not None

    @property
    def folds(self) -> bool:
        """Whether an edge that opens may run away: what it takes up has a bound at any speed."""
        return self.adhesion is not None and math.isfinite(self.adhesion.opening(math.inf))

    def allowed_speed(self, integral: float) -> float:
        """Speed at which the rate law lets an edge open."""
        return opening_speed(self.adhesion, integral) if self.adhesion else 0.0

    def strain(self, radius: float, modulus: float) -> float:
        """Size of ``w^`` at an edge that closes; 0 without adhesion."""
        return math.sqrt(2.0 * math.pi * radius * self.adhesion.closing / modulus) if self.adhesion else 0.0

    def at_rim(self, radius: float) -> bool:
        """Whether the edge is that of the indenter."""
        return radius >= self.rim * (1.0 - ROUNDING)

    def rests(self, radius: float) -> bool:
        """Whether an edge at that radius may rest at a range of loads."""
        adhesion = self.adhesion
        return radius == 0.0 or self.at_rim(radius) or (adhesion is not None and not adhesion.reversible)

    def closing(self, integral: float) -> float:
        """Residual of an edge that closes."""
        return integral / self.adhesion.closing - 1.0 if self.adhesion else math.nan

    def opening(self, integral: float, speed: float, duration: float) -> float:
        """Residual of an edge that opens, at a speed that counts as infinite if nothing can tell it.

        ``I - w(v)`` has an infinite slope at rest, ``v(I) - v`` where the law saturates. Their harmonic sum
        has the smaller of both: a slow edge is told by its travel, a quick one by its work.
        """
        adhesion = self.adhesion
        if adhesion is None:
            return math.nan
        if not self.rated:
            return integral / adhesion.work - 1.0
        if not duration > 0.0 or not 0.0 <= speed < math.inf:  # in no time, or less
            return integral / adhesion.opening(math.inf) - 1.0
        travel = (self.allowed_speed(integral) - speed) * duration / self.zone
        if integral <= adhesion.work:
            return travel + min(integral / adhesion.closing - 1.0, 0.0)  # it would close
        work = (integral - adhesion.opening(speed)) / adhesion.work
        return work / (1.0 + work / travel) if work * travel > 0.0 else 0.0

    def taken_up(self, speed: float, closes: bool, released: float = 0.0) -> float:
        """Energy per area at an edge; where its law has no bound at any speed, what is ``released``."""
        if self.adhesion is None:
            return 0.0
        taken = self.adhesion.closing if closes else self.adhesion.opening(max(speed, 0.0))
        return taken if math.isfinite(taken) else released
