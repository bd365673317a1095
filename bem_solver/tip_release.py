"""Glassy energy release rate of the tip, ``K^2/(2 Einf*)``, and what it makes of a step.

An opening tip has it from the stress inside the contact. Behind an advancing edge that stress falls within a
layer that may be thinner than an annulus; outside, the opening is a root of the distance throughout, which at
a closing tip is the glassy one, ``c = (4 K/Einf*)/sqrt(2 pi)``.

A tip that opens slowly releases the relaxed share of the work of adhesion, one that closes slowly the work of
adhesion times the ratio of glassy to relaxed modulus: the square of that ratio lies between them, and the
release jumps by it where the edge turns or passes a place where it has rested.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.history import SurfaceHistory
from bem_solver.motion import Motion
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]

_DISTANCES = np.array([1.0, 2.0])
"""Distances outside the edge from which the root of the gap at the tip is read, in the nearest one: beyond
twice that, what the last turn has left of the gap is no power of the distance."""
_NEAREST, _FARTHEST = 1.0 / 64.0, 0.25
"""Bounds on the nearest one, in process zones."""
_SHARE_OF_WAY = 0.25
"""Upper bound on the first of them, in distances of the edge from where it has turned or rested: what is left
of the gap from there falls off over that distance."""
_RESOLVED = 32.0
"""Lower bound on it, in distances of the outermost collocation radius from the edge."""
_BRANCH_TRAVELS = 16.0
"""The nearest one, in distances the edge travels while a branch lags: there the root of a steady edge is read
to some 0.2 %; nearer, the error grows as one over the distance."""


def tip_distances(problem: Problem, history: SurfaceHistory, motion: Motion, zone: float) -> Array:
    """Distances (2,) outside the edge at which the gap at the tip is read after a step.

    Parameters
    ----------
    problem : Problem
    history : SurfaceHistory
        Before the step.
    motion : Motion
    zone : float
        Length of the process zone.

    Returns
    -------
    ndarray (2,)

    Notes
    -----
    The nearer to the tip, the less of the gap that was there before is in it. But what a branch makes of the
    edge's last travel is only as good as the path assumed in the step: over what the edge travels in the
    branch's time, in proportion to its share in what has crept until then, and less in a shorter step.
    """
    chain, outermost = problem.chain, motion.new_edge * problem.annuli.outermost
    y = motion.duration / chain.retardation
    lagging = float((chain.share_in_creep * np.minimum(y, 1.0 / np.maximum(y, 1.0))).max(initial=0.0))
    distance = _BRANCH_TRAVELS * lagging * abs(motion.new_edge - motion.edge)
    way = min((abs(motion.new_edge - rest) for rest in release_jumps(history, motion)), default=math.inf)
    nearest = max(min(_NEAREST * zone, _SHARE_OF_WAY * way), _RESOLVED * outermost)
    return min(max(distance, nearest), _FARTHEST * zone) * _DISTANCES


def tip_release(
    chain: Chain, surface: ContactSurface, gap: Array, distances: Array, history: SurfaceHistory
) -> tuple[float, float]:
    """Glassy energy release rate of the tip, were it to open and to close.

    Parameters
    ----------
    chain : Chain
    surface : ContactSurface
    gap, distances : ndarray (2,)
        Gap outside the edge, and how far outside: ``distances[1]`` is twice ``distances[0]``.
    history : SurfaceHistory
        Of the same instant.

    Returns
    -------
    opening, closing : float
        An energy per area.

    Notes
    -----
    The gap is ``A sqrt(d) + B d^(3/2)`` and the roots that begin at places of rest ahead. Those are in the
    strains of the history, fresh or long faded: a fit to the gap alone takes its bend for them.
    """
    kinks, strains = history.outer.roots_at_kinks()
    beyond = np.sqrt(np.maximum(surface.edge + distances[:, None] - kinks, 0.0))
    near, far = ((gap - beyond @ chain.lag(strains)) / np.sqrt(distances)).tolist()
    root = max(2.0 * near - far, 0.0)
    return 0.5 * surface.stress_intensity**2 / chain.glassy, root**2 * chain.glassy * np.pi / 16.0


def release_jumps(history: SurfaceHistory, motion: Motion) -> tuple[float, ...]:
    """Radii at which the release of the tip jumps: where an edge has rested, and where it turns now."""
    turns = history.direction * (motion.new_edge - motion.edge) < 0.0
    return (*history.past_kinks, motion.edge) if turns else history.past_kinks


def reached_jumps(jumps: tuple[float, ...], motion: Motion, after: SurfaceHistory) -> tuple[float, ...]:
    """Radii at which the release jumps; those too near ahead of a closing edge to be told from it, there.

    The history ``after`` the step holds them no more as kinks, and their roots are read with the tip's.
    """
    if motion.new_edge <= motion.edge:
        return jumps
    return tuple(jump if jump in after.outer.kinks else min(jump, motion.new_edge) for jump in jumps)


def energy_of_tip(
    release: tuple[float, float] | None,
    new_release: tuple[float, float],
    motion: Motion,
    kinks: tuple[float, ...],
) -> float:
    """What the tip takes up in a step, ``int K^2/(2 Einf*) dA``, as if it were the end of a glassy crack.

    Parameters
    ----------
    release, new_release : tuple of float, or None
        Glassy energy release rates of the tip before and after, were it to open and to close there.
    motion : Motion
    kinks : tuple of float
        Where the edge turns or has rested: there the release jumps, by up to the square of the ratio of the
        moduli, within what the edge travels in the time of the fastest branch.

    Returns
    -------
    float
        NaN where the release before is not known.
    """
    if release is None:
        return math.nan
    edge, new_edge = motion.edge, motion.new_edge
    way = int(new_edge > edge)
    before, after = release[way], new_release[way]
    grown = math.pi * (new_edge - edge) * (new_edge + edge)
    met = [kink for kink in kinks if min(edge, new_edge) <= kink <= max(edge, new_edge)]
    if not met:
        return 0.5 * (before + after) * grown
    kink = min(met, key=lambda radius: abs(radius - edge))
    as_before = math.pi * (kink - edge) * (kink + edge)
    return before * as_before + after * (grown - as_before)
