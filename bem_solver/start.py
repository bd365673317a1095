"""Equilibria at one instant: start states with the glassy or the relaxed modulus, and first contact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.history import SurfaceHistory, distinct, nodes_beyond
from bem_solver.motion import Motion
from bem_solver.problem import Problem
from bem_solver.root_search import first_stable, rising_root
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import HalfSpaceState, advanced, points_at, split_at_edge
from bem_solver.trial import TrialContact, evaluate
from contact_scene import Indenter, Material, Scene, TabulatedProfile
from contact_scene.scene import zone_too_long

Array = NDArray[np.float64]

_SCAN_RATIO, _SCAN_STRIDE = 1.04, 5
"""Ratio of neighbouring radii in the scan for the largest stable contact, and how many are passed at once
where the residual is nowhere near zero."""
_SCAN_START, _SCAN_START_ON_LAYER, _SCAN_END = 64.0, 4.0, 1e-6
"""Largest and smallest radius of the scan, in the estimated contact radius. The rank of a layer grows with
the radius: there the scan starts at the second, doubled while the edge advances from it."""

_FACING = 64
"""Nodes outside the edge that the closure looks at, even in the root of the distance: their cubics hold the
first residual, by which an edge at rest would creep, to a part of the accuracy of the closure."""


def elastic_problem(problem: Problem, modulus: float) -> Problem:
    """The same problem on an elastic half-space with the given Young's modulus."""
    material = Material(modulus, problem.scene.material.poisson)
    return replace(problem, chain=Chain(material), scene=replace(problem.scene, material=material))


def untouched_state(problem: Problem, penetration: float) -> HalfSpaceState:
    """The state at time 0 without contact and history."""
    blank = SurfaceHistory.blank(len(problem.chain))
    return HalfSpaceState(0.0, penetration, ContactSurface.free(problem.annuli), blank)


def largest_stable(
    problem: Problem, trial: Callable[[float], TrialContact], scale: float
) -> TrialContact | None:
    """Largest stable contact, or ``None``.

    Edges from far above ``scale`` downwards are looked over for where the residual falls below zero, which
    brackets the stable root. A flat face, which touches as a whole, is in full contact unless its edge opens.
    On a layer a contact that would be larger than any that is taken stands for itself.
    """
    indenter = problem.scene.indenter
    edge = limit = min(indenter.edge, _SCAN_START * scale, problem.body.largest)
    if problem.scene.body is not None:
        edge = min(_SCAN_START_ON_LAYER * scale, limit)
    while edge < limit and trial(edge).residual <= 0.0:
        edge = min(2.0 * edge, limit)
    end, largest = _SCAN_END * scale, trial(edge)
    if edge == problem.body.largest and largest.residual <= 0.0:
        return largest
    if edge == indenter.edge and min(largest.residual, largest.closure - problem.work) <= 0.0:
        return largest
    while edge > end and trial(edge).residual <= 0.0:
        edge /= _SCAN_RATIO
    places = indenter.radii if isinstance(indenter, TabulatedProfile) else ()
    found = first_stable(trial, edge, end, _SCAN_RATIO, _SCAN_STRIDE, places=places) if edge > end else None
    if found is None:
        return None
    high, low = found
    return rising_root(trial, low, 0.0, low, high, 1e-11 * high).trial


def equilibrium(
    problem: Problem, state: HalfSpaceState, control: str, value: float, scale: float
) -> TrialContact | None:
    """The largest stable contact at once under the given control, or ``None``, of a ``scale`` of radii."""

    def trial(edge: float) -> TrialContact:
        return evaluate(problem, state, 0.0, edge, control, value)

    return largest_stable(problem, cache(trial), scale)


def radius_where(indenter: Indenter, reached: Callable[[float], bool]) -> float:
    """Smallest radius at which a condition that grows with radius holds (by halving in log radius)."""
    small, large = 1e-100, 1e100
    for _ in range(200):
        middle = float(np.sqrt(small) * np.sqrt(large))
        small, large = (small, middle) if reached(middle) else (middle, large)
    return large


def contact_scale(scene: Scene, penetration: float) -> float:
    """Order of magnitude of the contact radius at a penetration.

    Where the profile is as high as the penetration; with adhesion at least where its height h and slope
    store as much as adhesion gives, ``E0* h dh/dr = dgamma``.
    """
    indenter = scene.indenter
    if np.isfinite(indenter.edge):
        return indenter.edge
    depth = abs(penetration)
    geometric = radius_where(indenter, lambda r: float(indenter.height(r)) >= depth) if depth > 0 else 0.0
    if scene.adhesion is None or not scene.is_adhesive:
        return geometric
    balance = scene.adhesion.work / scene.material.relaxed_plane_modulus
    adhesive = radius_where(indenter, lambda r: float(indenter.height(r) * indenter.slope(r)) >= balance)
    return max(geometric, adhesive)


def start_state(problem: Problem, scale: float) -> HalfSpaceState | None:
    """The start state of the scene, or ``None`` without equilibrium."""
    scene = problem.scene
    relaxed = scene.loading.start == "relaxed"
    material = scene.material
    penetration = scene.loading.penetration
    if problem.work == 0.0 and penetration <= 0.0:
        return untouched_state(problem, penetration)
    elastic = elastic_problem(problem, material.modulus if relaxed else material.glassy_modulus)
    untouched = untouched_state(elastic, penetration)
    trial = equilibrium(elastic, untouched, scene.loading.start_control, penetration, scale)
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
