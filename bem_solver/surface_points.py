"""Surface points over one step, and the committed state they begin with.

A point is inside all the time, outside all the time, covered (outside, then inside: it meets the indenter at
the moment the edge passes) or released (it leaves it, glassy, then). Inside, displacement is a parabola in
time and the Maxwell recursion exact. Outside, ``v`` is the sum of the edge's own part, a root or a fall
along its path; of a bend in time, that of ``v`` at the edge or ahead of one that hardly moves, and without
adhesion that at a point inside all the time, falling off as ``v``; and of a rest that is linear in time.
Ahead of an edge that advances over zones displacement is known (``FreeCreep``): the Maxwell recursion serves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.history import NodalVariables, SurfaceHistory
from bem_solver.motion import Motion, Passage, SurfacePoints
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]


def pressed(
    chain: Chain, variables: Array, rise: Array, duration: float | Array, bend: float | Array = 0.0
) -> Array:
    """Variables of points in contact while ``w`` follows a parabola: the exact Maxwell recursion."""
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
    return chain.relaxed * displacement + variables @ chain.stress_scale


def bend(chain: Chain, points: SurfacePoints, motion: Motion, first: Array, last: Array) -> Array:
    """Scaled lags at a share of the step beyond those under a load that is linear since an earlier share."""
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
    """Variables of points that the advancing edge passes."""
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
    lags += motion.lags_of_fall(chain, passage.recent)
    if motion.innermost is not None:
        lags += bend(chain, points, motion, np.zeros_like(share), share)
    # w = v/E0 - sum l at the moment of contact, with even * (v - v_n) still to come into l
    per_load = even @ chain.compliances
    load = (meeting + lags @ chain.lag_scale - per_load * points.load) / (1.0 / chain.relaxed - per_load)
    lags += even * chain.lag_rate * (load - points.load)[:, None]
    return lags @ chain.rotation


def released(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array, passage: Passage) -> Array:
    """Variables of points that the receding edge passes, without :func:`along_path`."""
    share, left = passage.shares
    leaving = motion.penetration_at(share) - points.height
    rise, bent = leaving - points.displacement, motion.bend * share**2 if motion.bend != 0.0 else 0.0
    at_release = pressed(chain, points.variables, rise, share * motion.duration, bent)
    load = load_inside(chain, at_release, leaving)
    y = (left * motion.duration)[:, None] / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (at_release @ chain.rotation.T)
    lags += even * chain.lag_rate * (new_load - load)[:, None]
    if motion.innermost is not None:
        lags += bend(chain, points, motion, share, np.ones_like(share))
    return lags @ chain.rotation


def free(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array) -> Array:
    """Variables of points outside all the time, without :func:`along_path`: the exact Voigt recursion."""
    y = motion.duration / chain.retardation
    even = chain.spread(y)
    lags = chain.decay(y) * (points.variables @ chain.rotation.T)
    lags += even * chain.lag_rate * (new_load - points.load)[:, None]
    if motion.innermost is not None:
        lags += bend(chain, points, motion, np.zeros(1), np.ones(1))
    return lags @ chain.rotation


def along_path(chain: Chain, points: SurfacePoints, motion: Motion, begin: Array) -> Array:
    """What the load near the edge, beyond an even change, adds to variables of points outside at the end."""
    if motion.new_edge == motion.edge:
        return motion.lags_of_bend(chain) @ chain.rotation
    recent = motion.recent(chain, points.radius, begin, np.zeros_like(begin))
    return motion.lags_of_fall(chain, recent) @ chain.rotation


def displacement_outside(chain: Chain, variables: Array, load: Array) -> Array:
    """``w = v/E0 - sum l``."""
    return load / chain.relaxed - variables @ chain.rotation.T @ chain.lag_scale


def advanced(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array | None) -> Array:
    """Variables of any points at the end of the step."""
    by_passage = PointsByPassage(chain, points, motion)
    variables = by_passage.inside(motion)
    if new_load is not None:
        by_passage.fill_outside(variables, new_load)
    return variables


class PointsByPassage:
    """Surface points (m), sorted by how a motion of the edge passes them."""

    def __init__(self, chain: Chain, points: SurfacePoints, motion: Motion) -> None:
        self.chain, self.points, self.motion = chain, points, motion
        before = points.radius <= motion.edge if motion.edge > 0.0 else np.zeros(len(points), bool)
        self.after = points.radius <= motion.new_edge
        self.stay, self.covered, self.leave = before & self.after, self.after & ~before, before & ~self.after
        self.staying, self.to_cover = points[self.stay], points[self.covered]
        self.passage = Passage(chain, self.to_cover.radius, motion)

    def inside(self, motion: Motion) -> Array:
        """Variables at the end of a motion of the same edge; those of points outside it are not filled."""
        variables = np.empty_like(self.points.variables)
        if len(self.staying):
            points = self.staying
            rise = motion.new_penetration - points.height - points.displacement
            variables[self.stay] = pressed(self.chain, points.variables, rise, motion.duration, motion.bend)
        if len(self.to_cover):
            variables[self.covered] = covered(self.chain, self.to_cover, motion, self.passage)
        return variables

    def fill_outside(self, variables: Array, new_load: Array) -> None:
        """Fill in those of points outside the edge at the end of its motion."""
        chain, motion, beyond = self.chain, self.motion, ~self.after
        out, begin = beyond & ~self.leave, np.ones(len(self.points))
        if self.leave.any():
            points = self.points[self.leave]
            passage = Passage(chain, points.radius, motion)
            variables[self.leave] = released(chain, points, motion, new_load[self.leave], passage)
            _, begin[self.leave] = passage.shares
        if out.any():
            variables[out] = free(chain, self.points[out], motion, new_load[out])
        if beyond.any():
            variables[beyond] += along_path(chain, self.points[beyond], motion, begin[beyond])


@dataclass(frozen=True)
class HalfSpaceState:
    """Committed state: the surface, its history, time and penetration.

    ``last_step`` (duration, first edge) led here, ``None`` after a kink; known of an irreversible adhesion.
    ``branch_work`` (K,) is ``int p e_k``, ``tip_release`` the glassy energy release rate of the tip.
    """

    time: float
    penetration: float
    surface: ContactSurface
    history: SurfaceHistory
    closure: float = 0.0
    last_step: tuple[float, float] | None = None
    branch_work: Array | float = 0.0
    tip_release: float = 0.0

    @property
    def edge(self) -> float:
        """Contact radius."""
        return self.surface.edge


def points_at(problem: Problem, state: HalfSpaceState, radius: Array) -> SurfacePoints:
    """State of surface points at the start of a step."""
    height = problem.scene.indenter.height(radius)
    inside = radius <= state.edge if state.edge > 0.0 else np.zeros(len(radius), bool)
    chain, outside, displacement = problem.chain, ~inside, state.penetration - height
    variables, load = np.empty((len(radius), len(chain))), np.empty(len(radius))
    if inside.any():
        variables[inside] = state.history.inner.at(radius[inside])
        load[inside] = load_inside(chain, variables[inside], displacement[inside])
    if outside.any():
        load[outside] = state.surface.outside(radius[outside])
        variables[outside] = chain.from_strains(state.history.outside(radius[outside]), load[outside])
        displacement[outside] = displacement_outside(chain, variables[outside], load[outside])
    return SurfacePoints(radius, height, variables, load, displacement)


def split_at_edge(
    chain: Chain,
    radius: Array,
    variables: Array,
    load: Array,
    edge: float,
    displacement: float,
    kinks: tuple[float, ...] = (),
) -> tuple[NodalVariables, NodalVariables]:
    """Nodal variables inside and outside the edge."""
    inside, outside = radius <= edge, radius >= edge
    beyond = load[outside]
    beyond[0] = load_inside(chain, variables[outside][:1], np.array([displacement]))[0]
    strains = chain.to_strains(variables[outside], beyond)
    inner = NodalVariables(radius[inside], variables[inside], tuple(k for k in kinks if k < edge))
    return inner, NodalVariables(radius[outside], strains, (edge, *(k for k in kinks if k > edge)))
