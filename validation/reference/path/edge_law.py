"""What the edge asks for: a residual that rises with the radius through zero where the edge is stable.

An edge that opens takes up ``work``, or ``w(v)``; one that closes ``closing``. In between it rests, as it
does at the rim of a flat face as long as it does not open, and where it has a rate law at fixed time. Without
adhesion no tension is left at the edge and no overlap next to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact_scene import Adhesion
from validation.reference.path.trial import Arrival, Trial
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

    def at_rim(self, radius: float) -> bool:
        """Whether the edge is that of the indenter."""
        return radius >= self.rim * (1.0 - 1e-12)

    def rests(self, radius: float) -> bool:
        """Whether an edge at that radius may rest at a range of loads."""
        adhesion = self.adhesion
        return radius == 0.0 or self.at_rim(radius) or (adhesion is not None and not adhesion.reversible)

    def pulls(self, trial: Trial, arrival: Arrival, at_once: bool = False, slack: float = 0.0) -> float:
        """How far a resting edge is beyond its range: positive opens, negative closes, 0 rests."""
        value, adhesion = arrival.integral, self.adhesion
        if adhesion is None:  # a flat face, or an indenter that has not touched yet
            return max(-value, 0.0) if trial.radius > 0.0 else min(-arrival.depth, 0.0)
        taken = adhesion.opening(math.inf) if at_once else adhesion.work  # no speed is infinite
        opens, closes = value / taken - 1.0, value / adhesion.closing - 1.0
        if opens > slack:
            return opens
        return closes if closes < -slack and not self.at_rim(trial.radius) else 0.0

    def residual(self, trial: Trial, arrival: Arrival, at_once: bool) -> float:
        """Residual at an edge that has come to the end of a trial; ``at_once``: time stands."""
        value, adhesion = arrival.integral, self.adhesion
        if not math.isfinite(value):
            return math.nan
        if adhesion is None:
            if trial.direction == 0.0:  # it rests where it is pressed behind and open ahead
                overlap = 0.0 if self.at_rim(trial.radius) else trial.overlap(arrival.motion)
                value = min(value, 0.0) + max(overlap, 0.0)
            widest = max(trial.radius, trial.state.radius)
            strain = abs(arrival.depth) + float(trial.body.transform(np.array([widest]))[0])
            return -value / strain if strain > 0.0 else 0.0
        if trial.direction == 0.0 and self.rests(trial.radius):
            return self.pulls(trial, arrival, at_once)
        if trial.direction > 0.0:
            return value / adhesion.closing - 1.0
        if not self.rated or trial.direction == 0.0:
            return value / adhesion.work - 1.0
        speed = 0.0 if at_once else -trial.speed(arrival)
        if at_once or not arrival.duration > 0.0 or not 0.0 <= speed < math.inf:  # in no time, or less
            return value / adhesion.opening(math.inf) - 1.0
        return self._rated(adhesion, value, speed, arrival.duration)

    def _rated(self, adhesion: Adhesion, value: float, speed: float, duration: float) -> float:
        """How far an opening edge is from its rate law, in work and in travel over the zone at once.

        ``I - w(v)`` has an infinite slope at rest, ``v(I) - v`` where the law saturates. Their harmonic sum
        has the smaller of both: a slow edge is told by its travel, a quick one by its work.
        """
        travel = (self.allowed_speed(value) - speed) * duration / self.zone
        if value <= adhesion.work:
            return travel + min(value / adhesion.closing - 1.0, 0.0)  # it would close
        work = (value - adhesion.opening(max(speed, 0.0))) / adhesion.work
        return work / (1.0 + work / travel) if work * travel > 0.0 else 0.0
