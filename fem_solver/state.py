"""State of the surface components, and its transfer from one place of the mesh to another."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem_solver.components import Components
from fem_solver.edge_path import NO_CONTACT, Row
from fem_solver.nodes import NodeBorders, NodeParts, NodeStrips
from fem_solver.placement import Placement
from fem_solver.surface_record import SurfaceRecord, averaged, interpolated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ComponentState:
    """Internal variables of the components at one place of the mesh, and where the edge is.

    ``components`` are ``v`` (n,), ``branches`` ``b_k`` (branches, n), ``edge`` is the position in nodes, -1
    without contact. ``held`` are the branch variables that the partly released node would have if it had
    stayed in contact, ``strips`` those of its radii, ``left`` those of the nodes within which the edge has
    begun to recede, and that it has left, as far out as the closure looks; it sees of a node the radii within
    its zone, and where the edge turned they jump. ``at_edge`` are those of a component at the edge, over
    ``e``, without adhesion: nothing jumps there. ``before`` are the rows from which on the path of the edge
    is smooth, the last one first; ``sunk`` are the time and the change of the penetration since the last one,
    or none after a kink. Energy that is finer than the elements hold is ``unresolved`` outside, by modes,
    ``uneven`` in contact, by branches, and ``borders`` where steps have left it within nodes;
    ``record`` is the surface where earlier meshes were finer.
    """

    place: Any
    components: Array
    branches: Array
    held: Array
    strips: NodeStrips | None = None
    left: dict[int, NodeStrips] = field(default_factory=dict)
    at_edge: Array = field(default_factory=lambda: np.zeros(0))
    penetration: float = 0.0
    radius: float = 0.0
    edge: float = NO_CONTACT
    before: tuple[Row, ...] = ()
    sunk: tuple[float, float] | None = None
    dissipated: float = 0.0
    opening: float = 0.0
    updates: int = 0
    unresolved: Array = field(default_factory=lambda: np.zeros(0))
    uneven: Array = field(default_factory=lambda: np.zeros(0))
    borders: NodeBorders = field(default_factory=lambda: NodeBorders.none(0))
    record: SurfaceRecord | None = None

    def opening_speed(self, radius: float, dt: float) -> float:
        """Speed at which the edge recedes at the end of a step to ``radius``; infinite in no time.

        By the backward differentiation formula through the row before, where there is one.
        """
        if dt <= 0.0:
            return math.inf
        mean = (self.radius - radius) / dt
        if not self.before:
            return mean
        duration, earlier = self.before[0]
        return mean + (mean + (self.radius - earlier) / duration) * dt / (dt + duration)

    def turns(self, radius: float) -> bool:
        """Whether an edge that has not receded so far does so on its way to a radius."""
        return radius < self.radius and not (self.before and self.before[0][1] > self.radius)

    def sees_corner(self, radius: float) -> bool:
        """Whether an edge on its way to a radius leaves within its zone an element in which it has turned."""
        return bool(self.left) or (self.strips is not None and (self.strips.turned or self.turns(radius)))

    def bend(self, dt: float) -> tuple[float, float]:
        """Bend of the penetration over a step: per change of it, and at none.

        The parabola goes through the row before, where there is one.
        """
        if self.sunk is None or not 0.0 < dt < math.inf:
            return 0.0, 0.0
        duration, change = self.sunk
        share = dt / (dt + duration)
        return share, -share * change * dt / duration

    def rows_and_this(self, dt: float) -> tuple[Row, ...]:
        """The two rows before the end of a step from here, through which the path of the next one goes."""
        earlier = tuple((age + dt, radius) for age, radius in self.before[:1])
        return (dt, self.radius), *earlier


def undeformed(placement: Placement, branches: int) -> ComponentState:
    """The state before any contact."""
    nodes = len(placement.radii)
    return ComponentState(
        place=placement.place,
        components=np.zeros(nodes),
        branches=np.zeros((branches, nodes)),
        held=np.zeros(branches),
        at_edge=np.zeros(branches),
        unresolved=np.zeros(branches),
        uneven=np.zeros(branches),
        borders=NodeBorders.none(branches),
    )


def transferred(state: ComponentState, old: Placement, new: Placement, solid: Components) -> ComponentState:
    """The same state with the mesh at another place.

    Inside the contact the components follow from the penetration, and the branch variables from the surface
    on that side of the edge, where the indenter is as deep: at the tip of a cone wide elements have it a
    hundredth off, and have borne what goes with that. Outside the components follow from the branch
    variables, so that the surface remains free of forces. Elements are wide away from the strip: there a node
    takes the mean over its radii, so that forces stay where an edge has left a jump behind. What the surface
    holds beyond the means is kept as an energy, which relaxes as the surface there does: in contact as far as
    its points tell, outside all of it. The contact's energy differs between two meshes by a hundred-
    thousandth as well: an error that goes when the contact goes, and that a surface without force would keep.
    What the interface holds in the partly released node has been work of opening.
    """
    if old.place == new.place:
        return state
    touches = state.edge > NO_CONTACT
    edge = new.geometry.position(state.radius) if touches else NO_CONTACT
    inside, top = math.floor(state.edge) + 1, math.floor(edge) + 1
    known = state.record or SurfaceRecord(
        old.positions, state.branches / old.unit, old.profile / old.unit, inside
    )
    # the partly released node is neither in contact nor free
    share, free = edge - (top - 1), slice(known.edge + (state.edge > inside - 1), None)
    # radii between which the nodes are, beside the edge as the record has it
    at_edge = old.site(state.edge) if touches else 0.0
    ends = at_edge + np.append(0.0, new.geometry.effective) - state.radius
    x, b = known.positions[: known.edge], known.intensity[:, : known.edge]
    depths = known.profile[: known.edge]
    told = (depths, new.depths) if (np.diff(depths) > 0.0).all() else (x, new.positions)
    within, squares = np.split(_on_nodes(x, np.vstack([b, b**2]), new, 0, ends[: top + 2], told), 2)
    spread = np.where(new.wide[: top + 1], np.maximum(squares - within**2, 0.0), 0.0)
    ends = np.append(max(ends[top], at_edge), ends[top + 1 :])
    x = known.positions[free]
    beyond = _on_nodes(x, known.intensity[:, free], new, top, ends, (x, new.positions))
    between = share * within[:, -1:] + (1.0 - share) * beyond[:, :1]
    imposed = state.penetration * new.unit - new.profile
    recovered = -new.unit[top:] * beyond.sum(axis=0) / solid.modulus.relaxed
    recovered[0] += share * (imposed[top] - recovered[0])
    moved = replace(
        state,
        place=new.place,
        components=np.concatenate([imposed[:top], recovered]),
        branches=np.hstack([within[:, :-1], between, beyond[:, 1:]]) * new.unit,
        held=within[:, -1] * new.unit[top],
        strips=None,
        left={},
        edge=edge,
        uneven=solid.uneven_energies(spread[:, :-1], new.unit[:top]),
    )
    springs = interface_energy(state, old, solid) - interface_energy(moved, new, solid)
    beyond_means = free_energies(state, old, solid) - free_energies(moved, new, solid)
    return replace(moved, opening=state.opening + springs, unresolved=state.unresolved + beyond_means)


def _on_nodes(
    x: Array, values: Array, new: Placement, first: int, ends: Array, told: tuple[Array, Array]
) -> Array:
    """What is known at points, on the nodes from the first on, between the ends of their radii.

    Where the mesh is fine it goes with what is ``told`` of points and of all nodes.
    """
    nodes = slice(first, first + len(ends) - 1)
    there = interpolated(told[0], values, told[1][nodes])
    return np.where(new.wide[nodes], averaged(x, values, ends), there)


def _node_in_part(state: ComponentState, placement: Placement, solid: Components) -> NodeParts:
    """The partly released node; the first one, free, without contact."""
    node = math.floor(state.edge) + 1
    share, here = state.edge - math.floor(state.edge), slice(node, node + 1)
    imposed = state.penetration * placement.unit[here] - placement.profile_within(here, share)
    mean = state.components[node : node + 1], state.branches[:, node : node + 1]
    return NodeParts(solid, share, mean, (imposed, state.held[:, None]))


def nodal_forces(state: ComponentState, placement: Placement, solid: Components) -> Array:
    """All nodal forces, compressive positive; shape (n,)."""
    y = solid.force(state.components, state.branches)
    y[math.floor(state.edge) + 2 :] = 0.0
    return placement.forces(y)


def interface_energy(state: ComponentState, placement: Placement, solid: Components) -> float:
    """Energy that the radii of the partly released node hold beyond their mean."""
    return _node_in_part(state, placement, solid).energy_beyond_mean


def free_energies(state: ComponentState, placement: Placement, solid: Components) -> Array:
    """Energy of the free radii by modes, as the elements hold it; shape (branches,)."""
    parts, beyond = _node_in_part(state, placement, solid), math.floor(state.edge) + 2
    outside = solid.free_energies(state.branches[:, beyond:])
    return outside + (1.0 - parts.share) * solid.free_energies(parts.free[1])
