"""Step sizes: dyadic divisions of an interval, so that few distinct ones occur and its end is met exactly.

An interval between two stops is divided dyadically. A step of ``2^-j`` of it starts at a multiple of itself,
and is doubled only where the doubled one would as well. Histories at quadrature points need one factorisation
per distinct step size; this keeps their number small.

The error of a step is estimated from the change of slope of the recorded quantities: strains linear in time
are integrated exactly, so the curvature over a step is the error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

_LEVELS = 48
"""Halvings of an interval that the position within it resolves."""
_WHOLE = 1 << _LEVELS
"""The interval's length in units of its finest division."""


@dataclass
class DyadicInterval:
    """Position within an interval ``start..end`` and the present step, in units of ``2^-48`` of it."""

    start: float
    end: float
    position: int = 0
    step: int = _WHOLE
    shortest_step: int = 1

    @property
    def time(self) -> float:
        """Present time."""
        return self._at(self.position)

    @property
    def next_time(self) -> float:
        """End of the next trial step."""
        return self._at(self.position + self.step)

    @property
    def dt(self) -> float:
        """Length of the next trial step, the same number for every step of this size."""
        return (self.end - self.start) * (self.step / _WHOLE)

    @property
    def done(self) -> bool:
        """Whether the end is reached."""
        return self.position >= _WHOLE

    @property
    def shortest(self) -> bool:
        """Whether the step cannot be halved."""
        return self.step <= self.shortest_step

    def limit(self, dt: float, shortest: float) -> None:
        """Start with steps of at most ``dt``; never go below ``shortest``."""
        length = self.end - self.start
        self.shortest_step = _power_below(shortest / length)
        self.step = max(_power_below(dt / length), self.shortest_step)

    def halve(self) -> None:
        """Try again with half the step."""
        self.step = max(self.step // 2, self.shortest_step)

    def advance(self) -> None:
        """Accept the step."""
        self.position += self.step

    def double(self) -> None:
        """Take twice the step from here, where that stays aligned."""
        if self.position % (2 * self.step) == 0 and self.position + 2 * self.step <= _WHOLE:
            self.step *= 2

    def _at(self, position: int) -> float:
        if position >= _WHOLE:
            return self.end
        return self.start + (self.end - self.start) * (position / _WHOLE)


def _power_below(share: float) -> int:
    if share >= 1.0:
        return _WHOLE
    exponent = _LEVELS + math.floor(math.log2(max(share, 2.0**-_LEVELS)))
    return 1 << max(exponent, 0)


@dataclass
class SlopeErrorEstimator:
    """Estimates the error of a trial step from the change of slope of the recorded quantities.

    ``slopes`` are those of the last accepted step, empty just after a kink or a jump.
    """

    tolerance: float
    slopes: dict[str, float] = field(default_factory=dict)

    def error(self, slopes: dict[str, float], scales: dict[str, float], dt: float) -> float:
        """Change of slope over the step, relative to ``tolerance`` times the scale; 0 just after a kink."""
        worst = 0.0
        for name, slope in slopes.items():
            if name in self.slopes and scales[name] > 0.0:
                allowed = self.tolerance * scales[name]
                worst = max(worst, 0.5 * abs(slope - self.slopes[name]) * dt / allowed)
        return worst

    def accept(self, slopes: dict[str, float]) -> None:
        """Store the slopes of an accepted step."""
        self.slopes = slopes

    def reset(self) -> None:
        """Drop the slopes at a kink or a jump: none is continued beyond it."""
        self.slopes = {}
