"""The next committed state from an accepted trial: surface, history, energies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.edge_energy import EdgeStep, energy_spent
from bem_solver.energy import Energies, updated_energies
from bem_solver.half_space_state import HalfSpaceState, points_at
from bem_solver.history import (
    NODES_APART,
    SurfaceHistory,
    distinct,
    graded_nodes,
    midpoints_of_wide_intervals,
    nodes_beyond,
    updated_kinks,
)
from bem_solver.nodal_variables import NodalVariables
from bem_solver.points_by_passage import advanced
from bem_solver.run_state import StepStart
from bem_solver.surface_points import load_inside
from bem_solver.tip_release import energy_of_tip, reached_jumps, release_jumps, tip_release
from bem_solver.trial import EDGE_ACCURACY, TrialContact
from bem_solver.work_increment import work_increment

Array = NDArray[np.float64]

_COARSENING = 0.002
"""Change of an internal variable that a removed node may cause, in step tolerances of the largest one."""
_FADED = 0.01 * _COARSENING
"""The same of a root that no longer counts: the edge that left it has hardly set out when it is as weak as a
removed node."""


def split_at_edge(
    chain: Chain,
    radius: Array,
    variables: Array,
    load: Array,
    edge: float,
    displacement: float,
    kinks: tuple[float, ...] = (),
    rest: float | None = None,
) -> tuple[NodalVariables, NodalVariables]:
    """Nodal variables inside and outside the edge.

    Parameters
    ----------
    chain : Chain
    radius : ndarray (n,)
        Nodes, among them the edge and the kinks.
    variables : ndarray (n, K)
        Internal variables there.
    load : ndarray (n,)
        ``v``, used beyond the edge only; at the edge it follows from ``displacement``, so that both sides
        hold the same state.
    edge, displacement : float
        Contact radius, and surface displacement there.
    kinks : tuple of float
    rest : float, optional
        Radius inside the edge at which it has rested until just now.

    Returns
    -------
    inner, outer : NodalVariables
    """
    inside, outside = radius <= edge, radius >= edge
    beyond = load[outside]
    beyond[0] = load_inside(chain, variables[outside][:1], np.array([displacement]))[0]
    strains = chain.to_strains(variables[outside], beyond)
    inner = NodalVariables(radius[inside], variables[inside], tuple(k for k in kinks if k < edge))
    return inner, NodalVariables(radius[outside], strains, (edge, *(k for k in kinks if k > edge)), rest)


def spacing(radius: Array, edge: float, length: float, divisions: int) -> Array:
    """Largest distance between nodes, shape (n,): fine within two lengths of the edge, then growing.

    Parameters
    ----------
    radius : ndarray (n,)
    edge : float
    length : float
        On which the edge is resolved.
    divisions : int
        Nodes in it.

    Returns
    -------
    ndarray (n,)
    """
    beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
    return length / divisions + NODES_APART * beyond


def updated_state(
    start: StepStart, trial: TrialContact, parameter: float, coarseness: float
) -> tuple[HalfSpaceState, Energies]:
    """The state after an accepted trial.

    Parameters
    ----------
    start : StepStart
        With the state and energies before the step.
    trial : TrialContact
    parameter : float
        At the end of the step.
    coarseness : float
        Part of the usual coarsening of the history that is allowed.

    Returns
    -------
    state : HalfSpaceState
    energies : Energies
    """
    problem, state, energies = start.problem, start.state.contact, start.state.energies
    motion, surface = trial.motion, trial.surface
    points = trial.points
    if not problem.viscoelastic:
        variables, history = points.variables, state.history
    else:
        problem.counters.history_updates += 1
        history = _new_history(start, trial, coarseness)
        variables = advanced(problem.chain, points, motion, None)
    increment = work_increment(
        problem.chain,
        state.surface,
        surface,
        variables,
        points.load,
        points.variables,
    )
    after = updated_energies(problem.chain, energies, increment, motion.duration)
    if trial.tip_gap is not None and trial.tip_distance is not None and problem.viscoelastic:
        release = tip_release(problem.chain, surface, trial.tip_gap, trial.tip_distance, history)
        jumps = reached_jumps(release_jumps(state.history, motion), motion, history)
        tip = energy_of_tip(energies.release, release, motion, jumps)
        after = replace(after, release=release, tip=tip)
    contact = HalfSpaceState(start.interval.time(parameter), motion.new_penetration, surface, history)
    if problem.irreversible is not None:
        closures = (state.closure, trial.closure)
        spent = state.spent + energy_spent(problem.irreversible, motion.edge, motion.new_edge, closures)
        step = EdgeStep(motion.duration, motion.edge)
        contact = replace(contact, closure=trial.closure, spent=spent, last_step=step)
    return contact, after


def _new_history(start: StepStart, trial: TrialContact, coarseness: float) -> SurfaceHistory:
    """The history after an accepted trial, its coarsening as of :func:`updated_state`."""
    problem, state, motion, surface = start.problem, start.state.contact, trial.motion, trial.surface
    divisions, tolerance = start.settings.divisions, start.settings.tolerance
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
    rest = turning if turning is not None and turning < edge else None
    if rest is not None:
        kinks = tuple(sorted((*kinks, rest)))
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
    inner, outer = split_at_edge(chain, radius, variables, load, edge, at_edge, kinks, rest)
    unit = tolerance * float(np.abs(variables).max(initial=0.0))
    parity = problem.counters.steps % 2

    def coarsen(side: NodalVariables) -> NodalVariables:
        side = side.with_distinct_kinks(_FADED * unit, edge, tolerance)
        widest = spacing(side.radius, edge, length, divisions)
        return side.coarsened(coarseness * _COARSENING * unit, widest, parity)

    return SurfaceHistory(coarsen(inner), coarsen(outer), direction, turning, farthest)
