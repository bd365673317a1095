"""A trial: the surface for a given edge and step, and by how much it misses the closure.

Nothing here changes the committed state, only the loop in ``stepping`` does. Penetration and surface
displacement positive downwards, force and pressure positive in compression; radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.bent_path import BentPath, EarlierRow
from bem_solver.closure import ClosureRule
from bem_solver.cohesive_zone import zone_at
from bem_solver.creep import Chain
from bem_solver.edge_energy import EdgeStep, end_velocity, energy_taken
from bem_solver.history import SurfaceHistory
from bem_solver.kinks import EdgeKinks
from bem_solver.outer_fall import OuterFall
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import Motion, SurfacePoints, advanced, displacement_outside, load_inside
from contact_scene import Adhesion, Counters, Scene

Array = NDArray[np.float64]

EDGE_ACCURACY = 4e-3
"""Accuracy of the edge, in step tolerances of the length it is resolved on: far below the step error."""
LONG_ZONE = 0.02
"""Process zone over contact radius from which on a step is a fraction of a zone and annuli have equal angles.
There are few of both then; with shorter zones steps pass over zones, and annuli are graded towards the
edge."""
_LONG_TRAVEL = 0.1
"""Part of the contact radius of which a step over zones takes the same fraction, at most: what acts at the
edge then changes little within it, and the loading mostly asks for shorter ones."""


@dataclass(frozen=True)
class Problem:
    """What stays the same over a run.

    ``zone`` (at fixed stress its length at rest) and ``work`` are zero without adhesion; ``length`` is the
    length on which the edge is resolved in the largest contact.
    """

    scene: Scene
    annuli: Annuli
    chain: Chain
    zone: float
    work: float
    length: float
    counters: Counters
    rule: ClosureRule

    @property
    def viscoelastic(self) -> bool:
        """Whether the material has branches, so that the surface has a history."""
        return len(self.chain) > 0

    @property
    def irreversible(self) -> Adhesion | None:
        """The adhesion, if what the edge takes up depends on its direction or speed."""
        adhesion = self.scene.adhesion
        return adhesion if self.work > 0.0 and adhesion is not None and not adhesion.reversible else None

    @property
    def rated(self) -> bool:
        """Whether what the edge takes up follows its speed: its radius is then an integral over time."""
        return self.irreversible is not None and self.irreversible.rate is not None

    def length_at(self, edge: float) -> float:
        """Length on which the motion of an edge at radius ``edge`` is resolved.

        The zone, over which the history sees the edge come and go; a quarter of the radius without adhesion,
        and in an elastic contact, whose states are equilibria by themselves.
        """
        return self.zone if self.work > 0.0 and self.viscoelastic else 0.25 * edge

    def longest_travel(self, edge: float) -> float:
        """Length of which the edge at radius ``edge`` may pass a fraction in one step."""
        return _LONG_TRAVEL * edge if self.over_zones(edge) else self.length_at(edge)

    def over_zones(self, edge: float) -> bool:
        """Whether a step may pass over process zones: of one length, of an edge with one work of adhesion."""
        adhesion = self.scene.adhesion
        plain = adhesion is not None and adhesion.reversible and adhesion.stress is None
        return plain and self.length_at(edge) < LONG_ZONE * edge


@dataclass(frozen=True)
class HalfSpaceState:
    """Committed state: the surface, its history, time and penetration.

    ``closure`` is the integral of the edge, ``spent`` what the interface has taken up, ``last_step`` the step
    of the edge that led here, ``None`` after a kink: known where adhesion is irreversible.
    """

    time: float
    penetration: float
    surface: ContactSurface
    history: SurfaceHistory
    closure: float = 0.0
    spent: float = 0.0
    last_step: EdgeStep | None = None

    @property
    def edge(self) -> float:
        """Contact radius."""
        return self.surface.edge


@dataclass(frozen=True)
class TrialContact:
    """Surface at the end of a trial step; ``residual`` > 0 where the edge recedes; length of its ``zone``."""

    motion: Motion
    surface: ContactSurface
    residual: float
    closure: float
    zone: float = 0.0


def points_at(problem: Problem, state: HalfSpaceState, radius: Array) -> SurfacePoints:
    """State of surface points at the start of a step."""
    chain, history = problem.chain, state.history
    height = problem.scene.indenter.height(radius)
    inside = (radius <= state.edge) & (state.edge > 0.0)
    displacement = state.penetration - height
    if inside.all():
        variables = history.inner.at(radius)
        return SurfacePoints(
            radius, height, variables, load_inside(chain, variables, displacement), displacement
        )
    load = np.empty(len(radius))
    variables = np.empty((len(radius), len(chain)))
    variables[inside] = history.inner.at(radius[inside])
    load[inside] = load_inside(chain, variables[inside], displacement[inside])
    outside = ~inside
    load[outside] = state.surface.outside(radius[outside])
    variables[outside] = chain.from_strains(history.outer.at(radius[outside]), load[outside])
    displacement[outside] = displacement_outside(chain, variables[outside], load[outside])
    return SurfacePoints(radius, height, variables, load, displacement)


def _required_load(problem: Problem, points: SurfacePoints, motion: Motion) -> Array:
    """``v`` at radii inside the new edge."""
    wanted = motion.new_penetration - points.height
    if not problem.viscoelastic:
        return problem.chain.relaxed * wanted
    problem.counters.history_updates += 1
    return load_inside(problem.chain, advanced(problem.chain, points, motion, None), wanted)


def evaluate(
    problem: Problem,
    state: HalfSpaceState,
    duration: float,
    edge: float,
    control: str,
    value: float,
    earlier: EarlierRow | None = None,
) -> TrialContact:
    """The surface with the edge at ``edge`` after ``duration``, and its residual.

    Parameters
    ----------
    problem : Problem
    state : HalfSpaceState
        Committed state at the start of the step.
    duration : float
    edge : float
        Contact radius at the end.
    control : "penetration", "force" or "stage"
        Which of them has ``value`` at the end of the step.
    value : float
    earlier : EarlierRow, optional
        Row through which the paths of edge and penetration are then parabolas.

    Returns
    -------
    TrialContact
        Its residual is ``I - dgamma`` (Eq. closure), or its share of what the edge takes up in its direction,
        at its speed, times ``dgamma``; without adhesion the negative edge singularity.
    """
    annuli, counters = problem.annuli, problem.counters
    kinks = _kinks_inside(problem, state, duration, edge)
    radii = edge * annuli.radii
    points = points_at(problem, state, radii if kinks is None else np.append(radii, kinks.readings))
    singular, innermost = 0.0, None
    if problem.viscoelastic:
        singular = state.surface.root_strength(abs(edge - state.edge))
        if problem.work == 0.0 and state.edge > 0.0:
            innermost = points_at(problem, state, np.array([min(edge, state.edge)]))
    path = row = fall = None
    if earlier is not None and duration > 0.0:
        row = earlier.time, earlier.penetration
        if edge != state.edge:
            path = BentPath.through((earlier.time, earlier.edge), state.edge, duration, edge)
            fall = OuterFall.outside(state.surface, problem.zone)
    elif duration > 0.0 and edge > state.edge > 0.0 and problem.over_zones(state.edge):
        path = BentPath.straight(state.edge, edge)
        fall = OuterFall.outside(state.surface, problem.zone)

    def under(motion: Motion) -> ContactSurface:
        return ContactSurface.under(annuli, edge, _required_load(problem, points, motion), kinks)

    def controlled(motion: Motion) -> tuple[Motion, ContactSurface]:
        """Motion with the penetration, and surface, that the control asks for."""
        if control == "penetration":
            return motion, under(motion)
        # everything is affine in the new penetration
        step = max(abs(state.penetration), 1e-3 * edge)
        first = replace(motion, new_penetration=state.penetration)
        one, two = under(first), under(replace(first, new_penetration=state.penetration + step))
        lacking, gained = value - one.force, two.force - one.force
        if control == "stage":  # D + F/k
            compliance = problem.scene.loading.compliance
            lacking = value - (first.new_penetration + compliance * one.force)
            gained = step + compliance * gained
        share = lacking / gained
        return replace(first, new_penetration=state.penetration + share * step), one.towards(two, share)

    new_penetration = value if control == "penetration" else state.penetration
    motion, surface = controlled(
        Motion(
            duration,
            state.edge,
            edge,
            state.penetration,
            new_penetration,
            singular,
            innermost,
            path,
            fall,
            row,
        )
    )
    counters.linear_solves += 1
    if fall is not None:
        motion = replace(motion, fall=fall.towards(surface))
        if edge > state.edge:  # what has been covered depends on the fall at the end
            motion, surface = controlled(motion)
            counters.linear_solves += 1
    if problem.work == 0.0:
        return TrialContact(motion, surface, -surface.kappa, 0.0)
    counters.closure_evaluations += 1
    zone = _zone(problem, surface)
    value_of = _closure(problem, state, motion, surface, zone)
    if surface.kappa > 0.0:
        value_of = -abs(value_of)
    if problem.irreversible is None:
        return TrialContact(motion, surface, value_of - problem.work, value_of, zone)
    velocity = end_velocity(state.edge, edge, duration, state.last_step)
    excess = value_of / energy_taken(problem.irreversible, velocity) - 1.0
    return TrialContact(motion, surface, excess * problem.work, value_of, zone)


def _zone(problem: Problem, surface: ContactSurface) -> float:
    """Length of the process zone."""
    adhesion = problem.scene.adhesion
    if adhesion is None or adhesion.stress is None:
        return problem.zone
    return zone_at(surface, problem.rule, adhesion.stress, problem.zone)


def _kinks_inside(problem: Problem, state: HalfSpaceState, duration: float, edge: float) -> EdgeKinks | None:
    """Where an edge has rested, or turns in this step, inside the new edge.

    Older ones are read where the history holds them. Beyond an edge that turns now, what is covered first has
    relaxed for the whole step, as the root does; what is covered later has not, and is left out.
    """
    history = state.history
    if not problem.viscoelastic or edge <= 0.0:
        return None
    longest = 0.25 * problem.length_at(edge)
    radii = history.kinks if history.turning is None else (*history.kinks, history.turning)
    kinks = EdgeKinks.within(radii, min(edge, state.edge), longest)
    if not history.direction <= 0 < state.edge < edge:
        return kinks
    still = 0.1 * float(problem.chain.relaxation[0])
    turning = state.edge if history.farthest is None else min(history.farthest, state.edge)
    reach = min(longest, (edge - turning) * still / (still + duration))
    none = EdgeKinks(np.empty(0), np.empty(0))
    return (kinks or none).and_at(turning, reach)


def _closure(
    problem: Problem, state: HalfSpaceState, motion: Motion, surface: ContactSurface, zone: float
) -> float:
    """``I``, the punches at kinks integrated from their own edges on."""
    rule, edge, kinks = problem.rule, surface.edge, surface.kinks
    inner = rule.inside(zone, edge)
    if kinks is None or surface.strengths is None:
        gap = gap_outside(problem, state, motion, surface, edge + zone - inner)
        return rule.integral(surface.tension(inner), gap, zone, edge)
    depth = edge - kinks.radius
    near = np.flatnonzero(depth < min(zone, edge))
    own = (min(zone, edge) - depth[near, None]) * rule.distance  # distances inside each kink
    offsets = np.concatenate((inner, (depth[near, None] + own).ravel()))
    gap, *gaps = np.split(gap_outside(problem, state, motion, surface, edge + zone - offsets), 1 + len(near))
    value = rule.integral(surface.tension(inner), gap, zone, edge)
    for index, distance, facing in zip(near.tolist(), own, gaps, strict=True):
        tension = surface.strengths[index] * kinks.tension(index, distance)
        value += (min(zone, edge) - depth[index]) * (rule.weight @ (tension * facing)) / (2.0 * zone)
    return float(value)


def gap_outside(
    problem: Problem, state: HalfSpaceState, motion: Motion, surface: ContactSurface, radius: Array
) -> Array:
    """Gap outside the new edge at the end of the step.

    Parameters
    ----------
    problem : Problem
    state : HalfSpaceState
        Before the step.
    motion : Motion
    surface : ContactSurface
        After the step.
    radius : ndarray (m,)

    Returns
    -------
    ndarray (m,)
    """
    load = surface.outside(radius)
    points = points_at(problem, state, radius)
    if problem.viscoelastic:
        variables = advanced(problem.chain, points, motion, load)
        displacement = displacement_outside(problem.chain, variables, load)
    else:
        displacement = load / problem.chain.relaxed
    return points.height - motion.new_penetration + displacement
