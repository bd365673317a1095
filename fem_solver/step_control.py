"""Step sizes: dyadic divisions of an interval, so that few distinct ones occur and its end is met exactly.

An interval between two stops is divided dyadically. A step of ``2^-j`` of it starts at a multiple of itself,
and is doubled only where the doubled one would as well.

Strains that are parabolas in time are integrated exactly: the error of a step is what the parabola through
the last three rows of a recorded quantity misses of the next one, behind a kink what a line through two does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from contact_scene import Segment
from fem_solver.moduli import bend_through

Array = NDArray[np.float64]

_ROUNDING = 8.0
"""Shortest step in units of the spacing of floats at the present time."""


@dataclass
class DyadicInterval:
    """Position within an interval ``start..end`` and the present step, dyadic shares of it.

    Steps are not shorter than ``floor``, nor than a few spacings of floats at the present time: what happens
    at the begin of a long interval is resolved in its own time. They are not longer than ``ceiling``.
    """

    start: float
    end: float
    position: Fraction = Fraction(0)
    step: Fraction = Fraction(1)
    floor: float = 0.0
    ceiling: float = math.inf

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
        return self._length(self.step)

    @property
    def done(self) -> bool:
        """Whether the end is reached."""
        return self.position >= 1

    @property
    def shortest(self) -> bool:
        """Whether the step cannot be halved."""
        return self._length(self.step) <= self.least

    @property
    def least(self) -> float:
        """Shortest step from here."""
        return self._shortest(self.position)

    def limit(self, dt: float, shortest: float) -> None:
        """Start with steps of at most ``dt``; never go below ``shortest``."""
        self.floor = shortest
        first = max(min(dt, self.ceiling), self.least)
        share = first / (self.end - self.start)
        self.step = min(Fraction(2) ** (math.frexp(share)[1] - 1), Fraction(1))

    def halve(self) -> None:
        """Try again with half the step, if it may be halved."""
        if not self.shortest:
            self.step /= 2

    def advance(self) -> None:
        """Accept the step."""
        self.position += self.step

    def end_at(self, time: float) -> None:
        """End the interval within the step."""
        self.end, self.position = time, Fraction(1)

    def divisible(self, position: Fraction) -> bool:
        """Whether the step that led here from an earlier position can be halved."""
        return self._length(self.position - position) > self._shortest(position)

    def take_back(self, position: Fraction) -> None:
        """Return to an earlier position, with half the step that led from there."""
        self.step, self.position = self.position - position, position
        self.halve()

    def double(self) -> None:
        """Take twice the step from here, where that stays aligned and below the ceiling."""
        aligned = self.position % (2 * self.step) == 0 and self.position + 2 * self.step <= 1
        if aligned and self._length(2 * self.step) <= self.ceiling:
            self.step *= 2

    def _at(self, position: Fraction) -> float:
        if position >= 1:
            return self.end
        return self.start + self._length(position)

    def _length(self, share: Fraction) -> float:
        return (self.end - self.start) * float(share)

    def _shortest(self, position: Fraction) -> float:
        return max(self.floor, _ROUNDING * math.ulp(self._at(position)))


def missed_peak(earlier: float, rise: float, fall: float, length: float) -> float:
    """What may lie above the last row within the step to it, for a concave curve.

    Above the chord lies at most the corner of the line that continues the step before and the line that
    continues the step behind backwards.
    """
    if earlier <= rise:
        return 0.0
    if math.isinf(earlier):
        return fall * length
    if math.isinf(fall):
        return (earlier - rise) * length
    return fall * (earlier - rise) / (earlier + fall) * length


@dataclass(frozen=True)
class Slopes:
    """Slopes of the recorded quantities over the last step, of this length; none behind a kink or a jump.

    ``curvatures`` are the leading coefficients of the parabolas through one row more, where there is one.
    """

    length: float = 0.0
    values: dict[str, float] = field(default_factory=dict)
    curvatures: dict[str, float] = field(default_factory=dict)

    def error(self, slopes: dict[str, float], allowed: dict[str, float], dt: float) -> float:
        """Half of what rows miss of a further step, relative to what is allowed; goes as its square."""
        worst = 0.0
        for name, last in self.values.items():
            turn = abs(slopes[name] - last - self.curvatures.get(name, 0.0) * (dt + self.length))
            if allowed[name] > 0.0:
                worst = max(worst, 0.5 * turn * dt / allowed[name])
        return worst ** (2.0 / 3.0) if self.curvatures else worst

    def followed(self, slopes: dict[str, float], dt: float) -> Slopes:
        """Those of a further step."""
        turns = {name: (slopes[name] - last) / (dt + self.length) for name, last in self.values.items()}
        return Slopes(dt, slopes, turns)


_SPREAD = 256
"""Samples over a load step from which the swing is read."""


def _spread(count: int) -> Array:
    """Uneven shares of an interval, at no two of which an oscillation repeats itself: golden ratios."""
    return np.mod(np.arange(count) * 0.5 * (math.sqrt(5.0) - 1.0), 1.0)


def swing(segment: Segment) -> float:
    """Range of a curved control law about the straight line between its ends, from unevenly spread samples.

    A drift many times as long as an oscillation is wide must not hide it.
    """
    if segment.linear:
        return 0.0
    length, change = segment.end - segment.start, segment.value(segment.end) - segment.value(segment.start)
    values = [segment.value(segment.start + length * x) - change * x for x in _spread(_SPREAD)]
    spread = max(values) - min(values)
    largest = max(abs(change), *(abs(value) for value in values))
    # rounding, as of a smooth table of rows on a line, is no spread
    return 0.0 if math.isclose(largest + spread, largest) else spread


def deviation_from_parabola(segment: Segment, start: float, end: float) -> float:
    """Largest deviation of the prescribed value from the parabola through its ends and its middle."""
    first, middle, last = (segment.value(start + share * (end - start)) for share in (0.0, 0.5, 1.0))
    rise, bend = last - first, bend_through(first, middle, last)

    def deviation(share: float) -> float:
        value = segment.value(start + share * (end - start))
        return abs(value - first - share * (rise + (share - 1.0) * bend))

    return max(map(deviation, _spread(4)[1:].tolist()))
