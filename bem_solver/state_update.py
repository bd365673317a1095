"""From an accepted trial to the next committed state: history, energies, surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.energy import Energies, change, stepped
from bem_solver.history import (
    NodalVariables,
    SurfaceHistory,
    distinct,
    gaps_to_halve,
    graded_nodes,
    updated_kinks,
)
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import Motion, advanced, load_inside
from bem_solver.trial import ContactState, Problem, Trial, points_at

Array = NDArray[np.float64]

_COARSENING = 0.002
"""Change of an internal variable that a removed node may cause, in step tolerances of the largest one."""


def split_at_edge(
    chain: Chain,
    radius: Array,
    variables: Array,
    load: Array,
    edge: float,
    displacement: float,
    kinks: tuple[float, ...] = (),
) -> tuple[NodalVariables, NodalVariables]:
    """Nodal variables inside and outside the edge from variables (n, K) on nodes that include the edge and the kinks.

    ``load`` (n,) is used beyond the edge; at the edge itself it follows from ``displacement`` there, so that
    both sides hold the same state.
    """
    inside, outside = radius <= edge, radius >= edge
    beyond = load[outside]
    beyond[0] = load_inside(chain, variables[outside][:1], np.array([displacement]))[0]
    strains = chain.to_strains(variables[outside], beyond)
    inner = NodalVariables(radius[inside], variables[inside], tuple(k for k in kinks if k < edge))
    return inner, NodalVariables(radius[outside], strains, (edge, *(k for k in kinks if k > edge)))


def spacing(radius: Array, edge: float, length: float, divisions: int) -> Array:
    """Largest distance between nodes: fine within two lengths of the edge, a share of the distance beyond."""
    beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
    return length / divisions + 0.05 * beyond


def updated_state(
    problem: Problem,
    state: ContactState,
    energies: Energies,
    trial: Trial,
    time: float,
    divisions: int,
    tolerance: float,
) -> tuple[ContactState, Energies]:
    """The state after an accepted trial."""
    motion, surface = trial.motion, trial.surface
    points = points_at(problem, state, motion.new_edge * problem.annuli.radii)
    if not problem.viscoelastic:
        variables, history = points.variables, state.history
    else:
        problem.counters.history_updates += 1
        length = problem.length_at(motion.new_edge)
        history = _new_history(problem, state, motion, surface, length, divisions, tolerance)
        variables = advanced(problem.chain, points, motion, None)
    now = change(problem.chain, state.surface, surface, variables, points.load, points.variables)
    after = stepped(problem.chain, energies, now, motion.duration)
    return ContactState(time, motion.new_penetration, surface, history), after


def _new_history(
    problem: Problem,
    state: ContactState,
    motion: Motion,
    surface: ContactSurface,
    length: float,
    divisions: int,
    tolerance: float,
) -> SurfaceHistory:
    chain, edge, radii = problem.chain, motion.new_edge, problem.annuli.radii
    reach = max(abs(edge - motion.edge), 0.25 * length)
    smallest = 0.5 * edge * (1.0 - radii[-1])
    wanted = graded_nodes(radii, edge, reach)
    if len(state.history.outer.radius) == 0:  # first contact: nothing beyond it yet
        wanted = np.concatenate((wanted, [0.0], (edge + length) * np.geomspace(1.0, 1e6, 240)))
    kinks, direction, turning = updated_kinks(state.history, motion.edge, edge, 8.0 * smallest)
    fixed = (edge, *kinks) if turning is None or turning == edge else (edge, turning, *kinks)
    if turning is not None and turning < edge:
        kinks = tuple(sorted((*kinks, turning)))
    radius = distinct(np.concatenate((state.history.radius, wanted)), fixed, smallest)
    allowed = spacing(radius, edge, length, divisions)
    halves = gaps_to_halve(radius, 0.5 * (allowed[1:] + allowed[:-1]))
    radius = np.sort(np.concatenate((radius, halves)))
    load = surface.outside(np.maximum(radius, edge))
    variables = advanced(chain, points_at(problem, state, radius), motion, load)
    at_edge = motion.new_penetration - float(problem.scene.indenter.height(edge))
    inner, outer = split_at_edge(chain, radius, variables, load, edge, at_edge, kinks)
    change = _COARSENING * tolerance * float(np.abs(variables).max(initial=0.0))
    parity = problem.counters.steps % 2

    def coarsen(side: NodalVariables) -> NodalVariables:
        return side.coarsened(change, spacing(side.radius, edge, length, divisions), parity)

    return SurfaceHistory(coarsen(inner), coarsen(outer), direction, turning)
