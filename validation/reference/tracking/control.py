"""Prescribed penetration during a step, and the penetration that balances a prescribed force or stage."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Segment
from validation.reference.path.rheology import Body
from validation.reference.tracking.edge_path import EdgePath
from validation.reference.tracking.penetration_path import PenetrationPath, cubic, straight
from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.surface_step import FieldUpdate, surface_step

Array = NDArray[np.float64]

TRIAL_SEPARATION = 1e-3
"""Least difference of two trials, relative to the force (or stage): closer ones lose digits."""

UNBALANCED = 1e-13
"""Difference from the force (or stage) asked for, relative to it, above which a state is corrected: the
limited slopes of the fields bend a little with the penetration."""


def prescribed_penetration(
    segment: Segment, time: float, duration: float, surface: Surface
) -> PenetrationPath:
    """Penetration under penetration control: exact where it is linear, otherwise its Hermite cubic.

    Parameters
    ----------
    segment : Segment
        Load step under penetration control.
    time, duration : float
        Start and length of the step; of length 0, it is a jump.
    surface : Surface
        State at the start, whose penetration may differ from the first prescribed one by a jump.

    Returns
    -------
    PenetrationPath
    """
    first = segment.value(time)
    start, jump = surface.penetration, first - surface.penetration
    if duration == 0.0:
        return straight(0.0, start, jump, first)
    last = segment.value(time + duration)
    if segment.linear:
        return straight(duration, start, jump, last)
    shape = cubic(duration, first, last, segment.rate(time), segment.rate(time + duration))
    return replace(shape, start=start, jump=jump)


def balanced(
    surface: Surface,
    body: Body,
    segment: Segment,
    target: float,
    by: FieldUpdate,
    depths: RowExtrapolation,
    path: EdgePath,
    fractions: Array,
    *,
    over_zones: bool = False,
    with_tip_energy: bool = False,
) -> Surface:
    """The surface at the end of a step at which the force, or the stage ``D + F/k``, is ``target``.

    For a given path of the edge every field is affine in the penetration at the end of the step, so that the
    surfaces for two penetrations give the balanced one, but for the slopes of the fields between their nodes.

    Parameters
    ----------
    surface : Surface
        State at the start.
    body : Body
    segment : Segment
        Load step under force or stage control.
    target : float
        Force, or stage, at the end of the step.
    by : FieldUpdate
        Of the step if it ends at the penetration at which it starts.
    depths : RowExtrapolation
        Penetration at the rows before, for the curvature of its path.
    path : EdgePath
        Edge radius during the step.
    fractions : ndarray, shape (m,)
        Moments at which nodes are left, as fractions of the step.
    over_zones : bool
        Whether the step may pass over process zones; the penetration is then a cubic, otherwise a parabola.
    with_tip_energy : bool
        Whether to compute the energy that the edge releases.

    Returns
    -------
    Surface
    """
    duration, start = by.depth.duration, surface.penetration
    step = surface_step(surface, body, by, path, fractions)

    def measure(state: Surface) -> float:
        return _balanced_quantity(state, body, segment)

    def ending(end: float, with_tip_energy: bool = False) -> Surface:
        depth = through_rows(duration, start, end, depths, over_zones)
        return step(by.under(depth, body), with_tip_energy)

    wanted = target if path.start + path.travel > 0.0 or segment.control != "force" else 0.0
    one = step(by)
    at_one = measure(one)
    lacking = wanted - at_one
    if lacking == 0.0:
        return one
    difference = math.copysign(max(abs(lacking), TRIAL_SEPARATION * abs(wanted)), lacking)
    two = ending(start + difference / _slope(segment, body, duration, path))
    gained = measure(two) - at_one
    if gained == 0.0:  # a force too small for its own round-off
        return two
    apart = (two.penetration - start) / gained
    mixed = ending(start + lacking * apart, with_tip_energy)
    if not with_tip_energy:
        return mixed
    missed = wanted - measure(mixed)
    if abs(missed) <= UNBALANCED * abs(wanted):
        return mixed
    return ending(mixed.penetration + missed * apart, True)


def _balanced_quantity(state: Surface, body: Body, segment: Segment) -> float:
    """The force, or the stage, of a state.

    A contact that ends in a point carries no force; there the stress at the point has to vanish.
    """
    if segment.control == "force" and state.radius == 0.0:
        return state.edge_stress(body)
    return segment.present(state.penetration, state.force(body))


def freedom(segment: Segment, body: Body, radius: float) -> float:
    """How free the penetration is under a load: 0 where it is prescribed, 1 under a force.

    On a spring the share of the stage's travel that the contact leaves to it in a run too fast to relax.

    Parameters
    ----------
    segment : Segment
    body : Body
    radius : float
        Contact radius.

    Returns
    -------
    float
    """
    if segment.control != "stage":
        return 1.0 if segment.control == "force" else 0.0
    soft = segment.compliance * 2.0 * body.rheology.glassy * radius
    return soft / (1.0 + soft)


def _slope(segment: Segment, body: Body, duration: float, path: EdgePath) -> float:
    """Change of the force, or the stage, for a change of penetration, with the edge at rest."""
    stiffness = _stiffness(body, duration, path)
    return stiffness if segment.control == "force" else 1.0 + segment.compliance * stiffness


def _stiffness(body: Body, duration: float, path: EdgePath) -> float:
    """Change of force for a change of penetration, with the edge at rest."""
    y = duration / body.rheology.times
    shared = np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)
    radius = max(path.start, path.start + path.travel)
    return 2.0 * radius * (body.rheology.relaxed + float((body.rheology.moduli * shared).sum()))


def through_rows(
    duration: float, start: float, end: float, depths: RowExtrapolation, over_zones: bool
) -> PenetrationPath:
    """Penetration to ``end`` with the curvature of the rows before, or the cubic through two of them.

    Parameters
    ----------
    duration : float
    start, end : float
        Penetration at both ends of the step.
    depths : RowExtrapolation
        Penetration at the rows before.
    over_zones : bool
        Whether to take the cubic, where there are rows enough.

    Returns
    -------
    PenetrationPath
    """
    if duration == 0.0:
        return straight(0.0, start, end - start, end)
    rate = (end - start) / duration
    if not over_zones or len(depths.times) < 3:
        bend = 0.5 * depths.curvature(duration, end)
        return PenetrationPath(duration, start, 0.0, (rate - bend * duration, bend, 0.0))
    one, two = depths.times[1:3]
    second = ((depths.values[1] - start) / one - rate) / (one - duration)  # divided differences
    earlier = ((depths.values[2] - depths.values[1]) / (two - one) - (depths.values[1] - start) / one) / two
    third = (earlier - second) / (two - duration)
    rates = (rate - duration * (second - one * third), second - (duration + one) * third, third)
    return PenetrationPath(duration, start, 0.0, rates)
