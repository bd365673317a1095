"""Start states: elastic equilibrium with the glassy or the relaxed modulus, same closure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.energy import Energies, at_start
from bem_solver.history import History, Track, distinct
from bem_solver.points import Motion, advanced
from bem_solver.rootsearch import rising_root
from bem_solver.surface import Surface
from bem_solver.trial import Front, Problem, Trial, evaluate, points_at
from scene import Material, Scene

Array = NDArray[np.float64]


def elastic_twin(problem: Problem, modulus: float) -> Problem:
    """The same problem on an elastic half-space with the given Young's modulus."""
    material = Material(modulus, problem.scene.material.poisson)
    return replace(problem, chain=Chain(material), scene=replace(problem.scene, material=material))


def empty_front(problem: Problem, time: float, penetration: float) -> Front:
    """No contact and no past."""
    blank = History.blank(len(problem.chain))
    return Front(time, penetration, Surface.free(problem.annuli), blank)


def elastic_equilibrium(problem: Problem, penetration: float, scale: float) -> Trial | None:
    """Largest stable contact of an elastic problem, or ``None``.

    Edges from far above ``scale`` downwards are tried until the residual falls below zero, which brackets the
    stable root; with none, there is no equilibrium. A flat punch is full contact unless it wants to recede.
    """
    front = empty_front(problem, 0.0, penetration)

    def trial(edge: float) -> Trial:
        return evaluate(problem, front, 0.0, edge, "penetration", penetration)

    limit = problem.scene.indenter.edge
    upper = min(limit, 64.0 * scale)
    last = trial(upper)
    if upper == limit and last.residual <= 0.0:
        return last
    edge = upper
    while edge > 1e-5 * upper:
        lower = edge / 1.04
        candidate = trial(lower)
        if candidate.residual <= 0.0 < last.residual:
            return rising_root(trial, lower, 0.0, lower, edge, 1e-11 * edge).trial
        edge, last = lower, candidate
    return None


def contact_scale(scene: Scene, penetration: float) -> float:
    """Order of magnitude of the contact radius at a penetration: where the profile is that high.

    With adhesion, at least the radius at which the closure can balance a profile of that height.
    """
    indenter = scene.indenter
    if np.isfinite(indenter.edge):
        return indenter.edge
    depth = max(abs(penetration), np.finfo(float).tiny)
    if scene.adhesion is not None and scene.is_adhesive:
        # depth h over radius a stores E* h^2 per area and releases work * a: sets a from f(a) ~ h
        stiffness = scene.material.relaxed_plane_modulus
        small, large = 1e-200, 1e200
        for _ in range(400):
            middle = np.sqrt(small * large)
            if float(indenter.slope(middle)) * float(indenter.height(middle)) * stiffness > scene.adhesion.work:
                large = middle
            else:
                small = middle
        depth = max(depth, float(indenter.height(small)))
    small, large = 1e-200, 1e200
    for _ in range(400):
        middle = np.sqrt(small * large)
        if float(indenter.height(middle)) > depth:
            large = middle
        else:
            small = middle
    return float(small)


def start_front(problem: Problem, scale: float) -> tuple[Front, Energies] | None:
    """The start state of the scene, or ``None`` without equilibrium."""
    scene = problem.scene
    relaxed = scene.loading.start == "relaxed"
    material = scene.material
    penetration = scene.loading.penetration
    if problem.work == 0.0 and penetration <= 0.0:
        return empty_front(problem, 0.0, penetration), at_start(problem.chain, 0.0, relaxed)
    modulus = material.modulus if relaxed else material.glassy_modulus
    found = elastic_equilibrium(elastic_twin(problem, modulus), penetration, scale)
    if found is None:
        return None
    surface = found.surface
    front = Front(0.0, penetration, surface, _start_history(problem, surface, penetration, relaxed))
    load_work = float(surface.edge * (problem.annuli.areas * surface.scaled) @ (problem.annuli.matrix @ surface.scaled))
    return front, at_start(problem.chain, load_work, relaxed)


def _start_history(problem: Problem, surface: Surface, penetration: float, relaxed: bool) -> History:
    """Nodes over the contact and far beyond; relaxed means no stress in any branch."""
    edge, radii = surface.edge, problem.annuli.radii
    near = edge * radii
    mirrored = 2.0 * edge - near[near > edge - problem.length]
    far = (edge + problem.length) * np.geomspace(1.0, 200.0, 160)
    radius = distinct(np.concatenate(([0.0], near, [edge], mirrored, far)))
    chain = problem.chain
    load = surface.outside(np.maximum(radius, edge))
    if relaxed:
        variables = np.zeros((len(radius), len(chain)))
    else:
        motion = Motion(0.0, 0.0, edge, penetration, penetration)
        points = points_at(problem, empty_front(problem, 0.0, penetration), radius)
        variables = advanced(chain, points, motion, load)
    return split(chain, radius, variables, load, edge)


def split(chain: Chain, radius: Array, variables: Array, load: Array, edge: float) -> History:
    """History from variables (n, K) on nodes that include the edge; ``load`` (n,) is used outside."""
    inside, outside = radius <= edge, radius >= edge
    strains = chain.to_strains(variables[outside], load[outside])
    return History(Track(radius[inside], variables[inside]), Track(radius[outside], strains))
