"""State of the half-space surface in Abel space: one edge, nodes where it has been, a Prony element at each.

Inside (``x <= a``) a node holds its branch forces ``b``, since ``w = D - G(x)`` is prescribed; outside its
unit strains ``e``, since ``q = 0`` there. The outermost node is untouched: beyond it ``e = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.rheology import Body, total
from validation.reference.tracking import hermite
from validation.reference.tracking.closure import EdgeFields

Array = NDArray[np.float64]

COINCIDENT = 1e-14
"""Distance of the two nodes on either side of a discontinuity of the fields or their slopes, in radii."""


@dataclass(frozen=True)
class Surface:
    """State at one time; ``inside`` (m,) ends at the edge, ``outside`` (l,) begins there.

    ``tip_energy``: what the sharp edge released in the step that led here.
    """

    penetration: float
    inside: Array
    branches: Array
    outside: Array
    units: Array
    tip_energy: float = 0.0

    @property
    def radius(self) -> float:
        """Contact radius."""
        return float(self.inside[-1])

    @cached_property
    def memory(self) -> Array:
        """``sum_k b_k`` (m,)."""
        return total(self.branches)

    @cached_property
    def branch_slopes(self) -> Array:
        """Slopes of the branch forces at the nodes (m, n)."""
        return hermite.slopes(self.inside, self.branches)

    @cached_property
    def unit_slopes(self) -> Array:
        """Slopes of the unit strains at the nodes (l, n)."""
        return hermite.slopes(self.outside, self.units)

    def branches_at(self, x: Array) -> Array:
        """Branch forces (p, n) at points inside (p,)."""
        return hermite.evaluate(self.inside, self.branches, self.branch_slopes, x)

    def units_at(self, x: Array) -> Array:
        """Unit strains (p, n) at points outside (p,)."""
        return hermite.evaluate(self.outside, self.units, self.unit_slopes, x)

    def edge_fields(self) -> EdgeFields:
        """The fields in the closure integral."""
        return EdgeFields(self.inside, self.memory, self.outside, total(self.units), self.penetration)

    def force(self, body: Body) -> float:
        """``F = 2 int_0^a q dx``."""
        a = self.radius
        elastic = body.rheology.relaxed * (self.penetration * a - body.transform.integral(a))
        return 2.0 * (elastic + float(hermite.integral(self.inside, self.memory)))

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
        shift_last_inwards(inner)
        return Surface(
            self.penetration,
            np.zeros(1),
            np.zeros((1, self.branches.shape[1])),
            *distinct(np.concatenate((inner, self.outside)), np.concatenate((units, self.units))),
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

    def nodes_between(self, low: float, high: float) -> tuple[int, int]:
        """First node inside and last one outside between two radii, with a few beyond on either side."""
        first, last = int(self.inside.searchsorted(low)) - 4, int(self.outside.searchsorted(high)) + 4
        return max(first, 0), min(last, len(self.outside))

    def part(self, first: int, last: int) -> Surface:
        """The part from one node inside up to one outside."""
        inside, branches = self.inside[first:], self.branches[first:]
        return Surface(self.penetration, inside, branches, self.outside[:last], self.units[:last])


def shift_last_inwards(x: Array) -> None:
    """Shift the last of the nodes, at the edge, to its inner side."""
    x[-1] -= min(COINCIDENT * x[-1], 0.5 * (x[-1] - x[-2]))


def distinct(x: Array, values: Array) -> tuple[Array, Array]:
    """Nodes without those that the next one rounds onto: the last before a discontinuity is there, too."""
    apart = x[1:] > x[:-1]
    if apart.all():
        return x, values
    kept = np.concatenate((apart, [True]))
    return x[kept], values[kept]
