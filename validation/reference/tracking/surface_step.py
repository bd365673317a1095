"""One step of the surface.

A step moves the edge from ``a0`` to ``a1``: points in between are covered or released *at the time the edge
passes them*, and every node is then carried to the end of the step exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.rheology import Body, Rheology
from validation.reference.tracking import hermite
from validation.reference.tracking.edge_path import EdgePath
from validation.reference.tracking.penetration_path import BranchGain, PenetrationPath
from validation.reference.tracking.surface import COINCIDENT, Surface, distinct, shift_last_inwards

Array = NDArray[np.float64]

DIFFERENT_STATES = 1e-9
"""Relative difference above which the states on the two sides of the edge are not one state."""


@dataclass(frozen=True)
class FieldUpdate:
    """Update of the points that the edge does not pass in a step; the same for every path of the edge.

    ``b -> decay b + gain`` in contact, ``e -> recovery e`` outside. ``was_at_rest``: the edge has been at
    rest, and the states on its two sides are no longer one state in two representations.
    ``of_step``: what branches gain over the whole of the step.
    """

    depth: PenetrationPath
    decay: Array
    gain: Array
    recovery: Array
    was_at_rest: bool
    of_step: BranchGain

    def under(self, depth: PenetrationPath, body: Body) -> FieldUpdate:
        """The same under another penetration during a step of the same duration."""
        gain = self.of_step.under(depth)[0] + self.decay * depth.jump
        return replace(self, depth=depth, gain=gain * body.rheology.moduli)


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
    decay, recovery = np.exp(-h / rheology.times), np.exp(-h / rheology.retardation)
    of_step = BranchGain(np.zeros(1), np.array([h]), rheology.times)
    at_rest = _sides_differ(surface, body)
    return FieldUpdate(depth, decay, np.zeros_like(decay), recovery, at_rest, of_step).under(depth, body)


class SurfaceStep(Protocol):
    """Step of a surface along a path of its edge, under any penetration."""

    def __call__(self, by: FieldUpdate, with_tip_energy: bool = False) -> Surface:
        """The surface at the end of the step.

        Parameters
        ----------
        by : FieldUpdate
            Update of the points that the edge does not pass.
        with_tip_energy : bool
            Whether to compute the energy that the edge releases in a step that takes time.

        Returns
        -------
        Surface
        """
        ...


def surface_step(
    surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array
) -> SurfaceStep:
    """A step along a path.

    Parameters
    ----------
    surface : Surface
        State at the start.
    body : Body
    by : FieldUpdate
        Of a step of that duration, under any penetration.
    path : EdgePath
        Edge radius during the step.
    fractions : ndarray, shape (m,)
        Further moments at which nodes are left, as fractions of the step; rising, within (0, 1).

    Returns
    -------
    SurfaceStep
    """
    if path.travel > 0.0:
        return _advancing(surface, body, by, path, fractions)
    if path.travel < 0.0:
        return _receding(surface, body, by, path, fractions)
    return _EdgeAtRest(surface)


@dataclass(frozen=True)
class _EdgeAtRest:
    """Step of an edge that rests."""

    surface: Surface

    def __call__(self, by: FieldUpdate, with_tip_energy: bool = False) -> Surface:
        start = self.surface
        branches, units = start.branches * by.decay + by.gain, start.units * by.recovery
        return Surface(by.depth.end, start.inside, branches, start.outside, units)


@dataclass(frozen=True, kw_only=True)
class _MovingEdge:
    """Step of an edge that passes points ``x`` (m,), the new edge among them, at times ``at`` (m,).

    ``fading`` (m, n) is what is left of the branch forces of these points, ``gain`` what they gain while they
    are in contact, ``profile`` (m,) the transform of the indenter. ``inside`` and ``outside`` are the nodes
    at the end of the step, ``branches`` and ``free`` the part of their state that no penetration changes.
    """

    body: Body
    x: Array
    at: Array
    fading: Array
    profile: Array
    gain: BranchGain
    inside: Array
    branches: Array
    outside: Array
    free: Array


@dataclass(frozen=True, kw_only=True)
class _AdvancingEdge(_MovingEdge):
    """Covers points, the last of them the new edge.

    ``units`` (m, n) are the strains with which the edge meets them; their forces fade from then to the end.
    """

    surface: Surface
    units: Array

    def __call__(self, by: FieldUpdate, with_tip_energy: bool = False) -> Surface:
        rheology, depth = self.body.rheology, by.depth
        strain = depth.penetration(self.at) - self.profile
        covered = rheology.cover(self.units, strain)
        tip = self._released(depth, covered, strain) if with_tip_energy and depth.duration > 0.0 else 0.0
        covered = covered * self.fading + self.gain.under(depth) * rheology.moduli
        branches = np.concatenate((self.branches + by.gain, covered))
        return Surface(depth.end, self.inside, branches, self.outside, self.free, tip)

    def _released(self, depth: PenetrationPath, covered: Array, strain: Array) -> float:
        """Tip energy."""
        rheology, start = self.body.rheology, self.surface.radius
        stress = rheology.stress(covered, strain)
        if start == 0.0:
            return _tip_energy(self.x, stress, rheology.glassy)
        first = rheology.glassy * (self.surface.edge_overlap(self.body) + depth.jump)
        stress = np.concatenate(([first], stress))
        return _tip_energy(np.concatenate(([start], self.x)), stress, rheology.glassy)


def _advancing(
    surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array
) -> _AdvancingEdge:
    rheology, h = body.rheology, by.depth.duration
    radius = path.start + path.travel
    beyond = int(surface.outside.searchsorted(radius, side="right"))
    old = surface.outside[1:beyond]
    x = np.array([radius])
    if len(fractions) or len(old):
        x = _rising(np.concatenate((path(fractions), old, x)))
        x = x[x > path.start]
    units = surface.units_at(x)
    begins = path.start == 0.0  # nothing was in contact, not even the centre: it is covered now
    beside = 0.0 if begins else path.start + min(COINCIDENT * radius, 0.5 * (float(x[0]) - path.start))
    if begins or (by.was_at_rest and path.start < beside < x[0]):  # so is the free side of an edge at rest
        x = np.concatenate(([beside], x))
        units = np.concatenate((surface.units[:1], units))
    kept = slice(0 if begins else None)
    at = _passed(path, x, h, rheology)
    left = np.full_like(at, h)
    return _AdvancingEdge(
        body=body,
        surface=surface,
        x=x,
        at=at,
        units=units * np.exp(-at[:, None] / rheology.retardation),
        fading=np.exp(-(left - at)[:, None] / rheology.times),
        profile=body.transform(x),
        gain=BranchGain(at, left, rheology.times),
        inside=np.concatenate((surface.inside[kept], x)),
        branches=surface.branches[kept] * by.decay,
        outside=np.concatenate(([radius], surface.outside[beyond:])),
        free=np.concatenate((units[-1:], surface.units[beyond:])) * by.recovery,
    )


@dataclass(frozen=True, kw_only=True)
class _RecedingEdge(_MovingEdge):
    """Releases points, the first of them the new edge.

    ``start`` (m, n) are their branch forces at the start of the step, which fade until the release, and
    ``recovering`` (m, n) is what is left of their strains since then.
    """

    start: Array
    recovering: Array

    def __call__(self, by: FieldUpdate, with_tip_energy: bool = False) -> Surface:
        rheology, depth = self.body.rheology, by.depth
        start = self.start if depth.jump == 0.0 else self.start + depth.jump * rheology.moduli
        branches = start * self.fading + self.gain.under(depth) * rheology.moduli
        strain = depth.penetration(self.at) - self.profile
        tip = 0.0
        if with_tip_energy and depth.duration > 0.0:
            tip = -_tip_energy(self.x, rheology.stress(branches, strain), rheology.glassy)
        units = rheology.release(branches, strain) * self.recovering
        return Surface(
            depth.end,
            self.inside,
            np.concatenate((self.branches + by.gain, branches[:1])),
            *distinct(self.outside, np.concatenate((units, self.free))),
            tip,
        )


def _receding(
    surface: Surface, body: Body, by: FieldUpdate, path: EdgePath, fractions: Array
) -> _RecedingEdge:
    rheology, h = body.rheology, by.depth.duration
    radius = path.start + path.travel
    kept = int(surface.inside.searchsorted(radius, side="left"))
    passed = int(surface.inside.searchsorted(radius, side="right"))
    x = np.concatenate(([radius], path(fractions), surface.inside[passed:]))
    if len(fractions):
        x = _rising(x)
    at = _passed(path, x, h, rheology)
    at[0] = h
    rest = 1  # of the nodes outside: the edge itself is released now
    beside = x
    if by.was_at_rest:  # the fields are discontinuous there
        rest, beside = 0, x.copy()
        shift_last_inwards(beside)
    return _RecedingEdge(
        body=body,
        x=x,
        at=at,
        start=surface.branches_at(x),
        fading=np.exp(-at[:, None] / rheology.times),
        recovering=np.exp(-(h - at)[:, None] / rheology.retardation),
        profile=body.transform(x),
        gain=BranchGain(np.zeros_like(at), at, rheology.times),
        inside=np.concatenate((surface.inside[:kept], x[:1])),
        branches=surface.branches[:kept] * by.decay,
        outside=np.concatenate((beside, surface.outside[rest:])),
        free=surface.units[rest:] * by.recovery,
    )


def _rising(x: Array) -> Array:
    """The points in order, each once."""
    x.sort()
    apart = x[1:] > x[:-1]
    return x if apart.all() else x[np.concatenate((apart, [True]))]


def _passed(path: EdgePath, x: Array, duration: float, rheology: Rheology) -> Array:
    """Times at which the edge passes points: no later than the end by more than the shortest relaxation time.

    A trial beyond a limit point passes some of them after its end, and looks back on them: over many times of
    a fast branch what it would see is beyond floating point.
    """
    return np.minimum(duration * path.passing(x), duration + rheology.shortest)


def _tip_energy(x: Array, stress: Array, glassy: float) -> float:
    """``int q^2/Einf* dx`` over the points that the edge passes, ``q`` at the moment it passes them.

    A field with a sharp edge releases it there and then, before any dashpot has moved.
    """
    return hermite.integral_of(x, stress, lambda q, _: q * q, hermite.slopes(x, stress)) / glassy


def _sides_differ(surface: Surface, body: Body) -> bool:
    """Whether releasing the edge from inside would leave another state than the one just outside."""
    strain = surface.penetration - body.transform(surface.inside[-1:])
    released = body.rheology.release(surface.branches[-1:], strain)[0]
    gap = np.abs(released - surface.units[0]).sum()
    return bool(gap > DIFFERENT_STATES * (np.abs(released).sum() + np.abs(strain[0])))
