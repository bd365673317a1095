"""The committed state of a run: where it starts, and what an accepted trial makes of it.

Nodes of the history are laid where the edge goes, and taken out again where their neighbours say the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.control import StepStart
from bem_solver.equilibrium import elastic_problem, equilibrium, untouched_state
from bem_solver.history import (
    NODES_APART,
    NodalVariables,
    SurfaceHistory,
    distinct,
    graded_nodes,
    midpoints_of_wide_intervals,
    nodes_beyond,
    updated_kinks,
)
from bem_solver.motion import Motion
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import HalfSpaceState, advanced, points_at, split_at_edge
from bem_solver.trial import EDGE_ACCURACY, TrialContact, surface_pressed
from contact_scene.scene import zone_too_long

Array = NDArray[np.float64]

_FACING = 64
"""Nodes outside the edge that the closure looks at, even in the root of the distance: their cubics hold the
first residual, by which an edge at rest would creep, to a part of the accuracy of the closure."""


def start_state(problem: Problem) -> HalfSpaceState | None:
    """The start state of the scene, or ``None`` without equilibrium."""
    scene = problem.scene
    relaxed = scene.loading.start == "relaxed"
    material = scene.material
    penetration = scene.loading.penetration
    if problem.work == 0.0 and penetration <= 0.0:
        return untouched_state(problem, penetration)
    elastic = elastic_problem(problem, material.modulus if relaxed else material.glassy_modulus)
    untouched = untouched_state(elastic, penetration)
    trial = equilibrium(elastic, untouched, scene.loading.start_control, penetration, problem.scale)
    if trial is None:
        return None
    surface, penetration = trial.surface, trial.motion.new_penetration
    if scene.body is not None and surface.edge >= problem.body.largest:
        raise scene.body.outgrown
    if trial.zone >= surface.edge > 0.0:
        raise zone_too_long(trial.zone, surface.edge)
    history = _start_history(problem, surface, penetration, relaxed)
    work = problem.chain.compliances * surface.load_work if relaxed else 0.0
    return HalfSpaceState(0.0, penetration, surface, history, trial.closure, branch_work=work)


def _start_history(
    problem: Problem, surface: ContactSurface, penetration: float, relaxed: bool
) -> SurfaceHistory:
    """Nodes over the contact and far beyond; relaxed means no stress in any branch."""
    chain = problem.chain
    if not problem.viscoelastic:
        return SurfaceHistory.blank(0)
    edge, radii = surface.edge, problem.annuli.radii
    near = edge * radii
    mirrored = 2.0 * edge - near[near > edge - problem.length]
    facing = edge + problem.length * (np.arange(1.0, _FACING + 1.0) / _FACING) ** 2
    far = nodes_beyond(edge, problem.length)
    smallest = 0.5 * edge * problem.annuli.outermost
    radius = distinct(np.concatenate(([0.0], near, [edge], mirrored, facing, far)), (edge,), smallest)
    load = surface.outside(np.maximum(radius, edge))
    if relaxed:
        variables = np.zeros((len(radius), len(chain)))
    else:
        motion = Motion(0.0, 0.0, edge, penetration, penetration)
        points = points_at(problem, untouched_state(problem, penetration), radius)
        variables = advanced(chain, points, motion, load)
    at_edge = penetration - float(problem.scene.indenter.height(edge))
    inner, outer = split_at_edge(chain, radius, variables, load, edge, at_edge)
    return SurfaceHistory(inner, outer, 0, edge)


_COARSENING = 0.002
"""Change of an internal variable that a removed node may cause, in step tolerances of the largest one."""


def spacing(radius: Array, edge: float, length: float, divisions: int) -> Array:
    """Largest distance between nodes, shape (n,): fine within two lengths of the edge, then growing."""
    beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
    return length / divisions + NODES_APART * beyond


def updated_state(start: StepStart, trial: TrialContact, parameter: float) -> HalfSpaceState:
    """The state after an accepted trial."""
    problem, motion, surface, chain = start.problem, trial.motion, trial.surface, start.problem.chain
    time, history = start.interval.time(parameter), start.state.contact.history
    contact = HalfSpaceState(time, motion.new_penetration, surface, history, trial.closure)
    if problem.viscoelastic:
        problem.counters.history_updates += 1
        history = _new_history(start, trial)
        lags = advanced(chain, trial.points, motion, None) @ chain.rotation.T * chain.lag_scale
        work = chain.compliances * surface.load_work - surface.work_on(lags)
        release = _tip_release(problem, trial)
        contact = replace(contact, history=history, branch_work=work, tip_release=release)
    if problem.irreversible is not None:
        contact = replace(contact, last_step=(motion.duration, motion.edge))
    return contact


def _tip_release(problem: Problem, trial: TrialContact) -> float:
    """Glassy energy release rate of the tip, ``K^2/(2 Einf*)``, the way it has gone.

    An opening tip has it from the pressure; a closing one, behind which the stress relaxes within a layer
    that may be thinner than an annulus, from the pressure that free creep misses.
    """
    glassy, surface, motion = problem.chain.glassy, trial.surface, trial.motion
    if motion.new_edge <= motion.edge or problem.work == 0.0:
        return 0.5 * surface.stress_intensity**2 / glassy
    if trial.creep is not None:
        return 0.5 * trial.creep.pressed.stress_intensity**2 * glassy
    pressed = surface_pressed(problem, motion, trial.points, surface.kinks)
    return 0.5 * pressed.stress_intensity**2 * glassy


def _new_history(start: StepStart, trial: TrialContact) -> SurfaceHistory:
    """The history after an accepted trial."""
    problem, state, motion, surface = start.problem, start.state.contact, trial.motion, trial.surface
    divisions, tolerance = start.problem.divisions, start.problem.tolerance
    chain, edge, radii = problem.chain, motion.new_edge, problem.annuli.radii
    length = problem.length_at(edge)
    reach = max(abs(edge - motion.edge), 0.25 * length)
    smallest = 0.5 * edge * problem.annuli.outermost
    last = float(state.history.radius.max(initial=0.0))
    wanted = np.concatenate(([0.0], graded_nodes(radii, edge, reach), nodes_beyond(edge, length, last)))
    kinks, direction, turning, farthest = updated_kinks(
        state.history, motion.edge, edge, 8.0 * smallest, EDGE_ACCURACY * tolerance * length
    )
    if problem.irreversible is not None and motion.duration > 0.0 and edge == motion.edge:
        direction, farthest = 0, edge  # it rests, and may go on from here the way it came
    fixed = (edge, *kinks) if turning is None or turning == edge else (edge, turning, *kinks)
    radius = distinct(np.concatenate((state.history.radius, wanted)), fixed, smallest)
    allowed = spacing(radius, edge, length, divisions)
    halves = midpoints_of_wide_intervals(radius, 0.5 * (allowed[1:] + allowed[:-1]))
    radius = np.sort(np.concatenate((radius, halves)))
    load = surface.outside(np.maximum(radius, edge))
    points = points_at(problem, state, radius)
    variables = advanced(chain, points, motion, load)
    if trial.creep is not None:
        outside = radius > edge
        variables[outside] = trial.creep.settled(points[outside], variables[outside], load[outside])
    at_edge = motion.new_penetration - float(problem.scene.indenter.height(edge))
    inner, outer = split_at_edge(chain, radius, variables, load, edge, at_edge, kinks)
    unit = tolerance * float(np.abs(variables).max(initial=0.0))
    parity = problem.counters.steps % 2

    def coarsen(side: NodalVariables) -> NodalVariables:
        widest = spacing(side.radius, edge, length, divisions)
        return side.coarsened(_COARSENING * unit, widest, parity)

    return SurfaceHistory(coarsen(inner), coarsen(outer), direction, turning, farthest)
