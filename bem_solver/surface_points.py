"""Surface points over one step, while the edge moves at constant speed from one radius to another.

A point is inside all the time, outside all the time, covered (outside, then inside) or released (inside, then
outside); ``points_by_passage`` tells which. Inside, displacement is linear in time and the Maxwell recursion
exact. Outside, ``v`` is the sum of the edge's own part, ``-singular * sqrt(distance to the moving edge)``, of
a departure from a straight line in time, and of a rest that is linear in time; the recursions are exact for
all. The departure is that of ``v`` at the edge, or ahead of an edge that hardly moves, a parabola through an
earlier row; without adhesion that at a point inside all the time, near the edge, falling off as ``v``. So
both sides of an edge at rest change alike: a step between them would be read as a root by an edge that
advances a little. Where a step passes over process zones, the speed of the edge is not constant but that of
its path (``bent_path``); ahead of an edge that advances over them displacement is known as well
(``free_creep``), and the Maxwell recursion serves. A covered point meets the indenter at the moment the edge
passes; a released one leaves it, glassy, then.
Displacement ``w``, load ``v`` and penetration are positive downwards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.motion import Motion, Passage, SurfacePoints

Array = NDArray[np.float64]


def pressed(
    chain: Chain, variables: Array, rise: Array, duration: float | Array, bend: float | Array = 0.0
) -> Array:
    """Variables of points in contact while ``w`` follows a parabola: the exact Maxwell recursion.

    Parameters
    ----------
    chain : Chain
    variables : ndarray (m, K)
    rise : ndarray (m,)
        Of the displacement ``w``.
    duration : float or ndarray (m,)
    bend : float or ndarray (m,)
        ``c`` in ``w = ... + rise s + c s (s - 1)`` after a share s of the duration.

    Returns
    -------
    ndarray (m, K)
    """
    straight = isinstance(bend, float) and bend == 0.0
    if isinstance(duration, float):
        decay, risen, bent = chain.in_contact(duration)
    else:
        y, rate = duration[..., None] / chain.relaxation, chain.stress_rate
        decay, risen = chain.decay(y), rate * chain.spread(y)
        bent = np.zeros(1) if straight else rate * chain.spread_bent(y)
    result = decay * variables + risen * rise[:, None]
    if not straight:
        result += bent * np.asarray(bend, float)[..., None]
    return result


def load_inside(chain: Chain, variables: Array, displacement: Array) -> Array:
    """``v = E0 w + sum b``."""
    return chain.relaxed * displacement + chain.stress(variables)


def bend(chain: Chain, points: SurfacePoints, motion: Motion, first: Array, last: Array) -> Array:
    """Scaled lags at a share of the step beyond those under a load that is linear since an earlier share.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
        Outside the innermost edge of the step.
    motion : Motion
    first, last : ndarray (m,) or (1,)
        Shares of the step.

    Returns
    -------
    ndarray (m, K)
        Those of a point inside the edge, where displacement is prescribed, times the share of its load that
        the points have: in a hold all loads relax in proportion.
    """
    point = motion.innermost
    if point is None or motion.duration == 0.0:
        return np.zeros((len(points), len(chain)))

    def at(share: Array) -> tuple[Array, Array]:
        rise = motion.penetration_at(share) - motion.penetration
        bent = motion.bend * share**2 if motion.bend != 0.0 else 0.0
        variables = pressed(chain, point.variables, rise, share * motion.duration, bent)
        load = load_inside(chain, variables, point.displacement + rise)
        return variables @ chain.rotation.T, load

    (before, load), (after, new_load) = at(first), at(last)
    y = ((last - first) * motion.duration)[:, None] / chain.retardation
    lags = after - chain.decay(y) * before - chain.spread(y) * chain.lag_rate * (new_load - load)[:, None]
    part = np.clip(points.load / point.load, 0.0, 1.0) if point.load[0] != 0.0 else np.zeros(len(points))
    return part[:, None] * lags


def covered(chain: Chain, points: SurfacePoints, motion: Motion, passage: Passage) -> Array:
    """Variables of points that the advancing edge passes.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    passage : Passage
        Of the points, in this motion or another of the same edge.

    Returns
    -------
    ndarray (m, K)
    """
    share, left = passage.shares
    meeting = motion.penetration_at(share) - points.height
    if motion.carried is None:
        variables = _met_under_load(chain, points, motion, passage, meeting)
    else:
        rise, y = meeting - points.displacement, share[:, None] * (motion.duration / chain.relaxation)
        variables = chain.decay(y) * points.variables + chain.stress_rate * chain.spread(y) * rise[:, None]
        variables += motion.carried.stresses(chain, motion.duration, points.radius, left)
    pushed = motion.new_penetration - points.height - meeting
    bent = motion.bend * left**2 if motion.bend != 0.0 else 0.0
    return pressed(chain, variables, pushed, left * motion.duration, bent)


def _met_under_load(
    chain: Chain, points: SurfacePoints, motion: Motion, passage: Passage, meeting: Array
) -> Array:
    """Variables where the indenter is met, at a displacement ``meeting``, under a load known until then."""
    share, _ = passage.shares
    y = (share * motion.duration)[:, None] / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (points.variables @ chain.rotation.T)
    if motion.path is None:
        rise = motion.singular * np.sqrt(points.radius - motion.edge)
        lags += (chain.spread_to_edge(y) - even) * chain.lag_rate * rise[:, None]
        lags += motion.lags_of_bend(chain, share)
    else:
        lags += motion.lags_of_fall(chain, passage.recent)
    if motion.innermost is not None:
        lags += bend(chain, points, motion, np.zeros_like(share), share)
    # w = v/E0 - sum l at the moment of contact, with even * (v - v_n) still to come into l
    per_load = even @ chain.compliances
    load = (meeting + chain.lag(lags) - per_load * points.load) / (1.0 / chain.relaxed - per_load)
    lags += even * chain.lag_rate * (load - points.load)[:, None]
    return lags @ chain.rotation


def released(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array, passage: Passage) -> Array:
    """Variables of points that the receding edge passes, without :func:`along_path`.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    new_load : ndarray (m,)
        ``v`` at the end.
    passage : Passage
        Of the points.

    Returns
    -------
    ndarray (m, K)
    """
    share, left = passage.shares
    leaving = motion.penetration_at(share) - points.height
    rise, bent = leaving - points.displacement, motion.bend * share**2 if motion.bend != 0.0 else 0.0
    at_release = pressed(chain, points.variables, rise, share * motion.duration, bent)
    load = load_inside(chain, at_release, leaving)
    y = (left * motion.duration)[:, None] / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (at_release @ chain.rotation.T)
    lags += even * chain.lag_rate * (new_load - load)[:, None]
    if motion.path is None:
        fall = -motion.singular * np.sqrt(points.radius - motion.new_edge)
        lags += (chain.spread_from_edge(y) - even) * chain.lag_rate * fall[:, None]
        lags += motion.lags_of_bend(chain, left)
    if motion.innermost is not None:
        lags += bend(chain, points, motion, share, np.ones_like(share))
    return lags @ chain.rotation


def free(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array) -> Array:
    """Variables of points outside all the time, without :func:`along_path`: the exact Voigt recursion.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    new_load : ndarray (m,)
        ``v`` at the end.

    Returns
    -------
    ndarray (m, K)
    """
    y = motion.duration / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (points.variables @ chain.rotation.T)
    lags += even * chain.lag_rate * (new_load - points.load)[:, None]
    if motion.path is None:
        before, after = points.radius - motion.edge, points.radius - motion.new_edge
        change = -motion.singular * (np.sqrt(after) - np.sqrt(before))
        weight = chain.spread_outside(np.broadcast_to(y, lags.shape), before[:, None], after[:, None])
        lags += (weight - even) * chain.lag_rate * change[:, None]
        lags += motion.lags_of_bend(chain, np.ones(1))
    if motion.innermost is not None:
        lags += bend(chain, points, motion, np.zeros(1), np.ones(1))
    return lags @ chain.rotation


def along_path(chain: Chain, points: SurfacePoints, motion: Motion, begin: Array) -> Array:
    """What the fall along the path of the edge adds to the variables of points outside at the end.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
        With a path.
    begin : ndarray (m,)
        Share of the step still to come when each is outside: from the start, or from its release.

    Returns
    -------
    ndarray (m, K)
    """
    recent = motion.recent(chain, points.radius, begin, np.zeros_like(begin))
    return motion.lags_of_fall(chain, recent) @ chain.rotation


def displacement_outside(chain: Chain, variables: Array, load: Array) -> Array:
    """``w = v/E0 - sum l``."""
    return load / chain.relaxed - chain.lag(variables @ chain.rotation.T)
