"""From an accepted trial to the next committed state: history, energies, surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.energy import Energies, change, stepped
from bem_solver.history import History, Track, distinct, gaps_to_halve, graded_nodes, lingered
from bem_solver.surface import Surface
from bem_solver.surface_points import Motion, advanced, load_inside
from bem_solver.trial import Front, Problem, Trial, points_at

Array = NDArray[np.float64]

#: change of an internal variable that a removed node may cause, in step tolerances of the largest one
_THINNING = 0.002


def split(
    chain: Chain,
    radius: Array,
    variables: Array,
    load: Array,
    edge: float,
    displacement: float,
    kinks: tuple[float, ...] = (),
) -> tuple[Track, Track]:
    """Inner and outer track from variables (n, K) on nodes that include the edge and the kinks.

    ``load`` (n,) is used beyond the edge; at the edge itself it follows from ``displacement`` there, so that
    both sides hold the same state.
    """
    inside, outside = radius <= edge, radius >= edge
    beyond = load[outside]
    beyond[0] = load_inside(chain, variables[outside][:1], np.array([displacement]))[0]
    strains = chain.to_strains(variables[outside], beyond)
    inner = Track(radius[inside], variables[inside], tuple(k for k in kinks if k < edge))
    return inner, Track(radius[outside], strains, (edge, *(k for k in kinks if k > edge)))


def spacing(radius: Array, edge: float, length: float, divisions: int) -> Array:
    """Largest distance between nodes: fine within two lengths of the edge, a share of the distance beyond."""
    beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
    return length / divisions + 0.05 * beyond


def committed(
    problem: Problem,
    front: Front,
    energies: Energies,
    trial: Trial,
    time: float,
    divisions: int,
    tolerance: float,
) -> tuple[Front, Energies]:
    """The state after an accepted trial."""
    motion, surface = trial.motion, trial.surface
    points = points_at(problem, front, motion.new_edge * problem.annuli.radii)
    if not problem.remembers:
        variables, history = points.variables, front.history
    else:
        problem.counters.history_updates += 1
        length = problem.length_at(motion.new_edge)
        history = _new_history(problem, front, motion, surface, length, divisions, tolerance)
        variables = advanced(problem.chain, points, motion, None)
    now = change(problem.chain, front.surface, surface, variables, points.load, points.variables)
    after = stepped(problem.chain, energies, now, motion.duration)
    return Front(time, motion.new_penetration, surface, history), after


def _new_history(
    problem: Problem,
    front: Front,
    motion: Motion,
    surface: Surface,
    length: float,
    divisions: int,
    tolerance: float,
) -> History:
    chain, edge, radii = problem.chain, motion.new_edge, problem.annuli.radii
    reach = max(abs(edge - motion.edge), 0.25 * length)
    smallest = 0.5 * edge * (1.0 - radii[-1])
    wanted = graded_nodes(radii, edge, reach)
    if len(front.history.outer.radius) == 0:  # first contact: nothing beyond it yet
        wanted = np.concatenate((wanted, [0.0], (edge + length) * np.geomspace(1.0, 1e6, 240)))
    kinks, direction, turning = lingered(front.history, motion.edge, edge, 8.0 * smallest)
    fixed = (edge, *kinks) if turning is None or turning == edge else (edge, turning, *kinks)
    if turning is not None and turning < edge:
        kinks = tuple(sorted((*kinks, turning)))
    radius = distinct(np.concatenate((front.history.radius, wanted)), fixed, smallest)
    allowed = spacing(radius, edge, length, divisions)
    halves = gaps_to_halve(radius, 0.5 * (allowed[1:] + allowed[:-1]))
    radius = np.sort(np.concatenate((radius, halves)))
    load = surface.outside(np.maximum(radius, edge))
    state = advanced(chain, points_at(problem, front, radius), motion, load)
    at_edge = motion.new_penetration - float(problem.scene.indenter.height(edge))
    inner, outer = split(chain, radius, state, load, edge, at_edge, kinks)
    change = _THINNING * tolerance * float(np.abs(state).max(initial=0.0))
    parity = problem.counters.steps % 2

    def thin(track: Track) -> Track:
        return track.thinned(change, spacing(track.radius, edge, length, divisions), parity)

    return History(thin(inner), thin(outer), direction, turning)
