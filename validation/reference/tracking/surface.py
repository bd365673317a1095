"""State of the half-space surface in Abel space: one edge, nodes where it has been, a Prony element at each.

Inside (``x <= a``) a node holds its branch forces ``b``, since ``w = D - G(x)`` is prescribed; outside its
unit strains ``e``, since ``q = 0`` there. The outermost node is untouched: beyond it ``e = 0``.
A step moves the edge from ``a0`` to ``a1``: points in between are covered or released *at the time the edge
passes them*, and every node is then carried to the end of the step exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite
from validation.reference.tracking.abel import Transform
from validation.reference.tracking.closure import EdgeFields
from validation.reference.tracking.edge_path import EdgePath
from validation.reference.tracking.penetration_path import PenetrationPath
from validation.reference.tracking.rheology import Rheology

Array = NDArray[np.float64]

COINCIDENT = 1e-14
"""Distance of the two nodes on either side of a discontinuity of the fields or their slopes, in radii."""
DIFFERENT_STATES = 1e-9
"""Relative difference above which the states on the two sides of the edge are not one state."""


@dataclass(frozen=True)
class Body:
    """Material and indenter in Abel space, constant during a run."""

    rheology: Rheology
    transform: Transform


@dataclass(frozen=True)
class Surface:
    """State at one time; ``inside`` (m,) ends at the edge, ``outside`` (l,) begins there."""

    penetration: float
    inside: Array
    branches: Array
    outside: Array
    units: Array

    @property
    def radius(self) -> float:
        """Contact radius."""
        return float(self.inside[-1])

    def edge_fields(self) -> EdgeFields:
        """The fields in the closure integral."""
        return EdgeFields(
            self.inside, self.branches.sum(axis=1), self.outside, self.units.sum(axis=1), self.penetration
        )

    def force(self, body: Body) -> float:
        """``F = 2 int_0^a q dx``."""
        a = self.radius
        elastic = body.rheology.relaxed * (self.penetration * a - body.transform.integral(a))
        return 2.0 * (elastic + float(hermite.integral(self.inside, self.branches.sum(axis=1))))

    def edge_stress(self, body: Body) -> float:
        """``q(a-)``."""
        strain = self.penetration - float(body.transform(self.inside[-1:])[0])
        return body.rheology.relaxed * strain + float(self.branches[-1].sum())

    def edge_overlap(self, body: Body) -> float:
        """``-d(a+)``: positive where the indenter would overlap the free surface next to the edge."""
        strain = self.penetration - float(body.transform(self.outside[:1])[0])
        return strain - float(self.units[0].sum())

    def after_detachment(self, body: Body) -> Surface:
        """The surface right after all contact is lost."""
        strain = self.penetration - body.transform(self.inside)
        units = body.rheology.release(self.branches, strain)
        inner = self.inside.copy()
        _shift_last_inwards(inner)
        return Surface(
            self.penetration,
            np.zeros(1),
            np.zeros((1, self.branches.shape[1])),
            np.concatenate((inner, self.outside)),
            np.concatenate((units, self.units)),
        )

    def with_edge_nodes_doubled(self) -> Surface:
        """The same with a second node beside the edge on either side, for an edge whose speed jumps now.

        Slopes of the fields jump there; each side then takes them from its own nodes.
        """
        radius, apart = self.radius, COINCIDENT * self.radius
        if radius == 0.0:
            return self
        inside, branches, outside, units = self.inside, self.branches, self.outside, self.units
        if len(inside) > 1 and inside[-2] < radius - 2.0 * apart:
            inside = np.concatenate((inside[:-1], [radius - apart, radius]))
            branches = np.concatenate((branches, branches[-1:]))
        if len(outside) > 1 and outside[1] > radius + 2.0 * apart:
            outside = np.concatenate(([radius, radius + apart], outside[1:]))
            units = np.concatenate((units[:1], units))
        return Surface(self.penetration, inside, branches, outside, units)

    def near(self, low: float, high: float) -> Surface:
        """The part between two radii, with a few nodes beyond on either side."""
        first = max(int(self.inside.searchsorted(low)) - 4, 0)
        last = int(self.outside.searchsorted(high)) + 4
        return Surface(
            self.penetration,
            self.inside[first:],
            self.branches[first:],
            self.outside[:last],
            self.units[:last],
        )


@dataclass(frozen=True)
class FieldUpdate:
    """Update of the points that the edge does not pass in a step; the same for every path of the edge.

    ``b -> decay b + gain`` in contact, ``e -> recovery e`` outside. ``was_at_rest``: the edge has been at
    rest, and the states on its two sides are no longer one state in two representations.
    """

    depth: PenetrationPath
    decay: Array
    gain: Array
    recovery: Array
    was_at_rest: bool


def field_update(surface: Surface, body: Body, depth: PenetrationPath) -> FieldUpdate:
    """Update of a surface under a penetration that follows ``depth``."""
    rheology, h = body.rheology, depth.duration
    decay = np.exp(-h / rheology.times)
    memory = depth.memory(np.zeros(1), np.array([h]), rheology.times)[0]
    gain = (memory + decay * depth.jump) * rheology.moduli
    return FieldUpdate(depth, decay, gain, np.exp(-h / rheology.retardation), _sides_differ(surface, body))


def after_step(surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array) -> Surface:
    """The surface at the end of a step.

    Parameters
    ----------
    surface : Surface
        State at the start.
    body : Body
    by : FieldUpdate
        Update of the points that the edge does not pass.
    path : EdgePath
        Edge radius during the step.
    fractions : ndarray, shape (m,)
        Further moments at which nodes are left, as fractions of the step; rising, within (0, 1).

    Returns
    -------
    Surface
    """
    if path.travel > 0.0:
        return _advanced(surface, body, by, path, fractions)
    if path.travel < 0.0:
        return _receded(surface, body, by, path, fractions)
    return Surface(
        by.depth.end,
        surface.inside,
        surface.branches * by.decay + by.gain,
        surface.outside,
        surface.units * by.recovery,
    )


def _advanced(surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array) -> Surface:
    rheology, depth, h = body.rheology, by.depth, by.depth.duration
    radius = path.start + path.travel
    beyond = int(surface.outside.searchsorted(radius, side="right"))
    old = surface.outside[1:beyond]
    old = old[old < radius]
    x = np.array([radius])
    if len(fractions) or len(old):
        x = np.unique(np.concatenate((path(fractions), old, x)))
        x = x[x > path.start]
    near, free = surface.outside[: beyond + 3], surface.units[: beyond + 3]
    units = hermite.evaluate(near, free, hermite.slopes(near, free), x)
    beside = path.start + min(COINCIDENT * radius, 0.5 * (float(x[0]) - path.start))
    if by.was_at_rest and path.start < beside < x[0]:  # the free side of the edge is covered now
        x = np.concatenate(([beside], x))
        units = np.concatenate((surface.units[:1], units))
    at = h * path.passing(x)
    covered = rheology.cover(
        units * np.exp(-at[:, None] / rheology.retardation), depth.penetration(at) - body.transform(x)
    )
    left = np.full_like(at, h)
    covered = covered * np.exp(-(left - at)[:, None] / rheology.times)
    covered = covered + depth.memory(at, left, rheology.times) * rheology.moduli
    return Surface(
        depth.end,
        np.concatenate((surface.inside, x)),
        np.concatenate((surface.branches * by.decay + by.gain, covered)),
        np.concatenate(([radius], surface.outside[beyond:])),
        np.concatenate((units[-1:], surface.units[beyond:])) * by.recovery,
    )


def _receded(surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array) -> Surface:
    rheology, depth, h = body.rheology, by.depth, by.depth.duration
    radius = path.start + path.travel
    kept = int(surface.inside.searchsorted(radius, side="left"))
    passed = int(surface.inside.searchsorted(radius, side="right"))
    x = np.concatenate(([radius], path(fractions), surface.inside[passed:]))
    if len(fractions):
        x = np.unique(x)
    first = max(kept - 3, 0)
    near = surface.inside[first:]
    slope = hermite.slopes(near, surface.branches[first:])
    start = hermite.evaluate(near, surface.branches[first:], slope, x) + depth.jump * rheology.moduli
    at = h * path.passing(x)
    at[0] = h
    branches = start * np.exp(-at[:, None] / rheology.times)
    branches = branches + depth.memory(np.zeros_like(at), at, rheology.times) * rheology.moduli
    units = rheology.release(branches, depth.penetration(at) - body.transform(x))
    units = units * np.exp(-(h - at)[:, None] / rheology.retardation)
    outside = surface.units * by.recovery
    if by.was_at_rest:  # the fields are discontinuous there
        _shift_last_inwards(x)
        rest = 0
    else:
        rest = 1
    return Surface(
        depth.end,
        np.concatenate((surface.inside[:kept], [radius])),
        np.concatenate((surface.branches[:kept] * by.decay + by.gain, branches[:1])),
        *_distinct(np.concatenate((x, surface.outside[rest:])), np.concatenate((units, outside[rest:]))),
    )


def _shift_last_inwards(x: Array) -> None:
    """Shift the last of the nodes, at the edge, to its inner side."""
    x[-1] -= min(COINCIDENT * x[-1], 0.5 * (x[-1] - x[-2]))


def _distinct(x: Array, values: Array) -> tuple[Array, Array]:
    """Nodes without those that round onto the one before."""
    apart = x[1:] > x[:-1]
    if apart.all():
        return x, values
    kept = np.concatenate(([True], apart))
    return x[kept], values[kept]


def _sides_differ(surface: Surface, body: Body) -> bool:
    """Whether releasing the edge from inside would leave another state than the one just outside."""
    strain = surface.penetration - body.transform(surface.inside[-1:])
    released = body.rheology.release(surface.branches[-1:], strain)[0]
    gap = np.abs(released - surface.units[0]).sum()
    return bool(gap > DIFFERENT_STATES * (np.abs(released).sum() + np.abs(strain[0])))
