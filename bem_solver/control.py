"""What a run consists of between two trial steps, the error of a step, and the length of the next.

Steps adapt to how far edge and load depart from their extrapolations, and to a limit on the travel of the
edge, with rows close to what the loading and the largest tension ask for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from bem_solver.options import DEFAULT_RESOLUTION
from bem_solver.problem import Problem
from bem_solver.recorder import GradedRecord
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import HalfSpaceState
from bem_solver.trial import TrialContact
from contact_scene.run_control import LoadingInterval

_SAFETY = 0.9
"""Share of the step that the error model predicts to just meet the tolerance."""
_LARGEST_REDUCTION, _LARGEST_GROWTH = 0.2, 2.0
"""Bounds on the ratio of successive steps."""
SLIVER = 1e-9
"""Part of a step by which it may differ from another by rounding, and still is as long."""
SHARE_OF_WAY = 0.7
"""Share of the way of the edge to a limit point taken in one step: a tenth of the time is left after it, and
the place of that point is then known ten times as well."""
_MEMORY = 64
"""Accepted states that rates may reach back over."""


class AcceptedRow(NamedTuple):
    """Of an accepted state: parameter of its interval, edge, and load (force or penetration, the free one).

    ``edge_load`` is ``v`` at the edge, ``load_ahead`` that outside it, within the process zone.
    """

    parameter: float
    edge: float
    load: float
    edge_load: float = 0.0
    load_ahead: float = 0.0


_RESTS = 1e-13
"""Change of the load between rows, over the load, that is rounding of its sums (up to 1e-14 was seen): what
turns in it is no extremum, and steps towards one would halve for ever."""


@dataclass
class AcceptedSteps:
    """Accepted states of an interval.

    The extrapolation of the edge to the last of them has ``missed`` it by so much, over a ``travel``; both
    zero where there were too few. Travels below ``least`` may be no more than the inaccuracy of the edge.
    """

    rows: list[AcceptedRow] = field(default_factory=list)
    least: float = 0.0
    missed: float = 0.0
    travel: float = 0.0

    def add(self, row: AcceptedRow) -> None:
        """Add an accepted state."""
        self.missed = self.travel = 0.0
        if self.curved:
            last = self.rows[-1]
            self.missed = row.edge - self.edge_after(row.parameter - last.parameter)
            self.travel = row.edge - last.edge
        self.rows.append(row)
        del self.rows[:-_MEMORY]

    def start(self, row: AcceptedRow) -> None:
        """Begin after a kink or an instability, before which rates mean nothing."""
        self.rows, self.missed, self.travel = [row], 0.0, 0.0

    def continue_in_next_interval(self) -> None:
        """Count parameters from the last accepted state."""
        now = self.rows[-1].parameter
        self.rows = [row._replace(parameter=row.parameter - now) for row in self.rows]

    def earlier(self, least: float) -> AcceptedRow:
        """The latest row at least so long before the last, or else the first."""
        now = self.rows[-1].parameter
        far = (row for row in reversed(self.rows[:-1]) if now - row.parameter >= least)
        return next(far, self.rows[0])

    @property
    def curved(self) -> bool:
        """Whether there are rows enough for a parabola."""
        return len(self.rows) > 2

    @property
    def runs_away(self) -> bool:
        """Whether the parameter over the edge is nearer a parabola in the last rows than the edge over it."""
        times, edges = [row.parameter for row in self.rows[-4:]], [row.edge for row in self.rows[-4:]]
        travels = [later - earlier for earlier, later in pairwise(edges)]
        if len(travels) < 3 or min(travels) * max(travels) <= 0.0:
            return False
        of_time, of_edge = _missed(edges, times) / (times[1] - times[0]), _missed(times, edges) / travels[0]
        return of_time < abs(of_edge)

    def rates(self, step: float) -> tuple[float, float]:
        """Rates of edge and load over the accepted steps, as far back as ``step`` is long."""
        if len(self.rows) < 2:
            return 0.0, 0.0
        now, base = self.rows[-1], self.earlier((1.0 - SLIVER) * step)
        span = now.parameter - base.parameter
        return (now.edge - base.edge) / span, (now.load - base.load) / span

    def edge_after(self, step: float) -> float:
        """Edge a step ahead, extrapolated by the parabola through the last three states."""
        if len(self.rows) < 3:
            return self.rows[-1].edge + self.rates(step)[0] * step
        way = self.way_to_limit_point()
        if 0.0 < way < math.inf:
            share = 2.0 * step / (way * self._delay()[0])  # of the parameter left until there
            if share <= 1.0:
                travel = way * share / (1.0 + math.sqrt(1.0 - share))
                return self.rows[-1].edge + math.copysign(travel, self.rows[-1].edge - self.rows[-2].edge)
        (t0, a0, *_), (t1, a1, *_), (t2, a2, *_) = self.rows[-3:]
        late, early = (a2 - a1) / (t2 - t1), (a1 - a0) / (t1 - t0)
        return a2 + step * (late + (t2 - t1 + step) * (late - early) / (t2 - t0))

    def expected_edge(self, step: float) -> float:
        """Edge a step ahead, to begin a search with: extrapolated, and as far beside that as the last was."""
        edge = self.edge_after(step)
        if self.travel == 0.0:
            return edge
        share = min(abs((edge - self.rows[-1].edge) / self.travel), _LARGEST_GROWTH)
        return edge + share**3 * self.missed

    def _delay(self) -> tuple[float, float]:
        """Parameter per travel of the edge at the last state, and half its change with the travel."""
        if len(self.rows) < 4:
            return math.inf, math.inf
        steps = [(t1 - t0, a1 - a0) for (t0, a0, *_), (t1, a1, *_) in pairwise(self.rows[-4:])]
        travels = [travel for _, travel in steps]
        if not (min(travels) > 0.0 or max(travels) < 0.0) or max(map(abs, travels)) < self.least:
            return math.inf, math.inf
        first, early, late = (step / abs(travel) for step, travel in steps)
        if not first > early > late:
            return math.inf, math.inf
        bend = (late - early) / abs(travels[1] + travels[2])
        return late + bend * abs(travels[2]), bend

    def way_to_limit_point(self) -> float:
        """Distance of the edge from where it will run away; infinite if it does not run ever faster."""
        delay, bend = self._delay()
        return max(delay, 0.0) / (-2.0 * bend) if bend < 0.0 else math.inf

    def step_to_limit_point(self) -> float:
        """Parameter left until the edge runs away; infinite if it does not run ever faster."""
        way = self.way_to_limit_point()
        return 0.5 * way * self._delay()[0] if 0.0 < way < math.inf else math.inf

    def step_of_travel(self, travel: float) -> float:
        """Step in which an edge that runs ever faster travels so far; infinite for any other edge."""
        way = self.way_to_limit_point()
        if not 0.0 < way < math.inf:
            return math.inf
        delay, bend = self._delay()
        if way <= self.least:
            return -2.0 * bend * self.least**2  # twice the step to a limit point the least travel ahead
        travel = min(travel, SHARE_OF_WAY * way)
        return travel * (delay + bend * travel)

    def until_load_turns(self) -> float:
        """Distance from the last state to where the load turns, by the cubic through the last four states."""
        if len(self.rows) < 3:
            return math.inf
        (t0, _, f0, *_), (t1, _, f1, *_), (t2, _, f2, *_) = self.rows[-3:]
        if max(abs(f2 - f1), abs(f1 - f0)) <= _RESTS * abs(f2):
            return math.inf
        late, early = (f2 - f1) / (t2 - t1), (f1 - f0) / (t1 - t0)
        curvature, third, h, k = (late - early) / (t2 - t0), 0.0, t2 - t1, t2 - t0
        if len(self.rows) > 3:
            t, _, f, *_ = self.rows[-4]
            third = (curvature - (early - (f0 - f) / (t0 - t)) / (t1 - t)) / (t2 - t)
        slope, bend = late + h * (curvature + third * k), 2.0 * (curvature + third * (h + k))
        square = bend**2 - 12.0 * slope * third
        if bend * curvature <= 0.0 or square < 0.0:  # it turns nowhere near
            return math.inf
        return -2.0 * slope / (bend + math.copysign(math.sqrt(square), bend))


def _missed(x: list[float], y: list[float]) -> float:
    """By how much the parabola through the last three of four points misses the first."""
    early, late = (y[2] - y[1]) / (x[2] - x[1]), (y[3] - y[2]) / (x[3] - x[2])
    bend = (late - early) / (x[3] - x[1])
    return abs(y[3] - y[0] + (x[0] - x[3]) * (late + (x[0] - x[2]) * bend))


def departure_from_line(extrapolation_error: float, scale: float) -> float:
    """Departure from a straight line in the middle of a step, relative to ``scale``."""
    return 0.125 * abs(extrapolation_error) / scale if scale > 0.0 else 0.0


def grown(step: float, error: float, order: int = 2) -> float:
    """Next step after one accepted with ``error`` (in tolerances) that grows as ``step**order``."""
    if error <= 0.0:
        return step * _LARGEST_GROWTH
    return step * max(_LARGEST_REDUCTION, min(_LARGEST_GROWTH, _SAFETY / error ** (1.0 / order)))


def shrunk(step: float, error: float, order: int = 2) -> float:
    """Next trial after one rejected with ``error`` > 1 that grows as ``step**order``."""
    return step * max(_LARGEST_REDUCTION, _SAFETY / error ** (1.0 / order))


_SMALLEST_TRAVEL_SHARES = 1.0 / 64.0, 1.0 / 16.0
"""Shares of the travel limit: an edge that passes even this at constant load moves unstably."""
_ROUNDING_AT_FOLD = 3e-5
"""Contact radius, relative, to which a limit point is told from rounding: there the edge moves by the root of
what the load does, of which up to 1e-9 is lost in the sums over annuli and states."""
_ROUNDINGS_OF_TIME = 4.0
"""Shortest step, in roundings of time: an edge that is not resolved in it has leapt, over an annulus, say."""


@dataclass
class GradedState:
    """State of a run on graded annuli.

    In the present loading interval the run has reached ``parameter``, with the ``accepted`` states from which
    rates are extrapolated. ``step`` is that to try next before it is limited, ``travel_share`` the share of
    the travel limit in force, ``slope`` the derivative of the residual with the edge expected in the next
    step (0: unknown), ``last_slope`` that in the last. ``sought_limit_point``: no step from here ends on one.
    """

    contact: HalfSpaceState
    record: GradedRecord
    largest_force: float
    largest_edge: float
    largest_tension: float = 0.0
    parameter: float = 0.0
    accepted: AcceptedSteps = field(default_factory=AcceptedSteps)
    step: float = 0.0
    travel_share: float = 1.0
    slope: float = 0.0
    last_slope: float = 0.0
    sought_limit_point: bool = False


@dataclass(frozen=True)
class StepStart:
    """Where a step starts: problem, committed state, and the interval of the loading it lies in."""

    problem: Problem
    state: GradedState
    interval: LoadingInterval

    @property
    def shortest_step(self) -> float:
        """Step within which rounding of the parameter leaves nothing to be told apart."""
        return _ROUNDINGS_OF_TIME * math.ulp(1.0 if self.interval.jump else self.interval.end)

    def reach(self, advancing: bool) -> float:
        """Travel limit of the edge in one step."""
        longest = self.problem.longest_travel(self.state.contact.edge, advancing)
        return self.state.travel_share * longest / self.problem.divisions

    @property
    def smallest_travel(self) -> float:
        """Travel at constant load from which on an edge moves unstably; limit points are located to it."""
        edge, divisions = self.state.contact.edge, self.problem.divisions
        limit = longest = self.problem.length_at(edge) / divisions
        if self.problem.over_zones(edge):
            longest = self.problem.longest_travel(edge, advancing=False) / divisions
        least, most = _SMALLEST_TRAVEL_SHARES
        return min(max(_ROUNDING_AT_FOLD * edge, least * limit), most * longest)


_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_ROUNDINGS = 4.0
"""Last places by which a prescribed value may miss its chord by rounding: as many operations make it."""
_BENT_SHARE_OF_ZONE = 0.04
"""Travel of a step, in process zones, from which on its path is a parabola through another row and it is
judged by that: a quarter of the longest step within a zone at the default resolution, and at finer ones that
quarter, too. Below it an edge sets out or turns, and earlier rows tell little; steady steps are longer."""
_SHARE_OF_TRAVEL = 2.0
"""Error of extrapolating the edge that is allowed, in step tolerances of its travel: the speed of the edge,
on which the closure depends, is then met to less than half as much. Within a zone the closure depends on
the place of the edge, too."""
_SHARE_OF_FREE_TRAVEL = 0.5
"""The same within a zone under a controlled force: no prescribed penetration holds the edge back there, and
the errors of its speed add up to one of the time at which contact is lost."""
_LEAST_SHARE_OF_ZONE = 0.5
"""Least travel for that, in process zones: the closure sees no less of the path than about as much."""
_LEAST_SHARE_OF_RADIUS = 1e-3
"""Least travel for that of an edge that passes over zones, in contact radii: an edge that misses its place by
that part of a tolerance changes the force by three times as much. The annuli it passes leave it uneven by
millionths of the radius, and no shorter step is more even."""
_SHARE_OF_WORK = 0.2
"""Change of the closure that is allowed over the error of extrapolating an edge that may pass over zones, in
step tolerances of the work of adhesion, where that is more than the travel allows: a closure that hardly
changes with the place of the edge tells it no closer, and shorter steps follow its unevenness."""
_MOST_SHARE_OF_RADIUS = 1e-2
"""Upper bound on that error as on that of a step over this part of the contact radius: where the closure is
level, as at a limit point, the force is to be right still."""
_LOAD_WEIGHT = 4.0
"""Weight of the departure of the load from a straight line against that of the edge in the step error."""
_RATED_WEIGHT = 5.0
"""Weight of the departure from a straight line relative to the length the edge is resolved on against that
relative to its travel, where the speed counts, of an opening edge: it may then change its speed by a sixth in
a step."""
_LEAST_RATED_TRAVEL = 1e-4
"""Least travel for that, in contact radii: below it an edge is about to set out."""


@lru_cache(maxsize=8)
def span(interval: LoadingInterval) -> float:
    """By how much the prescribed quantity varies over the interval."""
    values = [interval.prescribed(interval.length * (k * _GOLDEN % 1.0)) for k in range(32)]
    values.append(interval.prescribed(interval.length))
    return max(values) - min(values)


def departure_from_chord(interval: LoadingInterval, parameter: float, step: float) -> float:
    """Largest departure of the prescribed quantity from its chord over a step, in spans, beyond rounding.

    Sampled at irrational shares of the step, where an oscillation has no equal phases.
    """
    if span(interval) == 0.0:
        return 0.0
    first, last = interval.prescribed(parameter), interval.prescribed(parameter + step)
    departure = max(
        abs(interval.prescribed(parameter + share * step) - first - share * (last - first))
        for share in (math.sqrt(2.0) - 1.0, _GOLDEN, math.e - 2.0)
    )
    rounding = _ROUNDINGS * math.ulp(max(abs(first), abs(last)))
    return max(departure - rounding, 0.0) / span(interval)


def free_load(interval: LoadingInterval, penetration: float, surface: ContactSurface) -> float:
    """The quantity that is not prescribed: penetration under a controlled force, otherwise the force."""
    return penetration if interval.control == "force" else surface.force


def least_bent_travel(start: StepStart, edge: float) -> float:
    """Travel of a step from which on the path of an edge is a parabola."""
    finer = min(1.0, DEFAULT_RESOLUTION / start.problem.divisions)
    return _BENT_SHARE_OF_ZONE * finer * start.problem.length_at(edge)


def step_error(start: StepStart, trial: TrialContact, step: float, slope: float = 0.0) -> float:
    """Departure of edge and load from lines of their rates so far, in tolerances."""
    problem, interval, contact = start.problem, start.interval, start.state.contact
    (edge_rate, load_rate), edge = start.state.accepted.rates(step), trial.motion.new_edge
    missed = edge - contact.edge - edge_rate * step
    of_edge = departure_from_line(missed, problem.length_at(edge))
    if problem.rated and edge < contact.edge:
        travel = max(abs(edge - contact.edge), _LEAST_RATED_TRAVEL * contact.edge)
        of_edge = max(of_edge, departure_from_line(missed, _RATED_WEIGHT * travel))
    passes = abs(edge - contact.edge) >= least_bent_travel(start, edge)
    if passes and problem.curves and start.state.accepted.curved:
        of_path = _departure_from_path(start, edge, step)
        of_edge = min(of_edge, of_path) if problem.over_zones(contact.edge) else of_path
    if problem.over_zones(contact.edge) and not problem.rated:  # a rated edge is told by its speed
        if start.state.accepted.curved:
            missed = edge - start.state.accepted.edge_after(step)
        of_edge = min(of_edge, _departure_of_closure(start, edge, abs(missed), slope))
    rise = free_load(interval, trial.motion.new_penetration, trial.surface)
    rise -= free_load(interval, contact.penetration, contact.surface)
    of_load = departure_from_line(rise - load_rate * step, _load_scale(start, trial.surface, step))
    return max(of_edge, _LOAD_WEIGHT * of_load) / problem.tolerance


def _load_scale(start: StepStart, surface: ContactSurface, step: float) -> float:
    """What the departure of the free load is measured against: a force of the run, or what it moves."""
    problem, force = start.problem, max(start.state.largest_force, abs(surface.force))
    if problem.curves:
        tip = math.sqrt(8.0 * math.pi * problem.work * problem.chain.relaxed * surface.edge**3)
        opens = surface.edge < start.state.contact.edge  # behind a closing edge it may be a thin layer's
        singular = min(abs(2.0 * surface.edge * surface.kappa), math.inf if opens else tip)
        force = min(force, max(abs(surface.force), singular))
    if start.interval.control != "force" or surface.edge == 0.0:
        return force
    stiffness = problem.body.within(surface.edge).response(problem.annuli, surface.edge).stiffness
    return force / (2.0 * surface.edge * stiffness * problem.chain.modulus_of_ramp(step))


def _departure_of_closure(start: StepStart, edge: float, missed: float, slope: float) -> float:
    """Change of the closure over the error of extrapolating the edge, relative to what is allowed."""
    problem = start.problem
    slope = slope or start.state.last_slope
    if slope <= 0.0:
        return math.inf
    of_radius = missed / (_SHARE_OF_TRAVEL * _MOST_SHARE_OF_RADIUS * edge)
    return max(of_radius, slope * missed / (_SHARE_OF_WORK * problem.work))


def _departure_from_path(start: StepStart, edge: float, step: float) -> float:
    """Error of extrapolating the path of the edge to the end of a step, relative to what is allowed."""
    travel = abs(edge - start.state.contact.edge)
    passed = travel > start.problem.zone
    travel = max(
        travel, _LEAST_SHARE_OF_RADIUS * edge if passed else _LEAST_SHARE_OF_ZONE * start.problem.zone
    )
    missed = abs(edge - start.state.accepted.edge_after(step))
    free = start.interval.control == "force" and not start.problem.over_zones(start.state.contact.edge)
    share = _SHARE_OF_FREE_TRAVEL if free else _SHARE_OF_TRAVEL
    advancing = edge > start.state.contact.edge
    allowed = min(share * travel, start.problem.longest_travel(edge, advancing))
    return missed / allowed if allowed > 0.0 else math.inf


_TRAVEL_ITERATIONS = 3
"""Corrections of a step by the travel to be expected in it: the expected travel is nearly in proportion."""
_BESIDE_EXTREMUM = 0.125
"""Distance of the rows on both sides of the largest tension, in steps: what lies between them exceeds the row
by a sixty-fourth of what it would with the whole step."""
_STEP_PLACES = 20
"""Binary places of a step: a millionth of it is far below what any error says of it, and far above what
rounding makes of that error, which would grow from step to step."""


def limited_step(start: StepStart) -> tuple[float, float]:
    """Step size to start from next time, and the step to try."""
    state, interval = start.state, start.interval
    advancing = state.accepted.rates(0.0)[0] > 0.0
    limited, parameter = state.step, state.parameter
    limited = _step_within(start, limited, 0.9 * start.reach(advancing))
    limited = _rounded(limited / interval.length) * interval.length  # alike in all units
    left = interval.length - parameter
    limited = min(limited, left)
    while (departure := departure_from_chord(interval, parameter, limited) / start.problem.tolerance) > 1.0:
        limited = shrunk(limited, departure)
    if limited >= left * (1.0 - SLIVER):
        step = left
    else:
        step = min(limited, 0.5 * left) if 2.0 * limited > left else limited
    step = min(step, until_largest_tension(start, limited))
    return limited, max(step, min(start.shortest_step, left))


def _rounded(step: float) -> float:
    """The step to so few binary places that what rounding has made of it is gone from it, all but rarely."""
    if not 0.0 < step < math.inf:
        return step
    mantissa, exponent = math.frexp(step)
    return math.ldexp(round(math.ldexp(mantissa, _STEP_PLACES)), exponent - _STEP_PLACES)


def _step_within(start: StepStart, step: float, limit: float) -> float:
    """The step, or a shorter one in which the edge is expected to travel no farther than ``limit``."""
    accepted, edge = start.state.accepted, start.state.contact.edge
    if start.problem.work == 0.0:  # no limit point ahead
        speed = abs(accepted.rates(step)[0])
        return limit / speed if speed * step > limit else step
    step = min(step, accepted.step_of_travel(limit))
    for _ in range(_TRAVEL_ITERATIONS):
        linear = abs(accepted.rates(step)[0]) * step
        travel = max(linear, abs(accepted.edge_after(step) - edge))
        if travel > limit:
            step *= limit / travel
    return step


def _pulls_hardest(start: StepStart) -> bool:
    """Whether the force, which is not given, is the largest tension of the run so far."""
    tension = -start.state.contact.surface.force
    return start.interval.control != "force" and tension > 0.0 and tension >= start.state.largest_tension


def until_largest_tension(start: StepStart, step: float) -> float:
    """The longest step that leaves rows close before, at and close after the largest tension of the run."""
    if not _pulls_hardest(start):
        return math.inf
    near = _BESIDE_EXTREMUM * step
    distance = start.state.accepted.until_load_turns()
    if not -1.5 * near < distance < step + near:
        return math.inf
    if distance > 1.5 * near:
        return distance - near
    return distance if distance > 0.5 * near else near  # from near before it, it is known better


def short_of_largest_tension(start: StepStart, trial: TrialContact, parameter: float) -> float:
    """The step to close before the largest tension of the run, if the one tried passes it far off; else 0.

    Where slopes bend the last rows have not told where the load would turn; with the trial they do. Steps
    that are short because it is near may pass it.
    """
    state, taken = start.state, parameter - start.state.parameter
    near = _BESIDE_EXTREMUM * taken
    if not _pulls_hardest(start) or taken <= 1.5 * _BESIDE_EXTREMUM * state.step:
        return 0.0
    row = AcceptedRow(parameter, trial.motion.new_edge, trial.surface.force)
    turn = taken + AcceptedSteps([*state.accepted.rows, row]).until_load_turns()
    return turn - near if 1.5 * near < turn < taken - 1.5 * near else 0.0
