"""Surface points over one step, and the committed state they begin with.

A point is inside all the time, outside all the time, covered (outside, then inside) or released (inside,
then outside). Inside, displacement is linear in time and the Maxwell recursion exact. Outside, ``v`` is the
sum of the edge's own part, ``-singular * sqrt(distance to the moving edge)`` or a fall along its path, of a
departure from a straight line in time, and of a rest that is linear in time; the recursions are exact for
all. The departure is that of ``v`` at the edge, or ahead of an edge that hardly moves, a parabola through an
earlier row; without adhesion that at a point inside all the time, near the edge, falling off as ``v``. Ahead
of an edge that advances over zones displacement is known (``FreeCreep``), and the Maxwell recursion serves.
A covered point meets the indenter at the moment the edge passes; a released one leaves it, glassy, then.
Displacement ``w``, load ``v`` and penetration are positive downwards, force and pressure in compression.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.edge_energy import EdgeStep
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
    return chain.relaxed * displacement + chain.stress(variables)


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
    if motion.path is None:
        fall = -motion.singular * np.sqrt(points.radius - motion.new_edge)
        lags += (chain.spread_from_edge(y) - even) * chain.lag_rate * fall[:, None]
        lags += motion.lags_of_bend(chain, left)
    if motion.innermost is not None:
        lags += bend(chain, points, motion, share, np.ones_like(share))
    return lags @ chain.rotation


def free(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array) -> Array:
    """Variables of points outside all the time, without :func:`along_path`: the exact Voigt recursion."""
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
    """What the fall along the path of the edge adds to the variables of points outside at the end."""
    recent = motion.recent(chain, points.radius, begin, np.zeros_like(begin))
    return motion.lags_of_fall(chain, recent) @ chain.rotation


def displacement_outside(chain: Chain, variables: Array, load: Array) -> Array:
    """``w = v/E0 - sum l``."""
    return load / chain.relaxed - chain.lag(variables @ chain.rotation.T)


Mask = NDArray[np.bool_]


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
        self.after: Mask = points.radius <= motion.new_edge
        self.stay, self.covered, self.leave = before & self.after, self.after & ~before, before & ~self.after
        self.staying, self.to_cover = points[self.stay], points[self.covered]
        self.passage = Passage(chain, self.to_cover.radius, motion)
        self.pressed_to: dict[float, Array] = {}

    def inside(self, motion: Motion) -> Array:
        """Variables at the end of a motion of the same edge; those of points outside it are not filled."""
        variables = np.empty_like(self.points.variables)
        if len(self.staying):
            variables[self.stay] = self._pressed(motion)
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
        if motion.path is not None:
            variables[beyond] += along_path(chain, self.points[beyond], motion, begin[beyond])

    def _pressed(self, motion: Motion) -> Array:
        """Variables of points inside all the time, which depend on the penetration alone."""
        depth, points = motion.new_penetration, self.staying
        if depth not in self.pressed_to:
            rise = depth - points.height - points.displacement
            self.pressed_to[depth] = pressed(self.chain, points.variables, rise, motion.duration, motion.bend)
        return self.pressed_to[depth]


@dataclass(frozen=True)
class HalfSpaceState:
    """Committed state: the surface, its history, time and penetration.

    ``closure`` is the integral of the edge, and ``last_step`` the step of it that led here, ``None`` after a
    kink: known where adhesion is irreversible. ``branch_work`` (K,) is ``int p e_k``, and ``tip_release`` the
    glassy energy release rate of the tip, the way it has gone.
    """

    time: float
    penetration: float
    surface: ContactSurface
    history: SurfaceHistory
    closure: float = 0.0
    last_step: EdgeStep | None = None
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
    if inside.all():
        return SurfacePoints(radius, height, *_inside(problem, state, radius, height))
    if not inside.any():
        return SurfacePoints(radius, height, *_outside(problem, state, radius))
    variables = np.empty((len(radius), len(problem.chain)))
    load, displacement, outside = np.empty(len(radius)), np.empty(len(radius)), ~inside
    variables[inside], load[inside], displacement[inside] = _inside(
        problem, state, radius[inside], height[inside]
    )
    variables[outside], load[outside], displacement[outside] = _outside(problem, state, radius[outside])
    return SurfacePoints(radius, height, variables, load, displacement)


def _inside(
    problem: Problem, state: HalfSpaceState, radius: Array, height: Array
) -> tuple[Array, Array, Array]:
    """Variables, load and displacement of points in contact."""
    displacement = state.penetration - height
    variables = state.history.inner.at(radius)
    return variables, load_inside(problem.chain, variables, displacement), displacement


def _outside(problem: Problem, state: HalfSpaceState, radius: Array) -> tuple[Array, Array, Array]:
    """Variables, load and displacement of points outside the contact."""
    chain, load = problem.chain, state.surface.outside(radius)
    variables = chain.from_strains(state.history.outside(radius), load)
    return variables, load, displacement_outside(chain, variables, load)


def split_at_edge(
    chain: Chain,
    radius: Array,
    variables: Array,
    load: Array,
    edge: float,
    displacement: float,
    kinks: tuple[float, ...] = (),
    rest: float | None = None,
) -> tuple[NodalVariables, NodalVariables]:
    """Nodal variables inside and outside the edge."""
    inside, outside = radius <= edge, radius >= edge
    beyond = load[outside]
    beyond[0] = load_inside(chain, variables[outside][:1], np.array([displacement]))[0]
    strains = chain.to_strains(variables[outside], beyond)
    inner = NodalVariables(radius[inside], variables[inside], tuple(k for k in kinks if k < edge))
    return inner, NodalVariables(radius[outside], strains, (edge, *(k for k in kinks if k > edge)), rest)
