"""A trial: the surface for a given edge and step, and by how much it misses the closure.

Nothing here changes the committed state, only ``state_committer`` does. Penetration and surface
displacement positive downwards, force and pressure positive in compression; radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.bent_path import BentPath, EarlierRow
from bem_solver.between_annuli import LoadBetween
from bem_solver.cohesive_zone import zone_at
from bem_solver.edge_energy import end_velocity, energy_taken
from bem_solver.free_creep import FreeCreep
from bem_solver.half_space_state import HalfSpaceState, points_at
from bem_solver.kinks import EdgeKinks
from bem_solver.load_control import LoadControl
from bem_solver.motion import Motion, SurfacePoints
from bem_solver.outer_fall import OuterFall
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.tip_release import tip_distances
from bem_solver.trial_closure import closure_and_tip_gap

Array = NDArray[np.float64]

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
    the process zone, and ``tip_gap`` (2,) the gap outside the edge at ``tip_distance`` (2,), with adhesion.
    ``creep`` tells the surface outside an edge that has not receded in a step over zones.
    """

    motion: Motion
    surface: ContactSurface
    points: SurfacePoints
    residual: float
    closure: float
    zone: float = 0.0
    tip_gap: Array | None = None
    tip_distance: Array | None = None
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
        Row through which the paths of edge, load at the edge or ahead of it, and penetration are parabolas.
    within : (float, float), optional
        A time within the step and the penetration prescribed there, through which its path is a parabola
        instead (:meth:`~bem_solver.creep.Chain.share_to_meet`).

    Returns
    -------
    TrialContact
        Its residual is ``I - dgamma`` (Eq. closure), or its share of what the edge takes up in its direction,
        at its speed, times ``dgamma``; without adhesion the negative edge singularity.
    """
    kinks = _kinks_inside(problem, state, duration, edge)
    between = _load_between(problem, state, edge)
    readings = np.empty(0) if kinks is None else kinks.readings
    nodes = np.empty(0) if between is None else between.radius
    radii = edge * problem.annuli.radii
    points = points_at(problem, state, np.concatenate((radii, readings, nodes)))
    depth = value if control == "penetration" else state.penetration
    motion = _motion(problem, state, duration, edge, depth, earlier, within)
    loading = LoadControl(problem, state, points, kinks, control, value, earlier, between)
    motion, surface = loading.satisfied(motion)
    creep = loading.creep(motion)
    if creep is not None:
        motion = replace(motion, carried=creep.motion.carried)
    if len(nodes):
        points = points[: len(radii) + len(readings)]
    if problem.work == 0.0:
        return TrialContact(motion, surface, points, -surface.kappa, 0.0)
    return _adhesive_contact(problem, state, motion, surface, points, creep)


def _load_between(problem: Problem, state: HalfSpaceState, edge: float) -> LoadBetween | None:
    """Nodes of the history between the collocation radii, where zones are short against the contact."""
    if edge <= 0.0 or not problem.over_zones(state.edge):
        return None
    return LoadBetween.of(problem.annuli, edge, state.history.radius)


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
    if earlier is not None:
        row = row or (earlier.time, earlier.penetration)
    if earlier is not None and earlier.edge is not None and earlier.fall is not None:
        if edge != state.edge:
            rows = [(earlier.time, earlier.edge), *([earlier.further] if earlier.further else [])]
            path = BentPath.through(rows, state.edge, duration, edge, earlier.of_travel)
            fall = earlier.fall
    elif edge > state.edge > 0.0 and problem.over_zones(state.edge) and problem.relaxes_within(duration):
        path = BentPath.straight(state.edge, edge)
        fall = OuterFall.outside(state.surface, problem.nearest)
    if problem.viscoelastic and path is None:
        singular = state.surface.root_strength(abs(edge - state.edge))
        if problem.work == 0.0 and state.edge > 0.0:
            away = _DEPTH_OF_LOAD * max(edge - state.edge, 0.0)
            inside = max(min(edge, state.edge) - away, 0.5 * state.edge)
            innermost = points_at(problem, state, np.array([inside]))
    return Motion(duration, state.edge, edge, state.penetration, depth, singular, innermost, path, fall, row)


def _adhesive_contact(
    problem: Problem,
    state: HalfSpaceState,
    motion: Motion,
    surface: ContactSurface,
    points: SurfacePoints,
    creep: FreeCreep | None,
) -> TrialContact:
    """The contact after a motion, and by how much it misses the closure."""
    problem.counters.closure_evaluations += 1
    zone = _zone(problem, surface)
    distance = tip_distances(problem, state.history, motion, zone)
    closure, gap = closure_and_tip_gap(problem, state, motion, surface, zone, distance, creep)
    if (surface if creep is None else creep.pressed).kappa > 0.0:  # gap and tension have the wrong sign
        closure = -abs(closure)
    residual = closure - problem.work
    if problem.irreversible is None:
        return TrialContact(motion, surface, points, residual, closure, zone, gap, distance, creep)
    velocity = end_velocity(state.edge, motion.new_edge, motion.duration, state.last_step)
    excess = closure / energy_taken(problem.irreversible, velocity) - 1.0
    residual = excess * problem.work
    return TrialContact(motion, surface, points, residual, closure, zone, gap, distance, creep)


def _zone(problem: Problem, surface: ContactSurface) -> float:
    """Length of the process zone."""
    adhesion = problem.scene.adhesion
    if adhesion is None or adhesion.stress is None:
        return problem.zone
    return zone_at(surface, problem.rule, adhesion.stress, problem.zone)


def _kinks_inside(problem: Problem, state: HalfSpaceState, duration: float, edge: float) -> EdgeKinks | None:
    """Where an edge has rested, or turns in this step, inside the new edge.

    Older ones are read where the history holds them. Beyond an edge that turns now, or has just turned, what
    is covered first has relaxed for the whole step, as the root does; what is covered later has not, and is
    left out.
    """
    history = state.history
    if not problem.viscoelastic or edge <= 0.0:
        return None
    longest = 0.25 * problem.length_at(edge)
    rested = history.rested_at(state.edge)
    if rested is None or edge <= state.edge:
        return EdgeKinks.within(history.past_kinks, min(edge, state.edge), longest)
    still = 0.1 * float(problem.chain.relaxation[0])
    came = history.direction > 0 and rested == state.edge  # from further in: it has not rested there
    share = 1.0 if came else still / (still + duration)
    reach = max(state.edge - rested, min(longest, (edge - rested) * share))
    none = EdgeKinks(np.empty(0), np.empty(0))
    return (EdgeKinks.within(history.kinks, rested, longest) or none).and_at(rested, reach)
