"""The surface as a table of last passages of the edge.

A radius is a Prony element by itself. In contact it carries ``c_k = b_k - E_k phi . M_k(t)``, which fades as
``exp(-t/tau_k)``; outside unit strains ``e_j``, which fade as ``exp(-t/theta_j)``. So what it was left with
when the edge passed it last, and when that was, is all there is to know. The table has an entry for every
part of the path that is still the last to have passed its radii. Both are smooth along the path, not over the
radius: where the edge turns they go with the root of the distance. So they are polynomials of ``g`` with

    x = x_0 + X (c g + (1 - c) g^2),    0 <= g <= 1,

the parabola that leaves and arrives with the slopes of the path. What a step leaves behind depends on what
was there before; where two entries met before, the new ones meet, too. Where neighbours disagree the edge has
turned, or rested: a kink, found by looking at it.

The table is seen from the edge, and from now: radii are distances from the edge, negative in contact, times
are those since now. So the zone is as sharp where it is 1e-8 of the radius as where it is a tenth of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.memory import Motion
from validation.reference.path.numerics import derivative, gauss, horner, inverse, on_parabola, powers
from validation.reference.path.rheology import Rheology

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NODES, WEIGHTS = gauss(6)
"""Points of an entry: a polynomial of degree 5 where the path has degree 4."""
TO_POWERS = np.linalg.inv(powers(NODES, len(NODES) - 1))


@dataclass(frozen=True)
class Passages:
    """Entry i holds the radii in ``(edges[i], edges[i + 1]]``; beyond the last nothing has ever been.

    ``edges`` begin at the axis. ``parabola`` (l, 3): ``x_0, X, c``. ``time`` (l,). ``left`` (l, 6, n + 1):
    coefficients of the time of passage after ``time``, and of what is carried. ``shape`` (l, n): a part of
    that which goes as the indenter, ``G(x)``: exact in the state of a start.
    """

    edges: Array
    held: Flags
    parabola: Array
    time: Array
    left: Array
    shape: Array

    def at(self, x: Array, G: Array, times: Array, retardation: Array) -> tuple[Flags, Array]:
        """Which radii (m,) are in contact, and what they carry (m, n) now."""
        if not len(self.held):
            return np.zeros(len(x), bool), np.zeros((len(x), len(times)))
        entry = self.edges.searchsorted(x) - 1
        beyond = x > self.edges[-1]
        np.clip(entry, 0, len(self.held) - 1, out=entry)
        g = along(self.parabola.take(entry, axis=0), x)[0]
        left = np.einsum("mk,mkn->mn", powers(g, len(NODES) - 1), self.left.take(entry, axis=0))
        held = self.held.take(entry)
        elapsed = np.maximum(-self.time.take(entry) - left[:, 0], 0.0)  # nothing is passed later
        carried = left[:, 1:] + self.shape.take(entry, axis=0) * G[:, None]
        carried *= np.exp(-elapsed[:, None] / np.where(held[:, None], times, retardation))
        if beyond.any():
            carried[beyond], held = 0.0, held & ~beyond
        return held, carried

    def joined(self, pairs: NDArray[np.intp], parabola: Array, carried: Array) -> Passages:
        """The same with one entry for each of those and the next, that carries what is told now."""
        kept = np.delete(np.arange(len(self.held)), pairs + 1)
        at = pairs - np.arange(len(pairs))
        parabolas, time, left, shape = (
            part[kept] for part in (self.parabola, self.time, self.left, self.shape)
        )
        parabolas[at], time[at], shape[at] = parabola, 0.0, 0.0
        left[at, :, 0], left[at, :, 1:] = 0.0, carried
        return Passages(np.delete(self.edges, pairs + 1), self.held[kept], parabolas, time, left, shape)

    def seen_from(self, travel: float, radius: float, later: float) -> Passages:
        """The same when the edge has gone that far, to a radius, in that time."""
        edges, parabola = self.edges - travel, self.parabola.copy()
        edges[0] = -radius
        parabola[:, 0] -= travel
        return replace(self, edges=edges, parabola=parabola, time=self.time - later)


def along(parabola: Array, x: Array) -> tuple[Array, Array]:
    """``g`` at radii (m,) on parabolas (m, 3), and the size of ``dx/dg`` there."""
    start, whole, linear = parabola.T
    g, slope = on_parabola(linear, np.minimum(np.maximum((x - start) / whole, 0.0), 1.0))
    return g, np.abs(whole) * slope


def untouched(radius: float, held: Array, shape: Array) -> Passages:
    """A contact of that radius on a surface never touched before; what it carries is ``held + shape G``."""
    entries = 1 if radius > 0.0 and len(held) else 0
    left = np.zeros((entries, len(NODES), len(held) + 1))
    left[:, 0, 1:] = held
    return Passages(
        np.array([-radius, 0.0][: entries + 1]),
        np.ones(entries, bool),
        np.array([[-radius, radius, 1.0]])[:entries],
        np.zeros(entries),
        left,
        np.tile(shape, (entries, 1)),
    )


@dataclass(frozen=True)
class SweptRadii:
    """The radii a step passes, in the entries it will leave between ``cuts``, in their order along the way.

    ``x`` and ``weight`` (l * 6 + 2,): radii, with both ends, and weights of an integral over them, 0 there.
    """

    cuts: Array
    parabola: Array
    x: Array
    weight: Array


def sweep(way: Array, cuts: Array) -> SweptRadii:
    """Points of a step along ``way(u)``, cut at distances in their order along it, the first zero."""
    ends = np.zeros(len(cuts))
    ends[1:-1], ends[-1] = inverse(way, cuts[1:-1]), 1.0
    whole = cuts[1:] - cuts[:-1]
    slopes = horner(derivative(way), ends)
    linear = 1.0 + 0.5 * (ends[1:] - ends[:-1]) * (slopes[:-1] - slopes[1:]) / whole
    linear = np.minimum(np.maximum(linear, 0.0), 2.0)[:, None]
    x = cuts[:-1, None] + whole[:, None] * NODES * (linear + (1.0 - linear) * NODES)
    weight = np.abs(whole[:, None]) * WEIGHTS * (linear + 2.0 * (1.0 - linear) * NODES)
    parabola = np.column_stack((cuts[:-1], whole, linear))
    x = np.concatenate((cuts[:1], x.ravel(), cuts[-1:]))
    return SweptRadii(cuts, parabola, x, np.concatenate(([0.0], weight.ravel(), [0.0])))


def passed(
    before: Passages,
    swept: SweptRadii,
    elapsed: Array,
    carried: Array,
    held: bool,
    G: Array,
    moduli: Array,
) -> Passages:
    """The table after a step, seen from its start: ``carried`` (m, n) by points of the sweep at ``elapsed``.

    What is touched for the first time carries ``-moduli G`` (n,) beside what is smooth along the path.
    """
    if not len(moduli):  # nothing is remembered
        return before
    parabola = swept.parabola
    entries = len(parabola)
    first_touched = np.minimum(swept.cuts[:-1], swept.cuts[1:]) >= before.edges[-1]
    shape = np.where(first_touched[:, None], -moduli, 0.0)
    values = np.column_stack((elapsed, carried))[1:-1].reshape(entries, len(NODES), -1)
    values[:, :, 1:] -= shape[:, None, :] * G[1:-1].reshape(entries, -1, 1)
    left = np.matmul(TO_POWERS, values)
    new: tuple[NDArray[Any], ...] = (
        np.full(entries, held),
        parabola,
        np.zeros(entries),
        left,
        shape,
    )
    edges = swept.cuts
    if edges[-1] < edges[0]:
        edges, new = edges[::-1], tuple(array[::-1] for array in new)
    first = int(before.edges.searchsorted(edges[0], side="left"))  # edges[:first] lie below the sweep
    last = int(before.edges.searchsorted(edges[-1], side="right"))  # edges[last:] beyond it
    below, above = slice(0, first), slice(last - 1, len(before.held))  # entries cut by its ends stay in part
    old = before.held, before.parabola, before.time, before.left, before.shape
    return Passages(
        np.concatenate((before.edges[:first], edges, before.edges[last:])),
        *(np.concatenate((was[below], part, was[above])) for was, part in zip(old, new, strict=True)),
    )


@dataclass(frozen=True, eq=False)
class Points:
    """Points that change sides where ``u_powers`` say, and the branch forces or unit strains before."""

    u_powers: Array
    phi: Array
    G: Array
    begun: Array


@dataclass(frozen=True, eq=False)
class Passed(Points):
    """Points the last of which are those of the ``sweep``."""

    sweep: SweptRadii

    @cached_property
    def swept(self) -> slice:
        """Those of the sweep."""
        return slice(-len(self.sweep.weight), None)

    @cached_property
    def bare(self) -> Points:
        """The same under a plane face, and on a surface that was never touched."""
        return Points(self.u_powers, np.ones((len(self.G), 1)), 0.0 * self.G, 0.0 * self.begun)


class Passing(NamedTuple):
    """Points in contact as the edge passes them, ``elapsed`` (m, 1) after the step began.

    ``left``: what they take along, unit strains of those released, branch forces less the gain of the step of
    those covered; ``end``: unit strains or branch forces at the end of the step.
    """

    elapsed: Array
    strain: Array
    branches: Array
    left: Array
    end: Array


def passing(rheology: Rheology, covers: bool, points: Points, motion: Motion) -> Passing:
    """Points that change sides, as they do and at the end of the step."""
    elapsed = motion.elapsed(points.u_powers)
    faded = np.expm1(-elapsed / rheology.times)
    gained, depth = motion.during(points, elapsed, faded)
    strain, rest = depth - points.G, elapsed - motion.duration
    if covers:
        units = points.begun * np.exp(-elapsed / rheology.retardation)
        branches = rheology.cover(units, strain)
        left = branches - gained
        end = left * np.exp(rest / rheology.times) + points.phi @ motion.end[0]
    else:
        branches = points.begun + points.begun * faded + gained
        left = rheology.release(branches, strain)
        end = left * np.exp(rest / rheology.retardation)
    return Passing(elapsed, strain, branches, left, end)
