"""The length of the next step, before it is tried.

As long as the last steps let expect to be accurate, within the travel limit of the edge, with rows close to
what the loading and the largest tension ask for.
"""

from __future__ import annotations

import math

from bem_solver.run_state import StepStart
from bem_solver.step_control import shrunk

_TRAVEL_ITERATIONS = 3
"""Corrections of a step by the travel to be expected in it: the expected travel is nearly in proportion."""
_BESIDE_EXTREMUM = 0.125
"""Distance of the rows on both sides of the largest tension, in steps: what lies between them exceeds the row
by a sixty-fourth of what it would with the whole step."""
_STEP_PLACES = 20
"""Binary places of a step: a millionth of it is far below what any error says of it, and far above what
rounding makes of that error, which would grow from step to step."""


def limited_step(start: StepStart) -> tuple[float, float]:
    """Step size to start from next time, and the step to try.

    Within the travel limit, with no more than a slight departure of the prescribed quantity from its chord,
    and without leaving a sliver before the end of the interval.
    """
    state, interval, settings = start.state, start.interval, start.settings
    advancing = state.accepted.rates(0.0)[0] > 0.0
    limited, parameter = state.step, state.parameter
    limited = _step_within(start, limited, 0.9 * start.reach(advancing))
    limited = _rounded(limited / interval.length) * interval.length  # alike in all units
    left = interval.length - parameter
    limited = min(limited, left)
    while (departure := interval.departure_from_chord(parameter, limited) / settings.tolerance) > 1.0:
        limited = shrunk(limited, departure)
    if limited >= left * (1.0 - 1e-9):
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


def until_largest_tension(start: StepStart, step: float) -> float:
    """The longest step that leaves rows close before, at and close after the largest tension of the run."""
    state, force = start.state, start.state.contact.surface.force
    if start.interval.control == "force" or force >= 0.0:
        return math.inf
    near = _BESIDE_EXTREMUM * step
    distance = state.accepted.until_load_turns()
    if -force < state.largest_tension or not -1.5 * near < distance < step + near:
        return math.inf
    return distance - near if distance > 1.5 * near else near
