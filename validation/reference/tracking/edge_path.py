"""Path of the edge during one step, as a polynomial in the fraction ``f`` of its duration.

What the closure sees at the end of a step was left behind at times that follow from the path. The rows of the
history and the end of the step define a polynomial. A step of a fraction of a process zone passes few points
and takes the parabola through the middle of it: what is left of it changes sign there. A step over many zones
takes all of it: the condition at its end is one on the speed of the edge. So it is, in steps of any length,
where the edge takes up what its speed tells. With rows of equal spacing that speed is a backward
differentiation formula, whose order is the number of rows. Towards a limit point the same holds of the time
over the radius, which is smooth there: a parabola, or over many zones all of the polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.zone_from_turn import RootExtrapolation

Array = NDArray[np.float64]

LARGEST_BEND = 0.99
"""Slowing of the edge by the bend of its path, relative to its mean speed: below 1 it does not reverse."""
LARGEST_TIME_BEND = 1.5
"""Bend of the time over the radius, relative to its mean slope. From 1 on the edge passes a limit point on
its way: the search for that point looks at such steps; a bound of 1 would be a kink in what it sees."""
SLOPE_SAMPLES = np.linspace(0.0, 1.0, 17)
"""Fractions of a step at which the slope of the path is looked at; it is a cubic at most."""
NEWTON_STEPS = 6
"""Most Newton steps to the time at which a point is passed; two are usual, the start is a parabola's."""
LAST_CHANGE = 1e-7
"""Change of that fraction by the last Newton step: another one would be of the order of its square."""


class EdgePath(Protocol):
    """A monotone path from ``start`` over ``travel``."""

    @property
    def start(self) -> float:
        """Radius at the start of the step."""
        ...

    @property
    def travel(self) -> float:
        """Signed travel within the step."""
        ...

    def __call__(self, fraction: Array) -> Array:
        """Radius at fractions of the duration."""
        ...

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        ...

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``."""
        ...


@dataclass(frozen=True)
class ParabolicPath:
    """``a0 + travel f + bend f (f - 1)``."""

    start: float
    travel: float
    bend: float

    def __call__(self, fraction: Array) -> Array:
        return self.start + self.travel * fraction + self.bend * fraction * (fraction - 1.0)

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        return self.travel + self.bend

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``; ``|bend| < |travel|`` makes it unique."""
        if self.travel == 0.0:
            return np.zeros_like(x)
        linear = (x - self.start) / self.travel
        c = self.bend / self.travel
        if c == 0.0:
            return np.minimum(np.maximum(linear, 0.0), 1.0)
        root = np.sqrt(np.maximum((1.0 - c) ** 2 + 4.0 * c * linear, 0.0))
        return np.minimum(np.maximum(2.0 * linear / (1.0 - c + root), 0.0), 1.0)


@dataclass(frozen=True)
class PathOverRadius:
    """The time is a polynomial of the radius: ``f = s + s (s - 1) (c0 + c1 s ...)``, ``s = (a - a0)/travel``.

    So it is towards a limit point, which the edge passes with infinite speed. ``bends = (c0, c1, ...)``.
    """

    start: float
    travel: float
    bends: tuple[float, ...]

    def __call__(self, fraction: Array) -> Array:
        """Radius at about these fractions: by the parabola, which serves to leave nodes behind."""
        middle = max(_middle(self.bends), -LARGEST_BEND)
        return self.start + self.travel * ParabolicPath(0.0, 1.0, middle).passing(fraction)

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        return self.travel / max(1.0 + sum(self.bends), 1.0 - LARGEST_BEND)

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``."""
        if self.travel == 0.0:
            return np.zeros_like(x)
        share = np.minimum(np.maximum((x - self.start) / self.travel, 0.0), 1.0)
        return share * _horner(_per_fraction(1.0, self.bends), share)


@dataclass(frozen=True)
class PolynomialPath:
    """``a0 + travel f + f (f - 1) (c0 + c1 f + c2 f^2 ...)``; ``bends = (c0, c1, ...)``."""

    start: float
    travel: float
    bends: tuple[float, ...]

    def __call__(self, fraction: Array) -> Array:
        return self.start + fraction * _horner(_per_fraction(self.travel, self.bends), fraction)

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``, by Newton's method from the inverse of a parabola."""
        f = _parabola(self.start, self.travel, self.bends).passing(x)
        distance, per_fraction = x - self.start, _per_fraction(self.travel, self.bends)
        slope = _derivative(per_fraction)
        for _ in range(NEWTON_STEPS):
            change = (f * _horner(per_fraction, f) - distance) / _horner(slope, f)
            f = np.minimum(np.maximum(f - change, 0.0), 1.0)
            if np.abs(change).max(initial=0.0) < LAST_CHANGE:
                break
        return f

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        return self.travel + sum(self.bends)

    def slope(self, fraction: Array) -> Array:
        """Derivative with respect to the fraction."""
        return _horner(_derivative(_per_fraction(self.travel, self.bends)), fraction)


def path_over_radius(
    rows: RowExtrapolation, duration: float, start: float, radius: float, whole: bool = False
) -> PathOverRadius:
    """Path of which the time is a polynomial of the radius.

    Parameters
    ----------
    rows : RowExtrapolation
        Time over the radius at the rows before, both from the last.
    duration : float
    start, radius : float
        Radius at both ends of the step.
    whole : bool
        Whether it is the polynomial through all rows; otherwise the parabola with their curvature.

    Returns
    -------
    PathOverRadius
    """
    travel = radius - start
    if duration <= 0.0 or travel == 0.0:
        return PathOverRadius(start, travel, (0.0,))
    if whole and len(rows.times) > 2:
        nodes = [0.0, 1.0, *(distance / travel for distance in rows.times[1:])]
        bends = _bends(nodes, [0.0, 1.0, *(time / duration for time in rows.values[1:])])
        slope = _bend_slope(bends)
        against = max(-float(slope[0]) / LARGEST_BEND, -float(slope.min()) / LARGEST_TIME_BEND, 1.0)
        return PathOverRadius(start, travel, tuple(bend / against for bend in bends))
    bend = 0.5 * rows.curvature(travel, duration) * travel**2 / duration
    return PathOverRadius(start, travel, (min(max(bend, -LARGEST_TIME_BEND), LARGEST_BEND),))


@dataclass(frozen=True)
class PathFamily:
    """Polynomials through all rows and the end of a step of one duration; their bends are affine in that end.

    ``at_rest`` are the bends of a path that ends where it starts, ``rising`` their growth with the travel.
    """

    start: float
    at_rest: tuple[float, ...]
    rising: tuple[float, ...]

    def polynomial(self, radius: float) -> PolynomialPath | ParabolicPath:
        """The polynomial to ``radius``, its bend reduced as far as it would reverse."""
        travel = radius - self.start
        if travel == 0.0 or not self.rising:
            return ParabolicPath(self.start, travel, 0.0)
        bends = self._bends(travel)
        limit = LARGEST_BEND * abs(travel)
        if sum(map(abs, bends)) > limit:  # no slope of f (f - 1) f^k is steeper than 1
            against = float((-math.copysign(1.0, travel) * _bend_slope(bends)).max())
            share = min(1.0, limit / against) if against > 0.0 else 1.0
            bends = [share * bend for bend in bends]
        return PolynomialPath(self.start, travel, tuple(bends))

    def parabola(self, radius: float) -> ParabolicPath:
        """The parabola that meets the polynomial at both ends and in the middle."""
        travel = radius - self.start
        return _parabola(self.start, travel, self._bends(travel))

    def _bends(self, travel: float) -> list[float]:
        return [bend + travel * more for bend, more in zip(self.at_rest, self.rising, strict=True)]


def path_family(rows: RowExtrapolation | RootExtrapolation, duration: float, start: float) -> PathFamily:
    """Paths of a step after the given rows.

    Parameters
    ----------
    rows : RowExtrapolation
        Radius at the rows before.
    duration : float
        Of the step.
    start : float
        Radius at its start.

    Returns
    -------
    PathFamily
    """
    if duration <= 0.0:
        return PathFamily(start, (), ())
    if isinstance(rows, RootExtrapolation):
        level = rows.middle(duration, start)
        rise = rows.middle(duration, start + 1.0) - level
        return PathFamily(start, (4.0 * (start - level),), (2.0 - 4.0 * rise,))
    if len(rows.times) < 2:
        return PathFamily(start, (), ())
    nodes = [0.0, 1.0, *(time / duration for time in rows.times[1:])]
    earlier = [value - start for value in rows.values[1:]]
    at_rest = _bends(nodes, [0.0, 0.0, *earlier])
    return PathFamily(start, at_rest, _bends(nodes, [0.0, 1.0, *(0.0 for _ in earlier)]))


def _parabola(start: float, travel: float, bends: Sequence[float]) -> ParabolicPath:
    """Parabola through both ends and the middle of a path, its bend reduced as far as it would reverse."""
    limit = LARGEST_BEND * abs(travel)
    return ParabolicPath(start, travel, min(max(_middle(bends), -limit), limit))


def _middle(bends: Sequence[float]) -> float:
    """``c0 + c1 f + ...`` in the middle of a step."""
    middle = 0.0
    for bend in reversed(bends):
        middle = 0.5 * middle + bend
    return middle


def _bends(nodes: list[float], values: list[float]) -> tuple[float, ...]:
    """``c0, c1, ...`` of the polynomial through ``values`` at ``nodes``, the first of which are 0 and 1."""
    table = list(values)  # of divided differences
    for order in range(1, len(table)):
        for i in range(len(table) - 1, order - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - order])
    bends = [table[-1]]
    for node, difference in zip(nodes[-2:1:-1], table[-2:1:-1], strict=True):
        # multiply by (f - node) and add the next difference; coefficients rise with the power
        bends = [
            difference - node * bends[0],
            *(low - node * high for low, high in pairwise(bends)),
            bends[-1],
        ]
    return tuple(bends)


def _per_fraction(rise: float, bends: Sequence[float]) -> list[float]:
    """``(rise f + f (f - 1) (c0 + c1 f + ...))/f`` as coefficients of the powers of ``f``."""
    return [low - high for low, high in pairwise((rise, *bends, 0.0))]


def _horner(coefficients: Sequence[float], f: Array) -> Array:
    value = coefficients[-1] * f + coefficients[-2]
    for coefficient in coefficients[-3::-1]:
        value *= f
        value += coefficient
    return value


def _derivative(per_fraction: Sequence[float]) -> list[float]:
    """Coefficients of the derivative of ``f`` times a polynomial."""
    return [(power + 1) * coefficient for power, coefficient in enumerate(per_fraction)]


def _bend_slope(bends: Sequence[float]) -> Array:
    """Derivative of ``f (f - 1) (c0 + c1 f + ...)`` at ``SLOPE_SAMPLES``."""
    return _horner(_derivative(_per_fraction(0.0, bends)), SLOPE_SAMPLES)
