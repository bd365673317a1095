"""Path of the edge during one step, as a polynomial in the fraction ``f`` of its duration.

A step of a fraction of a process zone takes a parabola: it passes few points, and where it passed them hardly
matters. Towards a limit point the parabola is that of the time over the radius. A step over many zones takes
the polynomial through all rows of the history and its own end: what the closure sees at the end was left
behind within the step, at times that follow from the path, and the condition there is one on the speed of the
edge. So it is, in steps of any length, where the edge takes up what its speed tells. With rows of equal
spacing that speed is a backward differentiation formula, whose order is the number of rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking.step_history import RowExtrapolation

Array = NDArray[np.float64]

LARGEST_BEND = 0.99
"""Slowing of the edge by the bend of its path, relative to its mean speed: below 1 it does not reverse."""
SLOPE_SAMPLES = np.linspace(0.0, 1.0, 17)
"""Fractions of a step at which the slope of the path is looked at; it is a cubic at most."""
NEWTON_STEPS = 6
"""Most Newton steps to the time at which a point is passed; three are usual, the start is a parabola's."""


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
    """The time is a parabola of the radius: ``f = s + bend s (s - 1)`` at ``s = (a - a0)/travel``.

    So it is towards a limit point, which the edge passes with infinite speed.
    """

    start: float
    travel: float
    bend: float

    def __call__(self, fraction: Array) -> Array:
        return self.start + self.travel * ParabolicPath(0.0, 1.0, self.bend).passing(fraction)

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        return self.travel / (1.0 + self.bend)

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``."""
        if self.travel == 0.0:
            return np.zeros_like(x)
        share = np.minimum(np.maximum((x - self.start) / self.travel, 0.0), 1.0)
        return share + self.bend * share * (share - 1.0)


@dataclass(frozen=True)
class PolynomialPath:
    """``a0 + travel f + f (f - 1) (c0 + c1 f + c2 f^2 ...)``; ``bends = (c0, c1, ...)``."""

    start: float
    travel: float
    bends: tuple[float, ...]

    def __call__(self, fraction: Array) -> Array:
        return (
            self.start + self.travel * fraction + fraction * (fraction - 1.0) * _horner(self.bends, fraction)
        )

    def passing(self, x: Array) -> Array:
        """Fraction at which the edge passes ``x``, by Newton's method from the inverse of a parabola."""
        limit = LARGEST_BEND * abs(self.travel)
        middle = float(_horner(self.bends, np.array(0.5)))
        f = ParabolicPath(self.start, self.travel, min(max(middle, -limit), limit)).passing(x)
        for _ in range(NEWTON_STEPS):
            change = (self(f) - x) / self.slope(f)
            f = np.minimum(np.maximum(f - change, 0.0), 1.0)
            if np.abs(change).max(initial=0.0) < 1e-9:  # the next one would be below round-off
                break
        return f

    @property
    def end_slope(self) -> float:
        """Derivative with respect to the fraction at the end of the step."""
        return self.travel + sum(self.bends)

    def slope(self, fraction: Array) -> Array:
        """Derivative with respect to the fraction."""
        return self.travel + _bend_slope(self.bends, fraction)


def parabolic_path(rows: RowExtrapolation, duration: float, start: float, radius: float) -> ParabolicPath:
    """Parabola to ``radius`` with the curvature of the rows before.

    Parameters
    ----------
    rows : RowExtrapolation
        Radius at the rows before.
    duration : float
    start, radius : float
        Radius at both ends of the step.

    Returns
    -------
    ParabolicPath
    """
    travel = radius - start
    limit = LARGEST_BEND * abs(travel)
    bend = 0.5 * rows.curvature(duration, radius) * duration**2
    return ParabolicPath(start, travel, min(max(bend, -limit), limit))


def path_over_radius(rows: RowExtrapolation, duration: float, start: float, radius: float) -> PathOverRadius:
    """Parabola of the time over the radius, with the curvature of the rows before.

    Parameters
    ----------
    rows : RowExtrapolation
        Time over the radius at the rows before, both from the last.
    duration : float
    start, radius : float
        Radius at both ends of the step.

    Returns
    -------
    PathOverRadius
    """
    travel = radius - start
    bend = 0.5 * rows.curvature(travel, duration) * travel**2 / duration if duration > 0.0 else 0.0
    return PathOverRadius(start, travel, min(max(bend, -LARGEST_BEND), LARGEST_BEND))


def polynomial_path(
    rows: RowExtrapolation, duration: float, start: float, radius: float
) -> PolynomialPath | ParabolicPath:
    """Polynomial through the rows before and ``radius``, its bend reduced as far as it would reverse.

    Parameters
    ----------
    rows : RowExtrapolation
        Radius at the rows before.
    duration : float
    start, radius : float
        Radius at both ends of the step.

    Returns
    -------
    PolynomialPath
    """
    travel = radius - start
    if duration <= 0.0 or travel == 0.0 or len(rows.times) < 2:
        return ParabolicPath(start, travel, 0.0)
    nodes = [0.0, 1.0, *(time / duration for time in rows.times[1:])]
    table = [start, radius, *rows.values[1:]]
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
    against = float((-np.sign(travel) * _bend_slope(tuple(bends), SLOPE_SAMPLES)).max())
    share = min(1.0, LARGEST_BEND * abs(travel) / against) if against > 0.0 else 1.0
    return PolynomialPath(start, travel, tuple(share * bend for bend in bends))


def _horner(coefficients: tuple[float, ...], f: Array) -> Array:
    value = np.full_like(f, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = value * f + coefficient
    return value


def _bend_slope(bends: tuple[float, ...], f: Array) -> Array:
    """Derivative of ``f (f - 1) (c0 + c1 f + ...)``, that is of ``sum c_k (f^(k+2) - f^(k+1))``."""
    value = np.zeros_like(f)
    power = np.ones_like(f)
    for k, bend in enumerate(bends):
        value += bend * ((k + 2) * f - (k + 1)) * power
        power = power * f
    return value
