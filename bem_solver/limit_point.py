"""A step that ends on a limit point: where the residual touches zero, and the edge runs away.

There the residual over the edge has an extremum of zero. A row at which it merely is zero lies before that,
by the root of what the load still lacks: to come close takes ever shorter steps, and whatever little makes
the residual uneven moves the last row by its root. The place of the extremum is where the derivative
vanishes, and does not suffer from that. It is told from well before: within the short time that is left
nothing relaxes, and the residual over the edge is a parabola that the load shifts. The instant is that at
which its extremum is zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from bem_solver.run_state import StepStart
from bem_solver.step_limits import until_largest_tension
from bem_solver.step_result import Candidate
from bem_solver.step_trials import StepTrials

_NEAR = 0.1
"""Way to a limit point, in process zones, within which the next step ends on it, if the edge may go so far.
The residual is looked at up to a quarter of it on both sides: over that it is a parabola, but for some
1e-5 of the radius in the place of the extremum; over less, what annuli make of old kinks moves it by more."""
_LEFT = 1e-5
"""Time to it, in the shortest relaxation time, within which the next step ends on it. What creeps in a
hundred times as long moves it by a hundredth of the way."""
_FARTHEST = 4.0
"""Distance of the extremum, in the way that was expected, from which on another one was meant."""
_SECANTS, _ZERO = 8, 1e-11
"""Secants for the instant, and the residual, relative to the work of adhesion, that ends them: less than that
of the unstable edge a smallest travel beyond the limit point."""


class Extremum(NamedTuple):
    """Place ``x`` of the smallest value, of a function that rises on both sides, and that ``value``."""

    x: float
    value: float


def smallest(function: Callable[[float], float], middle: float, stride: float) -> Extremum | None:
    """Smallest value of a function, by the parabola through three equidistant places.

    Parameters
    ----------
    function : callable
    middle, stride : float
        The second place, and the distance, of either sign, of the others from it.

    Returns
    -------
    Extremum or None
        ``None`` where the parabola has no smallest value.
    """
    before, at, after = (function(middle + n * stride) for n in (-1, 0, 1))
    bend = before - 2.0 * at + after
    if not bend > 0.0:
        return None
    share = 0.5 * (before - after) / bend
    return Extremum(middle + share * stride, at - 0.5 * share**2 * bend)


def near_limit_point(start: StepStart) -> bool:
    """Whether a limit point is so near that the next step may end on it."""
    problem, accepted, interval = start.problem, start.state.accepted, start.interval
    if problem.work == 0.0 or problem.rated or interval.jump or interval.trigger is not None:
        return False
    advancing = accepted.rates(0.0)[0] > 0.0
    reach = problem.longest_travel(start.state.contact.edge, advancing) / start.settings.divisions
    if not 0.0 < accepted.way_to_limit_point() < min(_NEAR * problem.zone, reach):
        return False
    left = accepted.step_to_limit_point()
    if left > _LEFT * problem.chain.relaxation.min(initial=math.inf):
        return False
    return until_largest_tension(start, left) == math.inf


def to_limit_point(step: StepTrials) -> Candidate | None:
    """The step that ends on a limit point ahead.

    Parameters
    ----------
    step : StepTrials
        From the committed state, of any length.

    Returns
    -------
    Candidate or None
        ``None`` where there is no limit point, and where it comes after the end of the interval.
    """
    accepted, begin = step.state.accepted, step.state.parameter
    edge, sign = step.state.contact.edge, math.copysign(1.0, accepted.rates(0.0)[0])
    half, trial = 0.5 * _NEAR * step.problem.zone, cache(step.trial)

    def driven(parameter: float, x: float) -> float:
        """How strongly the edge is driven on, negative where it is held, in works of adhesion."""
        return -sign * trial(parameter, x).residual / step.problem.work

    def extremum(parameter: float, way: float, stride: float) -> Extremum | None:
        return smallest(lambda way: driven(parameter, edge + sign * way), way, stride)

    way = max(accepted.way_to_limit_point(), half)  # an edge that turns round there covers what it has left
    expected = extremum(begin, way, half)
    if expected is None or expected.value >= 0.0 or not 0.0 < expected.x < _FARTHEST * way:
        return None
    left, place = accepted.step_to_limit_point(), edge + sign * expected.x
    parameter = _zero(lambda at: driven(at, place), begin, expected.value, left)
    if parameter is None or not begin < parameter <= step.interval.length:
        return None
    there = extremum(parameter, expected.x, min(0.5 * half, expected.x))  # the load has moved it, too
    if there is None:
        return None
    new_edge, more = edge + sign * there.x, (parameter - begin) * there.value / expected.value
    parameter = _zero(lambda at: driven(at, new_edge), parameter, there.value, more)
    if parameter is None or not begin + step.shortest_step <= parameter <= step.interval.length:
        return None
    return Candidate(parameter, trial(parameter, new_edge), 0.0)


def _zero(function: Callable[[float], float], x: float, value: float, stride: float) -> float | None:
    """Zero of a nearly straight function by secants; at ``x`` it has a ``value``, the next is a stride on."""
    for _ in range(_SECANTS):
        new_x = x + stride
        new = function(new_x)
        if abs(new) <= _ZERO:
            return new_x
        if new == value:
            return None
        stride *= new / (value - new)
        x, value = new_x, new
    return None
