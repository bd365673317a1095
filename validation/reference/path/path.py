"""What a step goes along: a leg of the load, the rows since the last kink, and polynomials through them.

Over a leg the load is smooth in one parameter: the time, or, while time stands and the load jumps, the share
of the jump. A row is ``(s, p, a, D, F)``: arclength, load parameter, radius, penetration, force; the first
three in distances from the newest row, so that no step is too short to be told. Arclength is the length of
the chords in the plane of ``p/T`` and ``a/L``; when the scales change only chords do, segments stay as they
are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene.loading import Control
from validation.reference.path.polynomials import DEGREE, ORDERS, powers

Array = NDArray[np.float64]


AT_ONCE = 1e-9
"""Of a leg: what sets the indenter going later finds it at rest."""


@dataclass(frozen=True)
class Leg:
    """From parameter ``start`` to ``end``; ``rate``: of a penetration that is linear in time."""

    control: Control
    value: Callable[[float], float]
    start: float
    end: float
    timed: bool
    rate: float | None = None
    compliance: float = 0.0

    @property
    def free(self) -> bool:
        """Whether the penetration follows from the balance of forces."""
        return self.control != "penetration"

    @property
    def presses(self) -> bool:
        """Whether an indenter that is at the surface, and free of load, is pressed on from the start."""
        soon = self.start + AT_ONCE * (self.end - self.start)
        return self.control == "force" or self.value(soon) > 0.0


@dataclass(frozen=True)
class Segment:
    """One step: coefficients relative to its start.

    ``travel``: of the edge, the sum of ``way`` without its rounding. ``parameter`` and ``depth`` are those
    with end values as at the start; ``basis`` times what the end value differs by is to be added.
    """

    travel: float
    way: Array
    parameter: Array
    depth: Array
    basis: Array

    def cut(self, u: float, rise: float, sinking: float) -> Segment:
        """The part up to ``u`` of the segment with these end values of parameter and penetration."""
        scale = u**ORDERS
        parameter, depth = self.parameter + rise * self.basis, self.depth + sinking * self.basis
        way = self.way * scale
        return Segment(float(way.sum()), way, parameter * scale, depth * scale, np.zeros_like(self.basis))


@dataclass
class Rows:
    """The last rows since a kink, at most as many as a polynomial takes; the newest last."""

    table: Array
    kept: int = field(default=DEGREE + 1, repr=False)
    order: int = 1

    @classmethod
    def at(cls, D: float, F: float) -> Rows:
        """A first row."""
        return cls(np.array([[0.0, 0.0, 0.0, D, F]]))

    def __len__(self) -> int:
        return len(self.table)

    def restart(self) -> None:
        """A kink at the newest row."""
        self.table, self.order = self.table[-1:], 1

    def append(self, s: float, p: float, a: float, D: float, F: float) -> None:
        """One row more, that far from the newest."""
        older = self.table[-(self.kept - 1) :] - (s, p, a, 0.0, 0.0)
        self.table = np.vstack((older, [0.0, 0.0, 0.0, D, F]))
        self.order = min(self.order + 1, len(self.table))

    def mispredicted(self, h: float, values: Array, scales: Array) -> Array:
        """Differences (m, 4) of ``p, a, D, F`` after a way from what the last 1, 2, ... m rows predict.

        They are divided differences times the distances from these rows.
        """
        at = np.append(h, self.table[::-1, 0])
        differences = np.vstack((values, self.table[::-1, 1:])) / scales
        found, reach = np.empty((len(self.table), 4)), 1.0
        for k in range(1, len(at)):
            differences = (differences[1:] - differences[:-1]) / (at[k:] - at[:-k])[:, None]
            reach = reach * (at[k] - at[0])
            found[k - 1] = differences[0] * reach
        return found

    def measure(self, T: float, L: float) -> None:
        """Arclengths anew in other scales."""
        if len(self.table) > 1:
            rise = self.table[1:] - self.table[:-1]
            chord = np.hypot(rise[:, 1] / T, rise[:, 2] / L)
            self.table[:-1, 0] = -chord[::-1].cumsum()[::-1]

    def _through(self, s: float, order: int) -> tuple[Array, Array]:
        """Rows less the newest, and the matrix that takes them and the same for the end to powers."""
        rows = self.table[-min(order, self.order) :]
        at = np.append(rows[:, 0] / s, 1.0)
        matrix = np.asarray(np.linalg.inv(powers(at, len(rows))), dtype=np.float64)
        return rows - (0.0, 0.0, 0.0, *rows[-1, 3:]), matrix

    def segment(self, s: float, a: float, order: int = DEGREE) -> Segment:
        """The step that ends at an arclength, and that far from the radius, of the newest row."""
        rows, matrix = self._through(s, order)
        coefficients = np.zeros((DEGREE + 1, 4))
        n = len(matrix)
        coefficients[:n, 0] = matrix @ np.append(rows[:, 2], a)
        coefficients[:n, 1] = matrix[:, :-1] @ rows[:, 1]
        coefficients[:n, 2] = matrix[:, :-1] @ rows[:, 3]
        coefficients[:n, 3] = matrix[:, -1]
        coefficients[0] = 0.0  # but for rounding, of which a fast branch would make anything
        return Segment(a, *coefficients.T.copy())

    def predictor(self, T: float, L: float, depth: float, tangent: Array) -> Array:
        """``(p/T, a/L, D/depth, F)`` in powers of the way from the newest row (m, 4); ``p, a`` from there."""
        table = self.table[-self.order :]
        values = table[:, 1:] / (T, L, depth, 1.0)
        if len(values) == 1:
            return np.vstack((values, [*tangent, 0.0, 0.0]))
        way = table[:, 0]
        matrix = powers(way / -way[0], len(way) - 1)
        return np.linalg.solve(matrix, values) / ((-way[0]) ** np.arange(len(way)))[:, None]
