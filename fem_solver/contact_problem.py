"""Contact states at the end of a step, with every node released or covered in its own time.

The edge is a real number ``s``: nodes ``0..floor(s)`` are in full contact, the next one
partly. A step may pass over any number of nodes. A node that the edge leaves behind goes through three times:

1. in contact, until the edge is there (``s = j``): ``v_j`` as imposed;
2. partly released, until the edge is at the node before it (``s = j - 1``): its force is the share
   ``s - (j - 1)`` of that in contact and goes linearly to zero;
3. free, until the end of the step: it recovers, exactly.

A node that the edge covers goes through them in reverse; partly covered, ``v_j`` is the mean of what is
imposed and what recovers, by its share. Component j stands for the radii between two positions of the edge:
both are the means over them of what a continuous edge leaves there. The times follow from its path (see
``edge_path``). Where all happens at once (a load jump, the start) every node has the second time only.

The penetration is a parabola in time, through its middle where it is prescribed, else through the row before:
exact for nodes that stay in contact; those on their way go linearly between its points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.loading import Control
from fem_solver.closure import ZoneShift, zone_of_stress
from fem_solver.components import Components
from fem_solver.edge_path import NO_CONTACT, EdgeMotion, EdgePolynomial, EdgePosition
from fem_solver.moduli import bend_through
from fem_solver.nodes import NodePassage, NodeStrips, PartlyReleased
from fem_solver.placement import Placement
from fem_solver.state import ComponentState
from fem_solver.surface_record import SurfaceRecord

Array = NDArray[np.float64]


class ContactProblem:
    """All contact states possible at one instant, as functions of the edge position.

    The step of length ``dt`` (0 for a glassy response, infinite for a relaxed one) begins with ``state``, at
    this place of the mesh; ``compliance`` is that of the machine, through which the stage acts, ``middle`` a
    penetration prescribed half-way. ``stiffness`` and ``held_force`` of contact of the nodes ``0..m``
    throughout the step, for every m, are the force per unit of penetration, and the force left at none.
    """

    control: Control

    def __init__(
        self,
        placement: Placement,
        solid: Components,
        state: ComponentState,
        dt: float,
        control: Control,
        value: float,
        compliance: float = 0.0,
        middle: float | None = None,
    ) -> None:
        self.placement, self.solid, self.state = placement, solid, state
        self.geometry, self.dt, self.control, self.value = placement.geometry, dt, control, value
        self.compliance = compliance
        self.at_once = not 0.0 < dt < math.inf or not solid.modulus.times.size
        self.evaluations = 0
        # of the edge asked for last: penetration and nodes in motion
        self._passage: tuple[float, float, NodePassage] | None = None
        self._step = step = solid.modulus.increment(dt)
        remembers = state.edge > NO_CONTACT and step.gain.size  # an elastic node has no past
        self._partly = math.floor(state.edge) + 1 if remembers else None
        self.modulus, self._gain = step.modulus, step.gain[:, None]
        self._bend = state.bend(dt)
        if middle is not None:
            self._bend = 0.0, bend_through(state.penetration, middle, value)
        memory = step.memory(state.branches, state.components)
        self._bends = float(step.bent.sum())
        self._stiff = (self.modulus + self._bends * self._bend[0]) * placement.unit
        self._held = (
            memory - self.modulus * placement.profile + self._bends * self._bent(0.0) * placement.unit
        )
        self.stiffness = np.cumsum(placement.unit * self._stiff)
        self.held_force = np.cumsum(placement.unit * self._held)
        self._memory = memory
        self._free, self._free_branches = self._freed(state.components, state.branches)

    def penetration(self, s: float) -> float:
        """Penetration at edge position ``s``."""
        if self.control == "penetration":
            return self.value
        if s <= NO_CONTACT and self.control == "stage":
            return self.value
        if s <= NO_CONTACT:  # no contact yet: the penetration at which the indenter first touches
            free = self.placement.displacement(self._free)
            return float((self.placement.height + free)[self.placement.radii <= self.placement.rim].min())
        return self._in_equilibrium(s)[0]

    def _in_equilibrium(self, s: float) -> tuple[float, NodePassage]:
        """Penetration, and the nodes that are in motion, with the edge at ``s``, in contact."""
        if self._passage is None or self._passage[0] != s:
            self._passage = s, *self._found(s)
        return self._passage[1:]

    def _found(self, s: float) -> tuple[float, NodePassage]:
        pass_at = self._passages(s)
        if self.control == "penetration":
            return self.value, pass_at(np.array([self.value]), False)
        first = self.state.penetration
        second = first + max(abs(first), self.placement.scale)
        both = pass_at(np.array([first, second]), False)
        low, high = self._forces_of(s, np.array([first, second]), both)
        stiffness = (high - low) / (second - first)  # the force is linear in the penetration
        if self.control == "stage":  # X = D + F/k
            rise = (self.value - first - self.compliance * low) / (1.0 + self.compliance * stiffness)
        else:
            rise = (self.value - low) / stiffness
        return first + rise, both.between(rise / (second - first))

    def force(self, s: float) -> float:
        """Total force."""
        if self.control == "force":
            return self.value
        if s <= NO_CONTACT:
            return 0.0
        penetration, passage = self._in_equilibrium(s)
        total = float(self._forces_of(s, np.array([penetration]), passage)[0])
        # without adhesion nothing pulls, nor does a node that is let go in part, by 1e-9 of the largest force
        return total if self.geometry.zone is not None else max(total, 0.0)

    def singular_force(self, s: float) -> float:
        """Force of the flat punch, as large as the contact, that leaves the same edge singularity."""
        m = math.floor(s)
        return float(self._bearing(s, m)[0] * self.stiffness[m] / self._stiff[m]) if m >= 0 else 0.0

    def _forces_of(self, s: float, penetrations: Array, passage: NodePassage) -> Array:
        """Total forces at each of the penetrations of a passage."""
        low, end = self._changing(s)[0], math.floor(s) + 2
        borne = self.solid.force(passage.v, passage.b).reshape(len(penetrations), -1)[:, : end - low]
        moving = borne @ self.placement.unit[low:end]
        return moving + self.stiffness[low - 1] * penetrations + self.held_force[low - 1] if low else moving

    def _bearing(self, s: float, first: int) -> Array:
        """``y`` of the nodes from one on that bear a force with the edge at ``s``."""
        penetration, passage = self._in_equilibrium(s)
        low, end = self._changing(s)[0], math.floor(s) + 2
        moving = self.solid.force(passage.v, passage.b)[max(first - low, 0) : end - low]
        inner = slice(first, low)
        return np.append(penetration * self._stiff[inner] + self._held[inner], moving)

    def _components(self, s: float, end: int) -> Array:
        """``v`` of the nodes up to an end beyond those that bear a force."""
        penetration, passage = self._in_equilibrium(s)
        low, high = self._changing(s)
        held = penetration * self.placement.unit[:low] - self.placement.profile[:low]
        return np.concatenate([held, passage.v, self._free[high:end]])[:end]

    def _in_contact(self, count: int, penetration: float) -> Array:
        """Branch variables of the first nodes, in contact throughout."""
        here, state = self.placement, self.state
        change = penetration * here.unit[:count] - here.profile[:count] - state.components[:count]
        bent = self._bent(penetration) * here.unit[:count]
        return self._step.advance(state.branches[:, :count], change, bent)

    def _bent(self, penetration: Any) -> Any:
        """Bend of the way to a penetration: of ``theta (theta - 1)`` over the share ``theta`` of the step."""
        return self._bend[0] * (penetration - self.state.penetration) + self._bend[1]

    def _changing(self, s: float) -> tuple[int, int]:
        """Range of the nodes that are not in contact, or free, throughout the step."""
        low, high = min(self.state.edge, s), max(self.state.edge, s)
        return math.floor(low) + 1, min(math.floor(high) + 2, len(self.placement.unit))

    def _passages(self, s: float) -> Callable[[Array, bool], NodePassage]:
        """The nodes in motion at the end of the step with the edge at ``s``, for one or more penetrations
        there; with energies if they are asked for."""
        here, state = self.placement, self.state
        low, high = self._changing(s)
        nodes, index = slice(low, high), np.arange(low, high)
        share, begun = (np.minimum(np.maximum(at + 1.0 - index, 0.0), 1.0) for at in (s, state.edge))
        profiles = here.profile_within(nodes, np.where(share > 0.0, share, begun))
        shallower = np.where(begun > 0.0, profiles - here.profile_within(nodes, begun), 0.0)
        released = self._released_in_part(low, profiles)
        opens, at = False, np.zeros(0)
        if not self.at_once:
            path = self._path(s)
            opens, at = path.opens, path.passed(self.geometry.ends[low : high + 1])
        partly, before = math.floor(state.edge) + 1 - low, state.edge - math.floor(state.edge)
        strips = state.strips if 0 <= partly < high - low and state.edge > NO_CONTACT else None

        def passed(penetrations: Array, accounts: bool) -> NodePassage:
            several, count = len(penetrations), high - low

            def each(values: Array) -> Array:
                return np.concatenate([values] * several, axis=-1) if several > 1 else values

            unit, profile = each(here.unit[nodes]), each(profiles)
            change = np.repeat(penetrations - state.penetration, count)
            bent = np.repeat(self._bent(penetrations), count)
            start = each(state.components[nodes]), each(state.branches[:, nodes])
            passage = NodePassage(
                self.solid, *start, state.held, accounts, each(shallower), strips=strips, ways=several
            )

            def imposed(theta: Array) -> Array:
                return (state.penetration + theta * (change + (theta - 1.0) * bent)) * unit - profile

            if self.at_once:
                begun, reached = imposed(np.zeros(1)), imposed(np.ones(1))
                passage.at_once(self.dt, each(share), begun, reached, each(self._free[nodes]), released)
            elif opens:
                passage.release(self.dt, share[0], each(at[1:]), each(at[:-1]), imposed, partly, before)
            else:
                passage.cover(self.dt, each(share), each(at[:-1]), each(at[1:]), imposed, before)
            return passage

        return passed

    def _path(self, s: float) -> EdgePolynomial:
        """Path of the edge over the step."""
        state = self.state
        return EdgePolynomial.through(state.radius, self.geometry.radius(s), self.dt, state.before)

    def _moments(self, s: float) -> Callable[[Array], Array]:
        """Shares of the step at which the edge, on its way to ``s``, is at radii."""
        return np.ones_like if self.at_once else self._path(s).passed

    def _released_in_part(self, low: int, profiles: Array) -> PartlyReleased | None:
        """The node in contact in part at the begin, if it is one of those from ``low`` on."""
        node, state = self._partly, self.state
        if node is None or node >= low + len(profiles):
            return None
        contact = state.penetration * self.placement.unit[node] - profiles[node - low]
        return PartlyReleased(node - low, float(state.edge - math.floor(state.edge)), float(contact))

    def accepted(self, s: float) -> ComponentState:
        """The state at the end of the step."""
        here, penetration = self.placement, self.penetration(s)
        low, high = self._changing(s)
        passage = self._passages(s)(np.array([penetration]), True)
        held = penetration * here.unit[:low] - here.profile[:low]
        within = self._in_contact(low, penetration)
        v = np.concatenate([held, passage.v, self._free[high:]])
        b = np.hstack([within, passage.b, self._free_branches[:, high:]])
        state, lost = self.state, 0.0
        if not self.at_once:
            lost += self.solid.loss(state.components[:low], state.branches[:, :low], self.dt, held).sum()
            bent, change = self._bent(penetration) * here.unit[:low], held - state.components[:low]
            lost += self.solid.modulus.bent_loss(self.dt, state.branches[:, :low], change, bent).sum()
            lost += self.solid.stored(state.components[high:], state.branches[:, high:]).sum()
            lost -= self.solid.stored(v[high:], b[:, high:]).sum()
        unresolved = self.solid.remaining(state.unresolved, self.dt)
        uneven = self.solid.remaining_in_contact(state.uneven, self.dt)
        relaxed = float(np.sum(state.unresolved - unresolved) + np.sum(state.uneven - uneven))
        edge = state.radius, self.geometry.radius(s)
        borders, of_borders, passed = state.borders.after(self.solid, self.dt, edge, self._moments(s))
        if passage.beyond is not None and edge[0] != edge[1]:
            known = borders.with_border(state.radius, passage.beyond)
            borders = known.most_energetic(self.solid)
            of_borders += known.stored(self.solid) - borders.stored(self.solid)
        return ComponentState(
            place=self.placement.place,
            components=v,
            branches=b,
            held=passage.held[:, 0],
            strips=self._strips(s, passage.held[:, 0], b),
            left=self._left(s, b),
            at_edge=self._at_edge(s),
            penetration=penetration,
            radius=edge[1],
            edge=s,
            before=state.rows_and_this(self.dt) if 0.0 < self.dt < math.inf else (),
            sunk=(self.dt, penetration - state.penetration) if 0.0 < self.dt < math.inf else None,
            dissipated=state.dissipated + passage.dissipated + float(lost) + relaxed + of_borders,
            opening=state.opening + passage.opening + passed,
            updates=state.updates + 1,
            unresolved=unresolved,
            uneven=uneven,
            borders=borders,
            record=self._recorded(s, b),
        )

    def _strips(self, s: float, held: Array, b: Array) -> NodeStrips | None:
        """Strips of the node in contact in part at the end of the step; their mean is that of the node."""
        state, solid, node = self.state, self.solid, math.floor(s) + 1
        share, before = s - math.floor(s), state.edge - math.floor(state.edge)
        if s <= NO_CONTACT or not self._gain.size:
            return None
        if state.strips is None or math.floor(s) != math.floor(state.edge):
            free = (b[:, node] - share * held) / (1.0 - share)
            return NodeStrips.two(share, held, free, False)
        inner, outer = min(share, before), max(share, before)
        unit, profile = self.placement.unit[node], self.placement.profile[node]
        start, end = (depth * unit - profile for depth in (state.penetration, self.penetration(s)))
        contact, stays = state.strips.within(0.0, inner)
        stays = solid.linear(np.full(len(contact), start), stays, self.dt, np.full(len(contact), end))
        free, goes_on = state.strips.within(outer, 1.0)
        goes_on = self._recovered(goes_on)
        whole = (
            held * share - stays @ contact if share > before else b[:, node] - held * share - goes_on @ free
        )
        changed = outer - inner
        between = (whole / changed)[:, None] if changed > 0.0 else np.zeros((len(b), 0))
        shares = np.concatenate([contact, [changed] if changed > 0.0 else [], free])
        turned = state.strips.turned or state.turns(self.geometry.radius(s))
        return NodeStrips(shares, np.hstack([stays, between, goes_on]), turned).few()

    @cached_property
    def _left_free(self) -> dict[int, NodeStrips]:
        """Strips of the nodes that the edge has left, after the step without force."""
        left = self.state.left.items()
        return {node: replace(strips, b=self._recovered(strips.b)) for node, strips in left}

    def _recovered(self, b: Array) -> Array:
        """Branch variables of what has been without force since before the step, at its end."""
        return self._freed(-b.sum(axis=0) / self.solid.modulus.relaxed, b)[1]

    def _left(self, s: float, b: Array) -> dict[int, NodeStrips]:
        """Strips of the nodes in which the edge turned and has left, as far out as the closure looks."""
        node, strips, last = self._partly, self.state.strips, math.floor(s) + 1
        if self.geometry.shift is None or s <= NO_CONTACT or not self._gain.size:
            return {}
        reach = np.searchsorted(self.geometry.effective, self.geometry.radius(s) + self.zone(s))
        left = {at: strips for at, strips in self._left_free.items() if last < at <= reach}
        if node is None or strips is None or node <= last or math.isinf(self.dt):
            return left
        if not (strips.turned or self.state.turns(self.geometry.radius(s))):
            return left
        return left | {node: self._left_behind(node, strips, s, b[:, node])}

    def _left_behind(self, node: int, strips: NodeStrips, s: float, mean: Array) -> NodeStrips:
        """Strips of a node that was in contact in part, and that the edge leaves on its way to ``s``.

        Those in contact are released as the edge passes their middle; their mean is that of the node.
        """
        state, solid, ends = self.state, self.solid, self.geometry.effective
        before = state.edge - math.floor(state.edge)
        (contact, held), (free, recovered) = strips.within(0.0, before), strips.within(before, 1.0)
        recovered = self._recovered(recovered)
        if not contact.size:
            return NodeStrips(free, recovered)
        middles = np.cumsum(contact) - 0.5 * contact
        share = self._moments(s)(ends[node - 1] + middles * (ends[node] - ends[node - 1]))
        change = self.penetration(s) - state.penetration
        way = change + (share - 1.0) * self._bent(state.penetration + change)
        ways = state.penetration, state.penetration + share * way
        unit, profile = self.placement.unit[node], self.placement.profile[node]
        start, end = (np.broadcast_to(depth * unit - profile, share.shape) for depth in ways)
        held = solid.linear(start, held, share * self.dt, end)
        held = solid.linear(end, held, 0.0, solid.relieved(end, held, 0.0))
        held = solid.recovered(held, (1.0 - share) * self.dt)[1]
        missing = mean - held @ contact - recovered @ free
        held = held + (missing / contact.sum())[:, None]
        return NodeStrips(np.concatenate([contact, free]), np.hstack([held, recovered]))

    def _recorded(self, s: float, b: Array) -> SurfaceRecord | None:
        """The surface at the end of the step, from the mesh where that is fine; none of a mesh that stays."""
        here, state = self.placement, self.state
        if here.stays:
            return None
        nodes = SurfaceRecord(here.positions, b / here.unit, here.profile / here.unit, math.floor(s) + 1)
        if state.record is None or s <= NO_CONTACT:
            return nodes
        edge = here.site(s)
        sited = edge / self.geometry.radius(s)
        moments = self._moments(s)
        begin, end = state.penetration, self.penetration(s)
        way = begin, end - begin, self._bent(end)
        passed = state.record.after(self.solid, self.dt, way, edge, lambda x: moments(x / sited), nodes)
        return passed.renewed(nodes, slice(int(here.lowest), self.geometry.last + 1))

    def closure(self, s: float) -> float:
        """Closure integral, an energy per area (see ``closure``); minus infinity under pressure.

        Of a node across the end of the zone it sees the radii within.
        """
        self.evaluations += 1
        here, shift = self.placement, self.geometry.shift
        assert shift is not None, "no closure without adhesion"
        if self.geometry.stress is not None:
            shift = ZoneShift(here.radii, self.zone(s))
        m = math.floor(s)
        top = m + 1
        first, end = shift.nodes(m, top)
        y = self._bearing(s, first)
        # the node in full contact next to the edge tells tension from pressure
        if y[m - first] > 0.0:
            return -np.inf
        v, seen = self._components(s, end), shift.seen(s)
        node = math.floor(seen) + 1
        across = self._left_free.get(node)
        if across is not None:
            v[node] = -across.mean(0.0, seen - (node - 1)).sum() / self.solid.modulus.relaxed
        gap = here.displacement_of(v, top, end) + (here.height[top:end] - self.penetration(s))
        lower, upper = here.closure_scale[m : m + 2]
        work = float(shift.closure(first, here.forces(y, first), gap))
        return work / float(lower + (s - m) * (upper - lower))

    def pressed_in(self, s: float, inside: bool = False) -> float:
        """Depth by which the indenter presses beyond the surface at the edge: zero without adhesion.

        Beyond the edge where the step begins it is that beyond the free surface, within it what the pressure
        there would be relieved by. Both are ``D - p(a) + rho(a)``, with the depth ``p`` at which elastic
        contact ends there, and ``rho`` what the past leaves, linear in ``p`` between components.
        """
        self.evaluations += 1
        places, left = self._left_inside if inside else self._left_outside
        depth, penetration = self.placement.depth(self.geometry.radius(s)), self.penetration(s)
        bent = self._bends / self.modulus * self._bent(penetration) if inside else 0.0
        return penetration - depth + bent + float(np.interp(depth, places, left))

    @cached_property
    def _edge_before(self) -> tuple[Array, Array]:
        """``v`` (1,) and ``b`` (branches, 1) of a component at the edge where the step begins, over ``e``."""
        state, here = self.state, self.placement
        if state.edge > NO_CONTACT:
            return np.array([state.penetration - here.depth(state.radius)]), state.at_edge[:, None]
        return state.components[:1] / here.unit[0], state.branches[:, :1] / here.unit[0]

    @cached_property
    def _left_inside(self) -> tuple[Array, Array]:
        """Depths of components within the edge, and of that edge, and what the past leaves."""
        v, b = self._edge_before
        count = math.floor(self.state.edge) + 1
        depths = np.append(self.placement.depths[:count], self.placement.depth(self.state.radius))
        memory = self._memory[:count] / self.placement.unit[:count]
        return depths, np.append(memory, self._step.memory(b, v)) / self.modulus

    @cached_property
    def _left_outside(self) -> tuple[Array, Array]:
        """The same beyond it, where the surface is free; the node in contact in part is neither."""
        first = math.floor(self.state.edge) + 2
        depths = np.append(self.placement.depth(self.state.radius), self.placement.depths[first:])
        return depths, -np.append(self._edge_freed[0], self._free[first:] / self.placement.unit[first:])

    @cached_property
    def _edge_freed(self) -> tuple[Array, Array]:
        """The component at the edge where the step begins, released there, and free until the end."""
        v, b = self._edge_before
        released = self.solid.relieved(v, b, 0.0)
        return self._freed(released, self.solid.linear(v, b, 0.0, released))

    def _freed(self, v: Array, b: Array) -> tuple[Array, Array]:
        """Components after the step without force."""
        if not self.at_once:
            return self.solid.recovered(b, self.dt)
        free = self.solid.relieved(v, b, self.dt)
        return free, self.solid.linear(v, b, self.dt, free)

    def _at_edge(self, s: float) -> Array:
        """Branch variables of a component at the edge at the end of the step, over ``e``: (branches,)."""
        if self.geometry.zone is not None or s <= NO_CONTACT:
            return np.zeros(len(self._gain))
        here, count, radius = self.placement, math.floor(self.state.edge) + 1, self.geometry.radius(s)
        depth = here.depth(radius)
        if radius <= self.state.radius:
            held_at = np.array([self.penetration(s) - here.depth(self.state.radius)])
            v, b = self._edge_before
            there = self._step.advance(b, held_at - v, self._bent(self.penetration(s)))
            within = self._in_contact(count, self.penetration(s)) / here.unit[:count]
            places, held = self._left_inside[0], np.hstack([within, there])
            return np.array([np.interp(depth, places, branch) for branch in held])
        first = count + 1
        there = self._edge_freed[1]
        places, free = (
            self._left_outside[0],
            np.hstack([there, self._free_branches[:, first:] / here.unit[first:]]),
        )
        touched = np.array([np.interp(depth, places, branch) for branch in free])[:, None]
        v = -touched.sum(axis=0) / self.solid.modulus.relaxed
        touching = self.dt if self.at_once else 0.0  # within a step the edge arrives at its end
        return self.solid.linear(v, touched, touching, np.array([self.penetration(s) - depth]))[:, 0]

    def zone(self, s: float) -> float:
        """Length of the process zone; at fixed stress that over which the tension has its mean, at most the
        contact radius."""
        geometry, here, end = self.geometry, self.placement, math.floor(s) + 2
        if geometry.stress is None or geometry.shortest is None or s < 0.0:
            return geometry.zone or 0.0

        def forces(first: int) -> Array:
            return here.forces(self._bearing(s, first), first)

        edge = geometry.radius(s) / here.stretch  # as the nodes measure it
        length = zone_of_stress(geometry.radii[:end], forces, edge, geometry.stress, geometry.shortest)
        return length if length < edge else geometry.radius(s)


@dataclass(frozen=True)
class ContactCandidate:
    """Contact state at the end of a trial step: all states that are possible then, and the edge of one."""

    problem: ContactProblem
    edge: EdgePosition

    @property
    def in_equilibrium(self) -> bool:
        """Whether the edge rests."""
        return self.edge.motion is EdgeMotion.RESTING

    @property
    def radius(self) -> float:
        """Contact radius."""
        return self.problem.geometry.radius(self.edge.s)

    @property
    def penetration(self) -> float:
        """Penetration."""
        return self.problem.penetration(self.edge.s)

    @property
    def force(self) -> float:
        """Total force."""
        return self.problem.force(self.edge.s)

    @property
    def response(self) -> float:
        """Penetration where the force is prescribed, otherwise the force."""
        return self.penetration if self.problem.control == "force" else self.force
