"""A trial: the surface for a given edge and step, and by how much it misses the closure.

What the edge covers and leaves depends on the load at the edge, or just ahead of one that hardly moves, and
on how that falls outside it, during the step. Both are known at its start; at its end they are those of the
surface that is sought. Over zones, the surface outside an edge that has not receded follows from free creep
(``FreeCreep``) whatever way and time it took: what all strains would have become by themselves, ``sum e
exp(-y)``, misses ``w`` by the displacement of a pressure inside the edge alone. Nothing here changes the
committed state.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bem_solver.creep import Chain
from bem_solver.motion import (
    BentPath,
    CarriedDisplacement,
    EarlierRow,
    Motion,
    OuterFall,
    SurfacePoints,
    distances_outside,
    parabola_bend,
)
from bem_solver.problem import ClosureRule, Problem, end_velocity, energy_taken
from bem_solver.surface import NO_KINKS, NONE_BETWEEN, ContactSurface, EdgeKinks, LoadBetween
from bem_solver.surface_points import (
    HalfSpaceState,
    PointsByPassage,
    advanced,
    displacement_outside,
    load_inside,
    points_at,
)

Array = NDArray[np.float64]

_LEAST_ZONE = 1e-3
"""Shortest zone that is followed, in zones at rest: the edge pulls a thirtieth of what it would at rest."""


@dataclass(frozen=True)
class FreeCreep:
    """The end of a step whose edge has not receded: ``pressed``, the surface under what free creep misses."""

    chain: Chain
    motion: Motion
    pressed: ContactSurface

    @staticmethod
    def takes(problem: Problem, motion: Motion) -> bool:
        """Whether a step is one over process zones, that takes time, of an edge that has not receded."""
        over_zones = problem.over_zones(motion.edge)
        return over_zones and motion.duration > 0.0 and motion.new_edge >= motion.edge > 0.0

    def carrying(self, problem: Problem, state: HalfSpaceState) -> FreeCreep:
        """The same with the displacement that its edge, if it moves, carries along."""
        if self.motion.new_edge == self.motion.edge:
            return self
        motion, distance = self.motion, np.append(0.0, distances_outside(self.motion.edge, problem.nearest))
        before = points_at(problem, state, motion.edge + distance).displacement
        after = self.displacement(points_at(problem, state, motion.new_edge + distance))
        fall, new_fall = ((w[0] - w[1:]) / np.sqrt(distance[1:]) for w in (before, after))
        shares = np.array([0.0, 0.5, 1.0])
        start, middle, end = motion.penetration_at(shares) - problem.scene.indenter.height(
            motion.way.edge(1.0 - shares)
        )
        bend = 2.0 * (start + end) - 4.0 * middle
        carried = CarriedDisplacement(motion.way, OuterFall(distance[1:], fall, new_fall), float(bend))
        return replace(self, motion=replace(motion, carried=carried))

    def displacement(self, points: SurfacePoints) -> Array:
        """``w`` (m,) at the end of the step at points outside the edge."""
        return _crept(self.chain, points, self.motion) + self.pressed.outside(points.radius)

    def tension(self, distance: Array, otherwise: Array) -> Array:
        """Normal stress inside the edge: near it that of an inverse root that has come with it."""
        motion, carried = self.motion, self.motion.carried
        travel = motion.new_edge - motion.edge
        share = np.clip(2.0 * (travel - distance) / travel, 0.0, 1.0) if travel > 0.0 else 0.0 * distance
        if carried is None or not share.any():
            return otherwise
        _, left = motion.passing(motion.new_edge - distance)
        start, end = float(carried.fall.start[0]), float(carried.fall.end[0])
        growth = min(max(1.0 - start / end, -1.0), 1.0) if end != 0.0 else 0.0
        kept = 1.0 - carried.path.abscissa(left) * growth
        slowed = np.sqrt(carried.path.mean_since(left))
        gained = 1.0 - kept * slowed, 1.0 - kept / slowed
        of_inverse_root, of_root = self.chain.moduli_of_passage(left * motion.duration, gained)
        at_edge = np.full_like(self.pressed.density, self.pressed.kappa / np.pi)
        singular, whole = self.pressed.tension(distance, at_edge), self.pressed.tension(distance)
        passed = of_inverse_root * singular + of_root * (whole - singular)
        return otherwise + share * (passed - otherwise)

    def settled(self, points: SurfacePoints, variables: Array, load: Array) -> Array:
        """Variables of points outside at the end, their load bent so that they have their displacement."""
        chain = self.chain
        missed = self.displacement(points) - displacement_outside(chain, variables, load)
        lags = chain.lag_rate * chain.spread_bent(self.motion.duration / chain.retardation)
        return variables - (missed[:, None] * (lags / (lags @ chain.lag_scale))) @ chain.rotation


def surface_pressed(
    problem: Problem,
    motion: Motion,
    points: SurfacePoints,
    kinks: EdgeKinks,
    between: LoadBetween = NONE_BETWEEN,
) -> ContactSurface:
    """The surface under what free creep throughout a step misses of the displacement inside the edge."""
    missed = motion.new_penetration - points.height - _crept(problem.chain, points, motion)
    return ContactSurface.under(problem.annuli, motion.new_edge, missed, kinks, problem.body, between)


def _crept(chain: Chain, points: SurfacePoints, motion: Motion) -> Array:
    """``sum e`` (m,) after free creep throughout a step."""
    strains = chain.to_strains(points.variables, points.load)
    return chain.decay(motion.duration / chain.retardation) * strains @ chain.lag_scale


def closure_integral(
    problem: Problem,
    state: HalfSpaceState,
    motion: Motion,
    surface: ContactSurface,
    zone: float,
    creep: FreeCreep | None,
) -> float:
    """``I`` (Eq. closure); the zone is cut at the centre."""
    distance, force = forces_over(surface, problem.rule, min(zone, surface.edge), creep)
    gap = gap_outside(problem, state, motion, surface, surface.edge + zone - distance, creep)
    return float(force @ gap) / (2.0 * zone)


def forces_over(
    surface: ContactSurface, rule: ClosureRule, length: float, creep: FreeCreep | None = None
) -> tuple[Array, Array]:
    """Points of a quadrature over a length from the edge inwards: distances (m,), forces ``sigma ds`` (m,).

    The punches at kinks are integrated from their own edges on.
    """
    distances, forces = [length * rule.distance], [length * rule.weight]
    depth = surface.edge - surface.kinks.radius
    for index in np.flatnonzero(depth < length).tolist():
        own = length - depth[index]
        tension = surface.strengths[index] * surface.kinks.tension(index, own * rule.distance)
        distances.append(depth[index] + own * rule.distance)
        forces.append(own * rule.weight * tension)
    tension = surface.tension(distances[0])
    forces[0] *= tension if creep is None or len(forces) > 1 else creep.tension(distances[0], tension)
    return np.concatenate(distances), np.concatenate(forces)


def gap_outside(
    problem: Problem,
    state: HalfSpaceState,
    motion: Motion,
    surface: ContactSurface,
    radius: Array,
    creep: FreeCreep | None,
) -> Array:
    """Gap outside the new edge at the end of the step."""
    if creep is not None:
        points = points_at(problem, state, radius)
        return points.height - motion.new_penetration + creep.displacement(points)
    load = surface.outside(radius)
    if not problem.viscoelastic:
        height = problem.scene.indenter.height(radius)
        return height - motion.new_penetration + load / problem.chain.relaxed
    points = points_at(problem, state, radius)
    variables = advanced(problem.chain, points, motion, load)
    displacement = displacement_outside(problem.chain, variables, load)
    return points.height - motion.new_penetration + displacement


_PASSES = 2
"""Of an advancing edge, whose load at the end of the step is that of the surface sought."""


@dataclass(frozen=True)
class LoadControl:
    """``control`` has ``value`` at the end of the step.

    ``points`` are the collocation radii inside the new edge, and behind them the readings of ``kinks`` and
    the nodes ``between``; ``earlier`` is a row before the last, where the edge or its load has a curved path.
    """

    problem: Problem
    state: HalfSpaceState
    points: SurfacePoints
    kinks: EdgeKinks
    between: LoadBetween
    control: str
    value: float
    earlier: EarlierRow | None = None
    _creep: dict[float, FreeCreep] = field(default_factory=dict)
    _by_passage: dict[float, PointsByPassage] = field(default_factory=dict)

    def satisfied(self, motion: Motion) -> tuple[Motion, ContactSurface]:
        """Motion with the penetration and the end that belong to the control, and its surface."""
        motion, surface = self._controlled(motion)
        if FreeCreep.takes(self.problem, motion):
            return self._ending(motion, surface), surface
        if motion.fall is None and (self.earlier is None or self.earlier.edge is None):
            return motion, surface
        motion = self._ending(motion, surface)
        if motion.new_edge <= motion.edge:
            return motion, surface
        if motion.fall is None:
            return self._controlled(motion)
        for _ in range(_PASSES):
            motion, surface = self._controlled(motion)
            motion = self._ending(motion, surface)
        return motion, surface

    def creep(self, motion: Motion) -> FreeCreep | None:
        """What free creep tells of a motion; within a step their penetration alone differs."""
        problem, depth = self.problem, motion.new_penetration
        if not FreeCreep.takes(problem, motion):
            return None
        if depth not in self._creep:
            pressed = surface_pressed(problem, motion, self.points, self.kinks, self.between)
            self._creep[depth] = FreeCreep(problem.chain, motion, pressed).carrying(problem, self.state)
        return self._creep[depth]

    def _ending(self, motion: Motion, surface: ContactSurface) -> Motion:
        """The motion whose end is that of a surface."""
        fall = None if motion.fall is None else motion.fall.towards(surface)
        rise, bend = self._load_rise_and_bend(motion, surface)
        return replace(motion, fall=fall, load_rise=rise, load_bend=bend)

    def _load_rise_and_bend(self, motion: Motion, surface: ContactSurface) -> tuple[float, float]:
        """Rise and bend of the load through the earlier row: at the edge of its path, or ahead of others."""
        earlier, path = self.earlier, motion.path
        if earlier is None or earlier.load is None or (path is not None and earlier.fall is None):
            return 0.0, 0.0
        start, end = (of.load_ahead(earlier.ahead) for of in (self.state.surface, surface))
        before = (
            path.before if path is not None and motion.fall is not None else earlier.time / motion.duration
        )
        return end - start, parabola_bend((before, earlier.load), start, 1.0, end)

    def _controlled(self, motion: Motion) -> tuple[Motion, ContactSurface]:
        """Motion with the penetration, and surface, that the control asks for."""
        self.problem.counters.linear_solves += 1
        if self.control == "penetration":
            if motion.new_penetration != self.value:
                motion = replace(motion, new_penetration=self.value)
            return motion, self._surface(motion)
        # everything is affine in the new penetration
        start = self.state.penetration
        highest = float(self.points.height.max(initial=0.0))  # a shorter step would be lost in its force
        step = max(abs(start), 1e-3 * motion.new_edge, 1e-6 * highest)
        first = replace(motion, new_penetration=start)
        one, two = self._surface(first), self._surface(replace(first, new_penetration=start + step))
        lacking, gained = self.value - one.force, two.force - one.force
        if self.control == "stage":  # D + F/k
            compliance = self.problem.scene.loading.compliance
            lacking = self.value - (first.new_penetration + compliance * one.force)
            gained = step + compliance * gained
        share = lacking / gained
        return replace(first, new_penetration=start + share * step), one.towards(two, share)

    def _surface(self, motion: Motion) -> ContactSurface:
        """The surface after a motion whose penetration is known."""
        creep = self.creep(motion)
        load = self._required_load(motion if creep is None else creep.motion)
        annuli, body = self.problem.annuli, self.problem.body
        return ContactSurface.under(annuli, motion.new_edge, load, self.kinks, body, self.between)

    def _required_load(self, motion: Motion) -> Array:
        """``v`` at radii inside the new edge."""
        problem, wanted = self.problem, motion.new_penetration - self.points.height
        if not problem.viscoelastic:
            return problem.chain.relaxed * wanted
        problem.counters.history_updates += 1
        if motion.new_edge not in self._by_passage:
            self._by_passage[motion.new_edge] = PointsByPassage(problem.chain, self.points, motion)
        return load_inside(problem.chain, self._by_passage[motion.new_edge].inside(motion), wanted)


EDGE_ACCURACY = 1e-3
"""Accuracy of the edge, in step tolerances of the length it is resolved on: far below the step error."""

_DEPTH_OF_LOAD = 4.0
"""Distance of the point whose load stands for that of the contact inside an advancing edge without adhesion,
in travels of the step: a point nearer to it has been covered within the last few steps, and relaxes from that
by itself, while the load outside does not. From twice to eight times that travel all is alike."""


@dataclass(frozen=True)
class TrialContact:
    """Surface at the end of a trial step; ``residual`` > 0 where the edge recedes.

    ``points`` are the collocation radii inside its edge at the start of the step; ``zone`` is the length of
    the process zone, and ``creep`` tells the surface outside an edge that has not receded in a step over
    zones.
    """

    motion: Motion
    surface: ContactSurface
    points: SurfacePoints
    residual: float
    closure: float
    zone: float = 0.0
    creep: FreeCreep | None = None


def evaluate(
    problem: Problem,
    state: HalfSpaceState,
    duration: float,
    edge: float,
    control: str,
    value: float,
    earlier: EarlierRow | None = None,
    within: tuple[float, float] | None = None,
) -> TrialContact:
    """The surface with the edge at ``edge`` after ``duration``, and its residual."""
    kinks = _kinks_inside(problem, state, edge)
    between = NONE_BETWEEN
    if edge > 0.0 and problem.over_zones(state.edge):  # wide annuli against what the edge has left behind
        between = LoadBetween.of(problem.annuli, edge, state.history.radius)
    radii = np.concatenate((edge * problem.annuli.radii, kinks.readings))
    points = points_at(problem, state, np.concatenate((radii, between.radius)))
    depth = value if control == "penetration" else state.penetration
    motion = _motion(problem, state, duration, edge, depth, earlier, within)
    loading = LoadControl(problem, state, points, kinks, between, control, value, earlier)
    motion, surface = loading.satisfied(motion)
    creep = loading.creep(motion)
    if creep is not None:
        motion = replace(motion, carried=creep.motion.carried)
    points = points[: len(radii)]
    if problem.work == 0.0:
        return TrialContact(motion, surface, points, -surface.kappa, 0.0)
    problem.counters.closure_evaluations += 1
    zone = _zone(problem, surface)
    closure = closure_integral(problem, state, motion, surface, zone, creep)
    if (surface if creep is None else creep.pressed).kappa > 0.0:  # gap and tension have the wrong sign
        closure = -abs(closure)
    residual = closure - problem.work
    if problem.irreversible is not None:
        velocity = end_velocity(state.edge, motion.new_edge, motion.duration, state.last_step)
        residual = (closure / energy_taken(problem.irreversible, velocity) - 1.0) * problem.work
    return TrialContact(motion, surface, points, residual, closure, zone, creep)


def _motion(
    problem: Problem,
    state: HalfSpaceState,
    duration: float,
    edge: float,
    depth: float,
    earlier: EarlierRow | None,
    within: tuple[float, float] | None,
) -> Motion:
    """The step of the edge to a penetration ``depth``: its root and a point inside, or its path and fall."""
    singular, innermost = 0.0, None
    path = row = fall = None
    if within is not None:
        row = -within[0], within[1]
    elif earlier is not None:
        row = earlier.time, earlier.penetration
    if earlier is not None and earlier.edge is not None and earlier.fall is not None:
        if edge != state.edge:
            before = earlier.time, earlier.edge
            path = BentPath.through(before, state.edge, duration, edge, earlier.runs_away)
            fall = earlier.fall
    elif problem.over_zones(state.edge) and edge > state.edge and duration > problem.chain.retardation.min():
        # a step long against a branch: the points it covers feel the whole fall of the load
        path = BentPath.straight(state.edge, edge)
        fall = OuterFall.outside(state.surface, problem.nearest)
    if problem.viscoelastic and path is None:
        singular = state.surface.root_strength(abs(edge - state.edge))
        if problem.work == 0.0 and state.edge > 0.0:
            away = _DEPTH_OF_LOAD * max(edge - state.edge, 0.0)
            inside = max(min(edge, state.edge) - away, 0.5 * state.edge)
            innermost = points_at(problem, state, np.array([inside]))
    return Motion(duration, state.edge, edge, state.penetration, depth, singular, innermost, path, fall, row)


def _zone(problem: Problem, surface: ContactSurface) -> float:
    """Length of the process zone; at fixed stress s, over which the mean tension is ``(4/pi) s``.

    Of the singular part that mean falls as the root of the length, so that there is one such length, if the
    tension over the whole contact is not larger: else it is the contact radius.
    """
    adhesion, edge = problem.scene.adhesion, surface.edge
    if adhesion is None or adhesion.stress is None:
        return problem.zone
    mean = 4.0 / np.pi * adhesion.stress

    def excess(length: float) -> float:
        return float(forces_over(surface, problem.rule, length)[1].sum()) - mean * length

    least = min(_LEAST_ZONE * problem.zone, 0.5 * edge)
    if edge == 0.0 or surface.kappa >= 0.0 or excess(least) <= 0.0:
        return least
    if excess(edge) >= 0.0:
        return edge
    return float(brentq(excess, least, edge, xtol=1e-15 * edge, rtol=1e-12))


def _kinks_inside(problem: Problem, state: HalfSpaceState, edge: float) -> EdgeKinks:
    """Where an edge has rested, or turns in this step, inside the new edge."""
    history = state.history
    if not problem.viscoelastic or edge <= 0.0:
        return NO_KINKS
    longest = 0.25 * problem.length_at(edge)
    rested = history.rested_at(state.edge)
    if rested is None or edge <= state.edge:
        return EdgeKinks.within(history.past_kinks, min(edge, state.edge), longest)
    reach = max(state.edge - rested, min(longest, edge - rested))
    kinks = EdgeKinks.within(history.kinks, rested, longest)
    return EdgeKinks(np.append(kinks.radius, rested), np.append(kinks.reach, reach))
