"""Step-size control: rates from accepted steps, the step to try, departure from straight lines.

Steps adapt to how far edge and load depart from straight lines within them, and to a limit on the travel of
the edge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

_SAFETY = 0.9
"""Share of the step that the error model predicts to just meet the tolerance."""
_LARGEST_REDUCTION, _LARGEST_GROWTH = 0.2, 2.0
"""Bounds on the ratio of successive steps."""
_SLIVER = 1e-9
"""Part of a step by which it may differ from another by rounding, and still is as long."""
SHARE_OF_WAY = 0.7
"""Share of the way of the edge to a limit point taken in one step: a tenth of the time is left after it, and
the place of that point is then known ten times as well."""
_NEWTON_STEPS = 3
"""From the turn of a parabola to that of a cubic: each squares the relative error."""
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
        """The latest row at least so long before the last, or else the first.

        A parabola through rows much closer together than the step to come magnifies what they miss.
        """
        now = self.rows[-1].parameter
        far = (row for row in reversed(self.rows[:-1]) if now - row.parameter >= least)
        return next(far, self.rows[0])

    @property
    def curved(self) -> bool:
        """Whether there are rows enough for a parabola."""
        return len(self.rows) > 2

    @property
    def time_is_smoother(self) -> bool:
        """Whether a parabola of the parameter over the edge meets the last rows better than one of the edge.

        By how closely those through the last three states meet the one before. So it is before a limit point,
        where the edge runs away, and after a start with a leap; not where the edge sets out from rest.
        """
        if len(self.rows) < 4:
            return False
        rows = self.rows[-4:]
        travels = [later.edge - earlier.edge for earlier, later in pairwise(rows)]
        if not (min(travels) > 0.0 or max(travels) < 0.0):
            return False
        times = [row.parameter - rows[-1].parameter for row in rows]
        edges = [row.edge - rows[-1].edge for row in rows]
        of_time, of_edge = _missed(edges, times) / (times[1] - times[0]), _missed(times, edges) / travels[0]
        return of_time < abs(of_edge)

    def rates(self, step: float) -> tuple[float, float]:
        """Rates of edge and load over the accepted steps, as far back as ``step`` is long.

        A shorter interval would magnify the small unevenness with which the edge passes the annuli.
        """
        if len(self.rows) < 2:
            return 0.0, 0.0
        now, least = self.rows[-1], (1.0 - _SLIVER) * step
        earlier = (row for row in reversed(self.rows[:-1]) if now.parameter - row.parameter >= least)
        base = next(earlier, self.rows[0])
        span = now.parameter - base.parameter
        return (now.edge - base.edge) / span, (now.load - base.load) / span

    def edge_after(self, step: float) -> float:
        """Edge a step ahead, extrapolated by the parabola through the last three states.

        Before a limit point by that of the parameter over the edge.
        """
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
        """Edge a step ahead, to begin a search with: extrapolated, and as far beside that as the last was.

        What a parabola misses grows with the cube of the travel.
        """
        edge = self.edge_after(step)
        if self.travel == 0.0:
            return edge
        share = min(abs((edge - self.rows[-1].edge) / self.travel), _LARGEST_GROWTH)
        return edge + share**3 * self.missed

    def _delay(self) -> tuple[float, float]:
        """Parameter per travel of the edge at the last state, and half its change with the travel.

        By the parabola of the parameter over the edge, which is smooth where the edge runs away; both
        infinite unless the edge has run ever faster over the last four states, and farther than the least.
        """
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
        """Step in which an edge that runs ever faster travels so far; infinite for any other edge.

        With a limit point ahead, no farther than a share of the way to it; over it, for a trial that shows
        whether it is there, if the way is no longer than the least travel, to which its end is known.
        """
        way = self.way_to_limit_point()
        if not 0.0 < way < math.inf:
            return math.inf
        delay, bend = self._delay()
        if way <= self.least:
            return -2.0 * bend * self.least**2  # twice the step to a limit point the least travel ahead
        travel = min(travel, SHARE_OF_WAY * way)
        return travel * (delay + bend * travel)

    def until_load_turns(self) -> float:
        """Distance from the last state to where the load turns, by the cubic through the last four states.

        By the parabola through three if there are no more. Negative if it has turned, infinite if never.
        """
        if len(self.rows) < 3:
            return math.inf
        (t0, _, f0, *_), (t1, _, f1, *_), (t2, _, f2, *_) = self.rows[-3:]
        late, early = (f2 - f1) / (t2 - t1), (f1 - f0) / (t1 - t0)
        curvature = (late - early) / (t2 - t0)
        if curvature == 0.0:
            return math.inf
        turn = -0.5 * (late / curvature + t2 - t1)
        if len(self.rows) == 3:
            return turn
        before, _, first, *_ = self.rows[-4]
        third = (curvature - (early - (f0 - first) / (t0 - before)) / (t1 - before)) / (t2 - before)
        sides = (t2 - t1, t2 - t0)
        for _ in range(_NEWTON_STEPS):
            slope = late + curvature * (2.0 * turn + sides[0])
            slope += third * (3.0 * turn**2 + 2.0 * turn * sum(sides) + sides[0] * sides[1])
            bend = 2.0 * curvature + third * (6.0 * turn + 2.0 * sum(sides))
            if bend * curvature <= 0.0:  # the cubic turns nowhere near
                return math.inf
            turn -= slope / bend
        return turn


def _missed(x: list[float], y: list[float]) -> float:
    """By how much the parabola through the last three of four points misses the first."""
    early, late = (y[2] - y[1]) / (x[2] - x[1]), (y[3] - y[2]) / (x[3] - x[2])
    bend = (late - early) / (x[3] - x[1])
    return abs(y[3] + (x[0] - x[3]) * (late + (x[0] - x[2]) * bend) - y[0])


def departure_from_line(extrapolation_error: float, scale: float) -> float:
    """Departure from a straight line in the middle of a step, relative to ``scale``.

    An eighth of the error of extrapolating the line to the end of the step.
    """
    return 0.125 * abs(extrapolation_error) / scale if scale > 0.0 else 0.0


def grown(step: float, error: float, order: int = 2) -> float:
    """Next step after one accepted with ``error`` (in tolerances) that grows as ``step**order``."""
    if error <= 0.0:
        return step * _LARGEST_GROWTH
    return step * max(_LARGEST_REDUCTION, min(_LARGEST_GROWTH, _SAFETY / error ** (1.0 / order)))


def shrunk(step: float, error: float, order: int = 2) -> float:
    """Next trial after one rejected with ``error`` > 1 that grows as ``step**order``."""
    return step * max(_LARGEST_REDUCTION, _SAFETY / error ** (1.0 / order))
