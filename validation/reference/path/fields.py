"""The surface as a table of last passages of the edge.

A radius is a Prony element by itself. In contact it carries ``C_k = b_k - E_k M_k(t)``, which fades as
``exp(-t/tau_k)``; outside unit strains ``e_j``, which fade as ``exp(-t/theta_j)``. So what it was left with
when the edge passed it last, and when that was, is all there is to know. Both are smooth along the path; the
table has an entry for every part of the path that is still the last to have passed its radii:

    x = x_0 + way(w),   t = t_0 + clock(w),   C or e at t = carried(w),   w in [0, 1].

What a step leaves behind depends on what was there before; where two entries met before, the new ones meet,
too. Where neighbours disagree the edge has turned, or rested: a kink, found by looking at it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.polynomials import DEGREE, gauss, horner, inverse, powers

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NODES, WEIGHTS = gauss(6)
"""Points of an entry: a polynomial of degree 5 where the path has degree 4."""
_TO_POWERS = np.linalg.inv(powers(NODES, len(NODES) - 1))
_TO_WAY = np.linalg.pinv(powers(NODES, DEGREE))


@dataclass(frozen=True)
class Passages:
    """Entry i holds the radii in ``(edges[i], edges[i + 1]]``; beyond the last nothing has ever been.

    ``shape`` is a part of what is carried that goes as the indenter, ``G(x)``: exact in the state of a start.
    """

    edges: Array
    held: Flags
    start: Array
    way: Array
    clock: Array
    carried: Array
    shape: Array

    def at(self, x: Array, G: Array, time: float, times: Array, retardation: Array) -> tuple[Flags, Array]:
        """Which radii (m,) are in contact, and what they carry (m, n) at a time."""
        if not len(self.held):
            return np.zeros(len(x), bool), np.zeros((len(x), len(times)))
        entry = np.searchsorted(self.edges, x) - 1
        beyond = entry >= len(self.held)
        entry = np.clip(entry, 0, len(self.held) - 1)
        way, start = self.way[entry], self.start[entry]
        w = inverse(way, x - start[:, 0])
        elapsed = time - start[:, 1] - horner(self.clock[entry], w)
        held = self.held[entry]
        coefficients = self.carried[entry]
        carried = coefficients[:, -1].copy()
        for order in range(coefficients.shape[1] - 2, -1, -1):
            carried *= w[:, None]
            carried += coefficients[:, order]
        carried += self.shape[entry] * G[:, None]
        carried *= np.exp(-elapsed[:, None] / np.where(held[:, None], times, retardation))
        if beyond.any():
            carried[beyond], held = 0.0, held & ~beyond
        return held, carried


def untouched(radius: float, time: float, held: Array, shape: Array) -> Passages:
    """A contact of that radius on a surface never touched before; what it carries is ``held + shape G``."""
    entries = 1 if radius > 0.0 else 0
    carried = np.zeros((entries, len(NODES), len(held)))
    carried[:, 0] = held
    way = np.zeros((entries, DEGREE + 1))
    way[:, 1] = radius
    return Passages(
        np.array([0.0, radius][: entries + 1]),
        np.ones(entries, bool),
        np.array([[0.0, time]])[:entries],
        way,
        np.zeros_like(way),
        carried,
        np.tile(shape, (entries, 1)),
    )


@dataclass(frozen=True)
class Sweep:
    """The radii a step passes, in the entries it will leave: ``cuts`` (l + 1,) along the way.

    ``u`` (l * 6,): where on the step; ``x`` and ``weight``: radii and weights of an integral over them.
    """

    cuts: Array
    u: Array
    x: Array
    weight: Array


def sweep(radius: float, way: Array, cuts: Array) -> Sweep:
    """Points of a step from ``radius`` along ``radius + way(u)``, cut at radii in their order along it."""
    ends = np.concatenate(([0.0], inverse(np.broadcast_to(way, (len(cuts) - 2, len(way))), cuts[1:-1] - radius), [1.0]))
    width = np.diff(ends)
    u = (ends[:-1, None] + width[:, None] * NODES).ravel()
    slope = horner(way[1:] * np.arange(1, len(way)), u)
    return Sweep(cuts, u, radius + horner(way, u), np.abs(slope) * (width[:, None] * WEIGHTS).ravel())


def passed(
    before: Passages, swept: Sweep, radius: float, time: float, elapsed: Array, carried: Array, held: bool
) -> Passages:
    """The table after a step: ``carried`` (m, n) by the points of the sweep at ``elapsed`` (m,) after ``time``."""
    entries, nodes = len(swept.cuts) - 1, len(NODES)
    x = np.column_stack((np.zeros(entries), swept.x.reshape(entries, nodes) - swept.cuts[:-1, None]))
    t = elapsed.reshape(entries, nodes)
    way = x[:, 1:] @ _TO_WAY.T
    clock = t @ _TO_WAY.T
    start = np.column_stack((swept.cuts[:-1], np.full(entries, time)))
    start[:, 0] += way[:, 0]
    start[:, 1] += clock[:, 0]
    way[:, 0] = clock[:, 0] = 0.0
    values = np.einsum("ij,ejk->eik", _TO_POWERS, carried.reshape(entries, nodes, -1))
    new = (np.full(entries, held), start, way, clock, values, np.zeros((entries, carried.shape[1])))
    edges = swept.cuts
    if edges[-1] < edges[0]:
        edges, new = edges[::-1], tuple(array[::-1] for array in new)
    low, high = edges[0], edges[-1]
    first = int(np.searchsorted(before.edges, low, side="left"))  # edges[:first] lie below the sweep
    last = int(np.searchsorted(before.edges, high, side="right"))  # edges[last:] beyond it
    below, above = slice(0, first), slice(last - 1, len(before.held))  # entries cut by its ends stay in part
    return Passages(
        np.concatenate((before.edges[:first], edges, before.edges[last:])),
        *(
            np.concatenate((getattr(before, name)[below], part, getattr(before, name)[above]))
            for name, part in zip(("held", "start", "way", "clock", "carried", "shape"), new, strict=True)
        ),
    )
