"""Closure of a trial: what the cohesive zone takes up, from the tension inside and the gap outside its edge.

Displacement and penetration positive downwards, gap opening; radii from the axis.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem_solver.free_creep import FreeCreep
from bem_solver.half_space_state import HalfSpaceState, points_at
from bem_solver.motion import Motion
from bem_solver.points_by_passage import advanced
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import displacement_outside

Array = NDArray[np.float64]


def closure_and_tip_gap(
    problem: Problem,
    state: HalfSpaceState,
    motion: Motion,
    surface: ContactSurface,
    zone: float,
    tip_distance: Array,
    creep: FreeCreep | None,
) -> tuple[float, Array]:
    """``I`` (Eq. closure), the punches at kinks integrated from their own edges on, and the gap at the tip.

    Parameters
    ----------
    problem : Problem
    state : HalfSpaceState
        Before the step.
    motion : Motion
    surface : ContactSurface
        After the step.
    zone : float
        Length of the process zone.
    tip_distance : ndarray (2,)
        Distances outside the edge at which the gap of the tip is read.
    creep : FreeCreep or None
        Where it tells tension and displacement.

    Returns
    -------
    closure : float
    gap : ndarray (2,)
    """
    rule, edge, kinks = problem.rule, surface.edge, surface.kinks
    inner, count = rule.inside(zone, edge), len(rule.distance)
    offsets = np.concatenate((inner, zone - tip_distance))
    tension = surface.tension(inner)
    if kinks is None or surface.strengths is None:
        gap = gap_outside(problem, state, motion, surface, edge + zone - offsets, creep)
        if creep is not None:
            tension = creep.tension(inner, tension)
        return rule.integral(tension, gap[:count], zone, edge), gap[count:]
    depth = edge - kinks.radius
    near = np.flatnonzero(depth < min(zone, edge))
    own = (min(zone, edge) - depth[near, None]) * rule.distance  # distances inside each kink
    offsets = np.concatenate((offsets, (depth[near, None] + own).ravel()))
    gap = gap_outside(problem, state, motion, surface, edge + zone - offsets, creep)
    if creep is not None and not near.size:
        tension = creep.tension(inner, tension)
    value = rule.integral(tension, gap[:count], zone, edge)
    count_tip = count + len(tip_distance)
    tip_gap, gaps = gap[count:count_tip], gap[count_tip:].reshape(own.shape)
    for index, distance, facing in zip(near.tolist(), own, gaps, strict=True):
        at_kink = surface.strengths[index] * kinks.tension(index, distance)
        value += (min(zone, edge) - depth[index]) * (rule.weight @ (at_kink * facing)) / (2.0 * zone)
    return float(value), tip_gap


def gap_outside(
    problem: Problem,
    state: HalfSpaceState,
    motion: Motion,
    surface: ContactSurface,
    radius: Array,
    creep: FreeCreep | None,
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
    creep : FreeCreep or None
        Where it tells the displacement.

    Returns
    -------
    ndarray (m,)
    """
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
