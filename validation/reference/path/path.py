"""What a step goes along: a leg of the load, the rows since the last kink, and polynomials through them.

Over a leg the load is smooth in one parameter: the time, or, while time stands and the load jumps, the share
of the jump. A row is ``(s, p, a, F, D, C)``: arclength, load parameter, radius, force, penetrations; the
first three in distances from the newest row, so that no step is too short to be told. Arclength is the length
of the chords in the plane of ``p/T`` and ``a/L``; when the scales change only chords do, segments stay as
they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene import Segment
from contact_scene.loading import Control
from validation.reference.path.numerics import DEGREE, NEGLIGIBLE, ORDERS, ROUNDING, bracketed

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Leg:
    """From ``start`` to ``end``, times since ``origin``; ``rate``: of a penetration linear in time."""

    control: Control
    value: Callable[[float], float]
    start: float
    end: float
    timed: bool
    rate: float | None = None
    compliance: float = 0.0
    origin: float = 0.0

    @property
    def free(self) -> bool:
        """Whether the penetration follows from the balance of forces."""
        return self.control != "penetration"

    @property
    def stands(self) -> bool:
        """Whether the load stands still while time goes on: only creep moves the edge."""
        return self.free and self.timed and self.value(self.start) == self.value(self.end)

    @property
    def presses(self) -> bool:
        """Whether an indenter that is at the surface, and free of load, is pressed on from the start."""
        soon = self.start + NEGLIGIBLE * (self.end - self.start)
        return self.control == "force" or self.value(soon) > 0.0


def jump(segment: Segment, penetration: float, force: float) -> Leg | None:
    """The jump of the load with which a load step begins, if it does."""
    have, first = segment.present(penetration, force), segment.value(segment.start)
    if abs(first - have) <= ROUNDING * max(abs(have), abs(first)):
        return None

    def value(share: float) -> float:
        return have + (first - have) * share

    return Leg(segment.control, value, 0.0, 1.0, False, None, segment.compliance)


def timed_legs(segment: Segment, tolerance: float, origin: float) -> Iterator[Leg]:
    """What a load step is made of between its kinks.

    A row of a table is none where the lines that meet there are nearly a smooth curve, which they leave by an
    eighth of the jump of the rate times the longer of them: there they are rounded.
    """
    marks = [*sorted({segment.start, *segment.kinks}), segment.end]
    values, rates = [segment.value(at) for at in marks], [segment.rate(at) for at in marks[:-1]]
    allowed = 8.0 * tolerance * (max(values) - min(values))
    kept = [0]
    for i in range(1, len(rates)):
        longer = max(marks[i] - marks[i - 1], marks[i + 1] - marks[i])
        if abs(rates[i] - rates[i - 1]) * longer > allowed:
            kept.append(i)
    for first, last in pairwise((*kept, len(rates))):
        begin, end, rate = marks[first], marks[last], None
        if segment.linear and segment.control == "penetration":
            mean = (values[last] - values[first]) / (end - begin) if end > begin else 0.0
            off = max(abs(each - mean) for each in rates[first:last])
            rate = mean if off <= tolerance * abs(mean) else None
        value = segment.value
        if segment.linear and rate is None and last > first + 1:
            value = rounded(value, np.array(marks[first : last + 1]), np.array(rates[first:last]))
        if end - begin > ROUNDING * end:
            yield Leg(segment.control, value, begin, end, True, rate, segment.compliance, origin)


def rounded(value: Callable[[float], float], marks: Array, rates: Array) -> Callable[[float], float]:
    """Straight lines between marks with a parabola in place of each kink, half way to the next at most."""
    width, at = marks[1:] - marks[:-1], marks[1:-1]
    half, jump = 0.5 * np.minimum(width[:-1], width[1:]), rates[1:] - rates[:-1]
    between = 0.5 * (at[1:] + at[:-1])

    def smooth(now: float) -> float:
        i = int(between.searchsorted(now))
        away = float(half[i]) - abs(now - float(at[i]))
        return value(now) + (float(jump[i] * away * away / (4.0 * half[i])) if away > 0.0 else 0.0)

    return smooth


@dataclass(frozen=True)
class PathSegment:
    """One step: coefficients relative to its start.

    ``travel``: of the edge, the sum of ``way`` without its rounding. ``parameter`` and ``depths`` (c, K + 1)
    are those with end values as at the start; ``basis`` times what the end values differ by is to be added.
    """

    travel: float
    way: Array
    parameter: Array
    depths: Array
    basis: Array

    def cut(self, u: float, rise: float, sinking: Array, loose: bool = False) -> PathSegment:
        """The part up to ``u`` of the segment with these end values of parameter and penetrations.

        ``loose``: with end values that are to be found, by changes that grow evenly.
        """
        scale = u**ORDERS
        parameter = (self.parameter + rise * self.basis) * scale
        depths = (self.depths + self.basis[:, None] * sinking) * scale[:, None]
        way, basis = self.way * scale, np.zeros_like(self.basis)
        if loose:
            basis[1] = 1.0
            parameter[1] -= parameter.sum()
            depths[1] -= depths.sum(axis=0)
        return PathSegment(float(way.sum()), way, parameter, depths, basis)


@dataclass
class Rows:
    """The last rows since a kink, at most as many as a polynomial takes; the newest last.

    Polynomials of the way ``h`` from the newest row are in the form of Newton: products of the distances from
    the last 1, 2, ... rows, times divided differences.
    """

    table: Array
    order: int = 1
    _newton: tuple[Array, Array, Array] | None = field(default=None, repr=False)

    @classmethod
    def at(cls, F: float, depths: Array) -> Rows:
        """A first row."""
        return cls(np.array([[0.0, 0.0, 0.0, F, *depths]]))

    def __len__(self) -> int:
        return len(self.table)

    def restart(self) -> None:
        """A kink at the newest row."""
        self.table, self.order = self.table[-1:], 1

    def append(self, s: float, p: float, a: float, F: float, depths: Array) -> None:
        """One row more, that far from the newest."""
        older = self.table[-DEGREE:].copy()
        older[:, :3] -= (s, p, a)
        self.table = np.vstack((older, [0.0, 0.0, 0.0, F, *depths]))
        self.order = min(self.order + 1, len(self.table))

    def measure(self, T: float, L: float) -> None:
        """Arclengths anew in other scales."""
        if len(self.table) > 1:
            rise = self.table[1:] - self.table[:-1]
            chord = np.hypot(rise[:, 1] / T, rise[:, 2] / L)
            self.table = self.table.copy()
            self.table[:-1, 0] = -chord[::-1].cumsum()[::-1]

    @property
    def newton(self) -> tuple[Array, Array]:
        """Products (m + 1, m + 1) in powers of ``h``, and differences (m, K + 4) of ``p, a, F, D, C``."""
        if self._newton is None or self._newton[0] is not self.table:
            count, ways = len(self.table), self.table[::-1, 0]
            products = np.zeros((count + 1, count + 1))
            products[0, 0] = 1.0
            for k, way in enumerate(ways.tolist()):
                products[k + 1, 1:] = products[k, :-1]
                products[k + 1] -= way * products[k]
            each = self.table[::-1, 1:] - self.table[-1, 1:]
            differences = each.copy()
            for k in range(1, count):
                each = (each[1:] - each[:-1]) / (ways[k:] - ways[:-k])[:, None]
                differences[k] = each[0]
            self._newton = self.table, products, differences
        return self._newton[1:]

    def mispredicted(self, h: float, values: Array, scales: Array) -> Array:
        """Differences (m, 4) of ``p, a, F, D`` after a way from what the last 1, 2, ... m rows predict."""
        products, differences = self.newton
        count, differences = len(differences), differences[:, :4]
        terms = (products[:count] @ h ** np.arange(count + 1))[:, None] * differences
        found: Array = (values - self.table[-1, 1:5] - terms.cumsum(axis=0)) / scales
        return found

    def segment(self, s: float, a: float, order: int = DEGREE) -> PathSegment:
        """The step that ends at an arclength, and that far from the radius, of the newest row."""
        products, differences = self.newton
        count = min(order, self.order, len(differences))
        scale = s ** ORDERS[: count + 1]
        basis = products[count, : count + 1] * scale
        basis /= basis.sum()
        coefficients = np.zeros((DEGREE + 1, differences.shape[1]))
        coefficients[: count + 1] = products[:count, : count + 1].T @ differences[:count]
        coefficients[: count + 1] *= scale[:, None]
        lack = -coefficients.sum(axis=0)
        lack[1] += a
        coefficients[: count + 1] += basis[:, None] * lack
        coefficients[: count + 1, 2] = basis
        parameter, way, basis = coefficients[:, :3].T.copy()
        return PathSegment(a, way, parameter, coefficients[:, 3:], basis)

    def predictor(self, T: float, L: float, depth: float, tangent: Array) -> Predictor:
        """The way ahead, by as many rows as are to predict it."""
        products, differences = self.newton
        m, scales = min(self.order, len(differences)), np.full(differences.shape[1], depth)
        scales[:3] = T, L, 1.0
        if m == 1:
            return Predictor(np.vstack((self.table[-1, 1:] / scales, np.append(tangent, 0.0 * scales[2:]))))
        coefficients = products[:m, :m].T @ differences[:m]
        coefficients[0] = self.table[-1, 1:]
        return Predictor(coefficients / scales)


@dataclass(frozen=True)
class Predictor:
    """``(p/T, a/L, F, (D, C)/depth)`` in powers of the way from the newest row; ``p, a`` from there."""

    coefficients: Array

    def place(self, h: float) -> Array:
        """Where the path is after a way."""
        found: Array = h ** ORDERS[: len(self.coefficients)] @ self.coefficients
        return found

    def slope(self, h: float) -> Array:
        """Its direction there."""
        orders = ORDERS[: len(self.coefficients)]
        found: Array = h ** orders[:-1] @ (orders[1:, None] * self.coefficients[1:])
        return found

    def passage(self, order: int, column: int, way: float, level: float, reach: float) -> float:
        """Where a component of place or slope passes a level, that way; infinite if not within reach."""

        def beyond(h: float) -> float:
            return float((self.slope if order else self.place)(h)[column]) - level

        first, last = beyond(0.0), beyond(reach)
        return bracketed(beyond, 0.0, reach) if first * last < 0.0 <= way * (last - first) else math.inf
