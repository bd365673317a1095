"""Contact states at the end of a step, with every node released or covered in its own time.

The edge is a real number ``s`` as in ``release``: nodes ``0..floor(s)`` are in full contact, the next one
partly. A step may pass over any number of nodes. A node that the edge leaves behind goes through three times:

1. in contact, until the edge is there (``s = j``): ``v_j`` as imposed, the penetration linear in time;
2. partly released, until the edge is at the node before it (``s = j - 1``): its force is the share
   ``s - (j - 1)`` of that in contact and goes linearly to zero;
3. free, until the end of the step: it recovers, exactly.

A node that the edge covers goes through them in reverse; partly covered, ``v_j`` is the mean of what is
imposed and what recovers, by its share. Component j stands for the radii between two positions of the edge:
both are the means over them of what a continuous edge leaves there. The times follow from its path (see
``path``). Where all happens at once (a load jump, the start) every node has the second time only.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from contact_scene.loading import Control
from fem_solver.edge_geometry import EdgeOrigin
from fem_solver.following.closure import closure_integral, zone_at
from fem_solver.following.components import Components
from fem_solver.following.passage import NodePassage, PartlyReleased
from fem_solver.following.path import EdgePolynomial
from fem_solver.following.placement import Placement
from fem_solver.following.state import FollowingState
from fem_solver.following.surface_record import EdgePassage, SurfaceRecord

Array = NDArray[np.float64]

_LEAST_CHANGE = 1e-6
"""Change of the penetration from which the stiffness is told, at least, relative to it: near the axis of a
flat profile its height is below a rounding error of the penetration."""


class FollowingProblem:
    """All contact states possible at one instant, as functions of the edge position.

    Parameters
    ----------
    placement : Placement
    solid : Components
    state : FollowingState
        At the begin of the step, at this place of the mesh.
    dt : float
        Length of the step; 0 for a glassy response, infinite for a relaxed one.
    control : "penetration", "force" or "stage"
    value : float
        Of the controlled quantity.
    compliance : float
        Of the machine, through which the stage acts.

    Attributes
    ----------
    stiffness, held_force : ndarray, shape (n,)
        Of contact of the nodes ``0..m`` throughout the step, for every m: force per unit of penetration, and
        the force that is left at none.
    """

    control: Control

    def __init__(
        self,
        placement: Placement,
        solid: Components,
        state: FollowingState,
        dt: float,
        control: Control,
        value: float,
        compliance: float = 0.0,
    ) -> None:
        self.placement, self.solid, self.state = placement, solid, state
        self.geometry, self.dt, self.control, self.value = placement.geometry, dt, control, value
        self.compliance = compliance
        self.at_once = not 0.0 < dt < math.inf or state.edge < 0.0 or not solid.modulus.times.size
        self.evaluations = 0
        # of the edge asked for last: penetration and nodes in motion; all components and branch variables
        self._passage: tuple[float, float, NodePassage] | None = None
        self._arrival: tuple[float, Array, Array] | None = None
        self._partly = int(np.floor(state.edge)) + 1 if state.edge >= 0.0 else None
        step = solid.modulus.increment(dt)
        self.modulus, start = step.modulus, -placement.profile - state.components
        # in contact throughout, per unit of penetration and without it
        self._gain = step.gain[:, None]
        self._base = step.decay[:, None] * state.branches + self._gain * start
        held = self.modulus * -placement.profile + step.memory(state.branches, state.components)
        self.stiffness = np.cumsum(self.modulus * placement.unit**2)
        self.held_force = np.cumsum(placement.unit * held)
        if self.at_once:
            self._free = solid.relieved(state.components, state.branches, dt)
            self._free_branches = solid.linear(state.components, state.branches, dt, self._free)
        else:
            self._free, self._free_branches = solid.recovered(state.branches, dt)

    @property
    def origin(self) -> EdgeOrigin | None:
        """Where the edge starts the step, at this place of the mesh; ``None`` without contact."""
        return self.state.origin

    def penetration(self, s: float) -> float:
        """Penetration at edge position ``s``."""
        if self.control == "penetration":
            return self.value
        if s < 0.0 and self.control == "stage":
            return self.value
        if s < 0.0:  # no contact yet: the penetration at which the indenter first touches
            free = self.placement.displacement(self._free)
            return float((self.placement.height + free)[self.placement.radii <= self.placement.rim].min())
        return self._in_equilibrium(s)[0]

    def _in_equilibrium(self, s: float) -> tuple[float, NodePassage]:
        """Penetration, and the nodes that are in motion, with the edge at ``s`` >= 0."""
        if self._passage is None or self._passage[0] != s:
            self._passage = s, *self._found(s)
        return self._passage[1:]

    def _found(self, s: float) -> tuple[float, NodePassage]:
        pass_at = self._passages(s)
        if self.control == "penetration":
            return self.value, pass_at(self.value, False)
        first = self.state.penetration
        change = max(float(self.placement.height[int(s) + 1]), _LEAST_CHANGE * abs(first))
        second = first + (change or self.placement.scale)
        one, other = pass_at(first, False), pass_at(second, False)
        low, high = self._force_of(s, first, one), self._force_of(s, second, other)
        stiffness = (high - low) / (second - first)  # the force is linear in the penetration
        if self.control == "stage":  # X = D + F/k
            rise = (self.value - first - self.compliance * low) / (1.0 + self.compliance * stiffness)
        else:
            rise = (self.value - low) / stiffness
        return first + rise, one.towards(other, rise / (second - first))

    def force(self, s: float) -> float:
        """Total force."""
        if self.control == "force":
            return self.value
        if s < 0.0:
            return 0.0
        v, b = self.arrival(s)
        loaded = slice(math.floor(s) + 2)
        return float(self.placement.unit[loaded] @ self.solid.force(v[loaded], b[:, loaded]))

    def singular_force(self, s: float) -> float:
        """Force of the flat punch, as large as the contact, that leaves the same edge singularity."""
        m = int(np.floor(s))
        if m < 0:
            return 0.0
        v, b = self.arrival(s)
        unit = self.placement.unit[: m + 1]
        return float(self.solid.force(v[m : m + 1], b[:, m : m + 1])[0] / unit[m] * (unit @ unit))

    def _force_of(self, s: float, penetration: float, passage: NodePassage) -> float:
        low = self._changing(s)[0]
        top = int(np.floor(s)) + 1
        loaded = self.solid.force(passage.v, passage.b)[: top + 1 - low]
        total = float(self.placement.unit[low : top + 1] @ loaded)
        inner = self.stiffness[low - 1] * penetration + self.held_force[low - 1] if low else 0.0
        return total + float(inner)

    def _changing(self, s: float) -> tuple[int, int]:
        """Range of the nodes that are not in contact, or free, throughout the step."""
        edges = sorted((max(self.state.edge, -1.0), s))
        return int(np.floor(edges[0])) + 1, min(int(np.floor(edges[1])) + 2, len(self.placement.unit))

    def _passages(self, s: float) -> Callable[[float, bool], NodePassage]:
        """The nodes in motion at the end of the step with the edge at ``s``, for a penetration there; with
        energies if they are asked for."""
        here, state = self.placement, self.state
        low, high = self._changing(s)
        nodes, index = slice(low, high), np.arange(low, high)
        unit, profile = here.unit[nodes], here.profile[nodes]
        start = state.components[nodes], state.branches[:, nodes], state.held
        share = np.clip(s - index + 1.0, 0.0, 1.0)  # of full contact at the end
        released = self._released_in_part(low, high)
        opens, at = False, np.zeros(0)
        if not self.at_once:
            path = self._path(s)
            ends = np.append(self.geometry.effective[low - 1] if low else 0.0, self.geometry.effective[nodes])
            opens, at = path.opens, path.passed(ends)
        partly, before = int(np.floor(state.edge)) + 1 - low, state.edge - np.floor(state.edge)

        def passed(penetration: float, accounts: bool) -> NodePassage:
            passage, change = NodePassage(self.solid, *start, accounts), penetration - state.penetration

            def imposed(theta: Array) -> Array:
                return (state.penetration + theta * change) * unit - profile

            if self.at_once:
                ends = penetration * unit - profile, self._free[nodes]
                passage.at_once(self.dt, share, *ends, released)
            elif opens:
                passage.release(self.dt, share[0], at[1:], at[:-1], imposed, partly, before)
            else:
                passage.cover(self.dt, share, at[:-1], at[1:], imposed, before)
            return passage

        return passed

    def _path(self, s: float) -> EdgePolynomial:
        """Path of the edge over the step."""
        state = self.state
        return EdgePolynomial.through(state.radius, self.geometry.radius(s), self.dt, state.before)

    def _moments(self, s: float) -> Callable[[Array], Array]:
        """Shares of the step at which the edge, on its way to ``s``, is at radii."""
        return np.ones_like if self.at_once else self._path(s).passed

    def _released_in_part(self, low: int, high: int) -> PartlyReleased | None:
        """The node in contact in part at the begin, if it is one of ``low..high-1``."""
        node, state = self._partly, self.state
        if node is None or node >= high:
            return None
        contact = state.penetration * self.placement.unit[node] - self.placement.profile[node]
        return PartlyReleased(node - low, float(state.edge - np.floor(state.edge)), float(contact))

    def arrival(self, s: float) -> tuple[Array, Array]:
        """Components and branch variables at the end of the step; shapes (n,) and (branches, n)."""
        if self._arrival is None or self._arrival[0] != s:
            self._arrival = s, *self._arrived(s, False)[:2]
        return self._arrival[1:]

    def _arrived(self, s: float, accounts: bool) -> tuple[Array, Array, NodePassage]:
        here, penetration = self.placement, self.penetration(s)
        low, high = self._changing(s)
        if accounts or s < 0.0:
            passage = self._passages(s)(penetration, accounts)
        else:
            passage = self._in_equilibrium(s)[1]
        held = penetration * here.unit[:low] - here.profile[:low]
        within = self._base[:, :low] + self._gain * penetration * here.unit[:low]
        v = np.concatenate([held, passage.v, self._free[high:]])
        return v, np.hstack([within, passage.b, self._free_branches[:, high:]]), passage

    def accepted(self, s: float) -> FollowingState:
        """The state at the end of the step."""
        v, b, passage = self._arrived(s, True)
        low, high = self._changing(s)
        for nodes in (slice(0, low), slice(high, None)):
            started = self.state.components[nodes], self.state.branches[:, nodes]
            rest = NodePassage(self.solid, *started, self.state.held, True)
            if nodes.stop is None and not self.at_once:
                rest.recover(np.full(len(rest.v), self.dt))
            else:
                rest.linear(np.full(len(rest.v), self.dt), v[nodes])
            passage.dissipated += rest.dissipated
            passage.received += rest.received
        state = self.state
        unresolved = self.solid.remaining(state.unresolved, self.dt)
        uneven = self.solid.remaining_in_contact(state.uneven, self.dt)
        relaxed = float(np.sum(state.unresolved - unresolved) + np.sum(state.uneven - uneven))
        edge = state.radius, self.geometry.radius(s)
        borders, lost, passed = state.borders.after(self.solid, self.dt, edge, self._moments(s))
        if passage.beyond is not None and edge[0] != edge[1]:
            known = borders.with_border(state.radius, passage.beyond)
            borders = known.most_energetic(self.solid)
            lost += known.stored(self.solid) - borders.stored(self.solid)
        return FollowingState(
            place=self.placement.place,
            components=v,
            branches=b,
            held=passage.held[:, 0],
            penetration=self.penetration(s),
            radius=edge[1],
            edge=s,
            before=() if self.at_once else state.rows_and_this(self.dt),
            dissipated=state.dissipated + passage.dissipated + relaxed + lost,
            received=state.received + passage.received + passed,
            updates=state.updates + 1,
            unresolved=unresolved,
            uneven=uneven,
            borders=borders,
            record=self._recorded(s, b),
        )

    def _recorded(self, s: float, b: Array) -> SurfaceRecord:
        """The surface at the end of the step; from the mesh where that is fine."""
        here, state = self.placement, self.state
        nodes = SurfaceRecord(here.positions, b / here.unit, here.profile / here.unit, int(np.floor(s)) + 1)
        if state.record is None or s < 0.0:
            return nodes
        ends, sites = here.geometry.effective[nodes.edge - 1 :], here.positions[nodes.edge :]
        # components sit aside of the middle of their radii by an error of the stiffness: the same all around
        sited = 2.0 * (sites[0] + sites[1]) / (ends[0] + 2.0 * ends[1] + ends[2])
        moments = self._moments(s)
        penetrations = state.penetration, self.penetration(s)
        edge = sited * self.geometry.radius(s)
        step = EdgePassage(self.dt, penetrations, edge, lambda x: moments(x / sited))
        fine = slice(int(here.lowest), self.geometry.last + 1)
        return state.record.after(self.solid, step, nodes).renewed(nodes, fine)

    def forces(self, s: float) -> Array:
        """All nodal forces, compressive positive; shape (n,)."""
        v, b = self.arrival(s)
        loaded = np.zeros(len(v))
        end = int(np.floor(s)) + 2
        loaded[:end] = self.solid.force(v[:end], b[:, :end])
        return self.placement.forces(loaded)

    def closure(self, s: float) -> float:
        """Closure integral, an energy per area (see ``closure``); minus infinity under pressure."""
        self.evaluations += 1
        return closure_integral(self.placement, self.solid, s, self.penetration(s), *self.arrival(s))

    def zone(self, s: float) -> float:
        """Length of the process zone; at fixed stress at most the contact radius."""
        if self.geometry.stress is None:
            return self.geometry.zone or 0.0
        return zone_at(self.placement, self.solid, s, *self.arrival(s))
