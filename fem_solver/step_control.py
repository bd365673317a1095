"""Step sizes: halvings of an interval, so that few distinct ones occur and its end is met exactly.

An interval between two declared times is divided dyadically. A step of ``2^-j`` of it starts at a multiple of
itself, and is doubled only where the doubled one would as well. Histories at quadrature points need one
factorisation per distinct step size; this keeps their number small.

Steps are judged by the change of slope of the recorded quantities (linear strains are exact, so curvature is
what is left) and by how far the edge moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

_LEVELS = 48
_FULL = 1 << _LEVELS
_CURVATURE_SHARE = 1.0  # curvature of a step allowed per tolerance


@dataclass
class Clock:
    """Position within an interval ``start..end`` in units of ``2^-48`` of it."""

    start: float
    end: float
    position: int = 0
    stride: int = _FULL
    least: int = 1

    @property
    def time(self) -> float:
        """Present time."""
        return self._at(self.position)

    @property
    def next_time(self) -> float:
        """End of the step about to be tried."""
        return self._at(self.position + self.stride)

    @property
    def dt(self) -> float:
        """Its length, the same number for every step of this stride."""
        return (self.end - self.start) * (self.stride / _FULL)

    @property
    def done(self) -> bool:
        """Whether the end is reached."""
        return self.position >= _FULL

    @property
    def shortest(self) -> bool:
        """Whether the step cannot be halved."""
        return self.stride <= self.least

    def limit(self, dt: float, floor: float) -> None:
        """Start with steps of at most ``dt``; never go below ``floor``."""
        length = self.end - self.start
        self.least = _power_below(floor / length)
        self.stride = max(_power_below(dt / length), self.least)

    def halve(self) -> None:
        """Try again with half the step."""
        self.stride = max(self.stride // 2, self.least)

    def advance(self) -> None:
        """Accept the step."""
        self.position += self.stride

    def double(self) -> None:
        """Take twice the step from here, where that stays aligned."""
        if self.position % (2 * self.stride) == 0 and self.position + 2 * self.stride <= _FULL:
            self.stride *= 2

    def _at(self, position: int) -> float:
        if position >= _FULL:
            return self.end
        return self.start + (self.end - self.start) * (position / _FULL)


def _power_below(share: float) -> int:
    if share >= 1.0:
        return _FULL
    exponent = _LEVELS + math.floor(math.log2(max(share, 2.0**-_LEVELS)))
    return 1 << max(exponent, 0)


@dataclass
class Judge:
    """Decides on a trial step from the curvature of what is recorded and from the edge travel."""

    tolerance: float
    travel: float
    slopes: dict[str, float] = field(default_factory=dict)

    def error(self, slopes: dict[str, float], scales: dict[str, float], dt: float) -> float:
        """Change of slope over the step, relative to what is allowed; 0 just after a kink."""
        worst = 0.0
        for name, slope in slopes.items():
            if name in self.slopes and scales[name] > 0.0:
                allowed = _CURVATURE_SHARE * self.tolerance * scales[name]
                worst = max(worst, 0.5 * abs(slope - self.slopes[name]) * dt / allowed)
        return worst

    def accept(self, slopes: dict[str, float]) -> None:
        """Remember the slopes of an accepted step."""
        self.slopes = slopes

    def forget(self) -> None:
        """A kink or a jump: slopes mean nothing beyond it."""
        self.slopes = {}
