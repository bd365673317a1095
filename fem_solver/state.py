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
    is smooth, the last one first. Energy that is finer than the elements hold is ``unresolved`` outside, by
    modes, ``uneven`` in contact, by branches, and ``borders`` where steps have left it within nodes;
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
    dissipated: float = 0.0
    received: float = 0.0
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

    Inside the contact the components follow from the penetration, and the branch variables are interpolated;
    outside both are interpolated together, so that the surface remains free of forces. Neither is
    interpolated across the edge. Elements are wide away from it: inside, each takes the mean over its share
    of the stiffness, so that the force stays where an edge has left a jump behind. What the surface holds
    within an element is kept as an energy, which relaxes as the surface there does.
    """
    if old.place == new.place:
        return state
    edge = new.geometry.position(state.radius) if state.edge > NO_CONTACT else NO_CONTACT
    inside, top = int(np.floor(state.edge)) + 1, int(np.floor(edge)) + 1
    outside = inside + (state.edge > inside - 1)  # the partly released node is neither
    known = state.record or SurfaceRecord(
        old.positions, state.branches / old.unit, old.profile / old.unit, inside
    )
    x, intensity, share = known.positions, known.intensity, edge - (top - 1)
    free = known.edge + outside - inside
    within, uneven = _in_contact(known, new, top, solid)
    beyond = interpolated(x[free:], intensity[:, free:], new.positions[top:])
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
        uneven=uneven,
    )
    return _energy_conserved(state, old, moved, new, solid)


def _in_contact(known: SurfaceRecord, new: Placement, top: int, solid: Components) -> tuple[Array, Array]:
    """Intensities of the nodes ``0..top`` in contact, and the energies that wide elements do not hold."""
    x, intensity = known.positions[: known.edge], known.intensity[:, : known.edge]
    within = interpolated(x, intensity, new.positions[: top + 1])
    wide = min(int(new.lowest), top)
    shares = np.concatenate([[0.0], new.geometry.effective[:wide]])
    within[:, :wide] = averaged(x, intensity, shares)
    spread = averaged(x, intensity**2, shares) - within[:, :wide] ** 2
    return within, solid.uneven_energies(np.maximum(spread, 0.0), new.unit[:wide])


def _energy_conserved(
    state: ComponentState, old: Placement, moved: ComponentState, new: Placement, solid: Components
) -> ComponentState:
    """The moved state, with the energy that wider elements do not hold, in the modes of the surface outside.

    That is at most what the surface outside has held. The energy of the contact differs between two meshes as
    well, by a hundred-thousandth: an error that goes when the contact goes, and that a surface without force
    would keep. What the interface holds in the partly released node has been work done on the surface.
    """
    outside = solid.free_energies(moved.branches[:, _first_free(moved) :])
    if outside.sum() <= 0.0:
        return moved
    before, after = interface_energy(state, old, solid), interface_energy(moved, new, solid)
    lost = _stored(state, solid) - _stored(moved, solid) + before - after
    free = slice(_first_free(state), None)
    held = float(np.sum(solid.stored(state.components[free], state.branches[:, free])))
    held = max(held + float(np.sum(state.unresolved)), 0.0)
    least = -float(outside.sum() + np.sum(state.unresolved))
    return replace(
        moved,
        unresolved=state.unresolved + np.clip(lost, least, least + 2.0 * held) * outside / outside.sum(),
        received=state.received + before - after,
    )


def _first_free(state: ComponentState) -> int:
    """The first node that is free, not released in part."""
    return int(np.floor(state.edge)) + 2


def _stored(state: ComponentState, solid: Components) -> float:
    """Energy that the elements hold, and the branches within an element in contact."""
    return float(np.sum(solid.stored(state.components, state.branches)) + np.sum(state.uneven))


def interface_energy(state: ComponentState, placement: Placement, solid: Components) -> float:
    """Energy that the radii of the partly released node hold beyond their mean."""
    if state.edge <= NO_CONTACT:
        return 0.0
    node = int(np.floor(state.edge)) + 1
    imposed = state.penetration * placement.unit[node] - placement.profile[node]
    mean = state.components[node : node + 1], state.branches[:, node : node + 1]
    contact = np.array([imposed]), state.held[:, None]
    return NodeParts(solid, state.edge - np.floor(state.edge), mean, contact).energy_beyond_mean
