"""One step of the surface.

A step moves the edge from ``a0`` to ``a1``: points in between are covered or released *at the time the edge
passes them*, and every node is then carried to the end of the step exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite
from validation.reference.tracking.edge_path import EdgePath
from validation.reference.tracking.penetration_path import PenetrationPath
from validation.reference.tracking.rheology import Rheology
from validation.reference.tracking.surface import COINCIDENT, Body, Surface, distinct, shift_last_inwards

Array = NDArray[np.float64]

DIFFERENT_STATES = 1e-9
"""Relative difference above which the states on the two sides of the edge are not one state."""


@dataclass(frozen=True)
class FieldUpdate:
    """Update of the points that the edge does not pass in a step; the same for every path of the edge.

    ``b -> decay b + gain`` in contact, ``e -> recovery e`` outside. ``was_at_rest``: the edge has been at
    rest, and the states on its two sides are no longer one state in two representations.
    """

    depth: PenetrationPath
    decay: Array
    gain: Array
    recovery: Array
    was_at_rest: bool


def field_update(surface: Surface, body: Body, depth: PenetrationPath) -> FieldUpdate:
    """Update of a surface under a penetration that follows ``depth``.

    Parameters
    ----------
    surface : Surface
        At the start of the step.
    body : Body
    depth : PenetrationPath
        Penetration during the step; its duration is that of the step.

    Returns
    -------
    FieldUpdate
    """
    rheology, h = body.rheology, depth.duration
    decay = np.exp(-h / rheology.times)
    memory = depth.memory(np.zeros(1), np.array([h]), rheology.times)[0]
    gain = (memory + decay * depth.jump) * rheology.moduli
    return FieldUpdate(depth, decay, gain, np.exp(-h / rheology.retardation), _sides_differ(surface, body))


def after_step(
    surface: Surface,
    body: Body,
    by: FieldUpdate,
    path: EdgePath,
    fractions: Array,
    with_tip_energy: bool = False,
) -> Surface:
    """The surface at the end of a step.

    Parameters
    ----------
    surface : Surface
        State at the start.
    body : Body
    by : FieldUpdate
        Update of the points that the edge does not pass.
    path : EdgePath
        Edge radius during the step.
    fractions : ndarray, shape (m,)
        Further moments at which nodes are left, as fractions of the step; rising, within (0, 1).
    with_tip_energy : bool
        Whether to compute the energy that the edge releases in a step that takes time; costs a fifth more.

    Returns
    -------
    Surface
    """
    passes = with_tip_energy and by.depth.duration > 0.0
    if path.travel > 0.0:
        return _advanced(surface, body, by, path, fractions, passes)
    if path.travel < 0.0:
        return _receded(surface, body, by, path, fractions, passes)
    return Surface(
        by.depth.end,
        surface.inside,
        surface.branches * by.decay + by.gain,
        surface.outside,
        surface.units * by.recovery,
    )


def _advanced(
    surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array, with_tip_energy: bool
) -> Surface:
    rheology, depth, h = body.rheology, by.depth, by.depth.duration
    radius = path.start + path.travel
    beyond = int(surface.outside.searchsorted(radius, side="right"))
    old = surface.outside[1:beyond]
    old = old[old < radius]
    x = np.array([radius])
    if len(fractions) or len(old):
        x = np.unique(np.concatenate((path(fractions), old, x)))
        x = x[x > path.start]
    near, free = surface.outside[: beyond + 3], surface.units[: beyond + 3]
    units = hermite.evaluate(near, free, hermite.slopes(near, free), x)
    begins = path.start == 0.0  # nothing was in contact, not even the centre: it is covered now
    beside = 0.0 if begins else path.start + min(COINCIDENT * radius, 0.5 * (float(x[0]) - path.start))
    if begins or (by.was_at_rest and path.start < beside < x[0]):  # so is the free side of an edge at rest
        x = np.concatenate(([beside], x))
        units = np.concatenate((surface.units[:1], units))
    kept = slice(0 if begins else None)
    at = _passed(path, x, h, rheology)
    strain = depth.penetration(at) - body.transform(x)
    covered = rheology.cover(units * np.exp(-at[:, None] / rheology.retardation), strain)
    tip = 0.0
    if with_tip_energy:
        first = surface.edge_overlap(body) + depth.jump
        stress = np.concatenate(([rheology.glassy * first], rheology.stress(covered, strain)))
        swept = slice(1 if begins else 0, None)
        tip = _tip_energy(np.concatenate(([path.start], x))[swept], stress[swept], rheology.glassy)
    left = np.full_like(at, h)
    covered = covered * np.exp(-(left - at)[:, None] / rheology.times)
    covered = covered + depth.memory(at, left, rheology.times) * rheology.moduli
    return Surface(
        depth.end,
        np.concatenate((surface.inside[kept], x)),
        np.concatenate((surface.branches[kept] * by.decay + by.gain, covered)),
        np.concatenate(([radius], surface.outside[beyond:])),
        np.concatenate((units[-1:], surface.units[beyond:])) * by.recovery,
        tip,
    )


def _receded(
    surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array, with_tip_energy: bool
) -> Surface:
    rheology, depth, h = body.rheology, by.depth, by.depth.duration
    radius = path.start + path.travel
    kept = int(surface.inside.searchsorted(radius, side="left"))
    passed = int(surface.inside.searchsorted(radius, side="right"))
    x = np.concatenate(([radius], path(fractions), surface.inside[passed:]))
    if len(fractions):
        x = np.unique(x)
    first = max(kept - 3, 0)
    near = surface.inside[first:]
    slope = hermite.slopes(near, surface.branches[first:])
    start = hermite.evaluate(near, surface.branches[first:], slope, x) + depth.jump * rheology.moduli
    at = _passed(path, x, h, rheology)
    at[0] = h
    branches = start * np.exp(-at[:, None] / rheology.times)
    branches = branches + depth.memory(np.zeros_like(at), at, rheology.times) * rheology.moduli
    strain = depth.penetration(at) - body.transform(x)
    tip = -_tip_energy(x, rheology.stress(branches, strain), rheology.glassy) if with_tip_energy else 0.0
    units = rheology.release(branches, strain)
    units = units * np.exp(-(h - at)[:, None] / rheology.retardation)
    outside = surface.units * by.recovery
    if by.was_at_rest:  # the fields are discontinuous there
        shift_last_inwards(x)
        rest = 0
    else:
        rest = 1
    return Surface(
        depth.end,
        np.concatenate((surface.inside[:kept], [radius])),
        np.concatenate((surface.branches[:kept] * by.decay + by.gain, branches[:1])),
        *distinct(np.concatenate((x, surface.outside[rest:])), np.concatenate((units, outside[rest:]))),
        tip,
    )


def _passed(path: EdgePath, x: Array, duration: float, rheology: Rheology) -> Array:
    """Times at which the edge passes points: no later than the end by more than the shortest relaxation time.

    A trial beyond a limit point passes some of them after its end, and looks back on them: over many times of
    a fast branch what it would see is beyond floating point.
    """
    return np.minimum(duration * path.passing(x), duration + rheology.times.min(initial=math.inf))


def _tip_energy(x: Array, stress: Array, glassy: float) -> float:
    """``int q^2/Einf* dx`` over the points that the edge passes, ``q`` at the moment it passes them.

    A field with a sharp edge releases it there and then, before any dashpot has moved.
    """
    return float(hermite.integral_of(x, stress, lambda q, _: q**2)) / glassy


def _sides_differ(surface: Surface, body: Body) -> bool:
    """Whether releasing the edge from inside would leave another state than the one just outside."""
    strain = surface.penetration - body.transform(surface.inside[-1:])
    released = body.rheology.release(surface.branches[-1:], strain)[0]
    gap = np.abs(released - surface.units[0]).sum()
    return bool(gap > DIFFERENT_STATES * (np.abs(released).sum() + np.abs(strain[0])))
