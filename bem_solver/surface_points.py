"""Surface points over one step, while the edge moves at constant speed from one radius to another.

A point is inside all the time, outside all the time, covered (outside, then inside) or released (inside, then
outside). Inside, displacement is linear in time and the Maxwell recursion exact. Outside, ``v`` is the sum of
the edge's own part, ``-singular * sqrt(distance to the moving edge)``, of a departure from a straight line in
time, and of a rest that is linear in time; the recursions are exact for all. The departure is that of ``v``
at the edge, or ahead of an edge that hardly moves, a parabola through an earlier row; without adhesion that
at a point inside all the time, near the edge, falling off as ``v``. So both sides of an edge at rest change
alike: a step between them would be read as a root by an edge that advances a little. Where a step passes over
process zones, the speed of the edge is not constant but that of its path (``bent_path``); ahead of an edge
that advances over them displacement is known as well (``free_creep``), and the Maxwell recursion serves. A
covered point meets the indenter at the moment the edge passes; a released one leaves it, glassy, then.
Displacement ``w``, load ``v`` and penetration are positive downwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.motion import Motion, RecentLags, SurfacePoints

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


class Passage(NamedTuple):
    """Shares (m,) of a step before and after an advancing edge passes points, and what the fall of the load
    leaves in them until then, where the edge has a path and no displacement is carried along."""

    share: Array
    left: Array
    recent: RecentLags | None

    @classmethod
    def of(cls, chain: Chain, points: SurfacePoints, motion: Motion) -> Passage:
        """The passage of points (m) in a motion."""
        share, left = motion.passing(points.radius)
        if motion.path is None or motion.carried is not None:
            return cls(share, left, None)
        return cls(share, left, motion.recent(chain, points.radius, np.ones_like(share), left))


def covered(chain: Chain, points: SurfacePoints, motion: Motion, passage: Passage | None = None) -> Array:
    """Variables of points that the advancing edge passes.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints
    motion : Motion
    passage : Passage, optional
        Of the points, where it is known.

    Returns
    -------
    ndarray (m, K)
    """
    passage = passage or Passage.of(chain, points, motion)
    share, left, _ = passage
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
    """Variables where the indenter is met, at a displacement ``meeting``, under a load of known course."""
    share = passage.share
    y = (share * motion.duration)[:, None] / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (points.variables @ chain.rotation.T)
    if motion.path is None:
        rise = motion.singular * np.sqrt(points.radius - motion.edge)
        lags += (chain.spread_to_edge(y) - even) * chain.lag_rate * rise[:, None]
        lags += motion.lags_of_bend(chain, share)
    else:
        recent = passage.recent or motion.recent(chain, points.radius, np.ones_like(share), passage.left)
        lags += motion.lags_of_fall(chain, recent)
    if motion.innermost is not None:
        lags += bend(chain, points, motion, np.zeros_like(share), share)
    # w = v/E0 - sum l at the moment of contact, with even * (v - v_n) still to come into l
    per_load = even @ chain.compliances
    load = (meeting + chain.lag(lags) - per_load * points.load) / (1.0 / chain.relaxed - per_load)
    lags += even * chain.lag_rate * (load - points.load)[:, None]
    return lags @ chain.rotation


def released(
    chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array, share: Array, left: Array
) -> Array:
    """Variables of points that the receding edge passes, without :func:`along_path`.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    new_load : ndarray (m,)
        ``v`` at the end.
    share, left : ndarray (m,)
        Of the step, before and after the edge passes each.

    Returns
    -------
    ndarray (m, K)
    """
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


def _kept(chain: Chain, points: SurfacePoints, motion: Motion) -> Array:
    """Variables of points inside all the time."""
    rise = motion.new_penetration - points.height - points.displacement
    return pressed(chain, points.variables, rise, motion.duration, motion.bend)


def advanced(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array | None) -> Array:
    """Variables of any points at the end of the step.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    new_load : ndarray (m,) or None
        ``v`` at the end, used outside the new edge only; ``None`` when all points are inside it.

    Returns
    -------
    ndarray (m, K)
    """
    inside_before, inside_after = points.radius <= motion.edge, points.radius <= motion.new_edge
    if motion.edge <= 0.0:
        inside_before[:] = False
    stays = inside_before & inside_after
    result = np.empty_like(points.variables)
    if inside_after.any():
        if stays.all():
            return _kept(chain, points, motion)
        if stays.any():
            result[stays] = _kept(chain, points[stays], motion)
        joins = inside_after & ~stays
        if joins.any():
            result[joins] = covered(chain, points[joins], motion)
    if new_load is None:
        return result
    leaves = inside_before & ~stays
    begin = np.ones(len(points))
    if leaves.any():
        some = points[leaves]
        share, left = motion.passing(some.radius)
        result[leaves] = released(chain, some, motion, new_load[leaves], share, left)
        begin[leaves] = left
    out = ~inside_before & ~inside_after
    if out.any():
        result[out] = free(chain, points[out], motion, new_load[out])
    if motion.path is not None:
        outside = ~inside_after
        result[outside] += along_path(chain, points[outside], motion, begin[outside])
    return result


@dataclass(frozen=True)
class PointsInside:
    """Points (m) inside the edge at the end of a motion whose load at the edge and penetration are sought.

    What does not depend on them is worked out once: where points are, and how the edge passes them.
    """

    chain: Chain
    points: SurfacePoints
    motion: Motion

    def variables(self, motion: Motion) -> Array:
        """As :func:`advanced`, (m, K), of this motion with another penetration, load at the edge or fall."""
        stays, joins, kept, joined = self._parts
        if joined is None or motion.carried is not self.motion.carried:
            return advanced(self.chain, self.points, motion, None)
        result = np.empty_like(self.points.variables)
        if kept is not None:
            result[stays] = self._kept(kept, motion)
        result[joins] = covered(self.chain, joined, motion, self._passage)
        return result

    @cached_property
    def _parts(
        self,
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], SurfacePoints | None, SurfacePoints | None]:
        """Numbers of the points that stay inside and of those that the edge passes, and the points."""
        points, motion = self.points, self.motion
        inside = points.radius <= motion.new_edge
        stays = (points.radius <= motion.edge) & inside if motion.edge > 0.0 else np.zeros_like(inside)
        joins = inside & ~stays
        kept, joined = (points[some] if some.any() else None for some in (stays, joins))
        return np.flatnonzero(stays), np.flatnonzero(joins), kept, joined

    @cached_property
    def _passage(self) -> Passage:
        joined = self._parts[3]
        if joined is None:
            raise ValueError("the edge passes no points")
        return Passage.of(self.chain, joined, self.motion)

    @cached_property
    def _kept_at(self) -> dict[float, Array]:
        return {}

    def _kept(self, points: SurfacePoints, motion: Motion) -> Array:
        """Variables of points inside all the time, which depend on the penetration alone."""
        depth = motion.new_penetration
        if depth not in self._kept_at:
            self._kept_at[depth] = _kept(self.chain, points, motion)
        return self._kept_at[depth]
