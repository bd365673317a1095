"""Windows of a run: the whole of it, its load steps, and the cycles of its oscillations."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, Oscillate, Step, Sweep, Trace
from contact_scene.segment import Segment

Array = NDArray[np.float64]

AT_LEVEL = 1e-9
"""Part of what a quantity does in a load step to which its level ends the step."""


def windows(loading: Loading, trace: Trace) -> Array:
    """Begin and end of every window of a run, as far as the run goes; only whole cycles.

    What is left of a cycle in which contact is lost shows when it is lost, not how the edge moves in a cycle.
    The state from which a load step begins is that of the run, and one that ends at a level does so where the
    run has reached it.

    Parameters
    ----------
    loading : Loading
    trace : Trace

    Returns
    -------
    ndarray, shape (n, 2)
    """
    last = float(trace.time[-1])
    spans = [(float(trace.time[0]), last)]
    for step, _, begin, end in _load_steps(loading, trace):
        spans.append((begin, end))
        spans += _cycles(step, begin, min(end, last))
    covered = [(begin, min(end, last)) for begin, end in spans if begin < min(end, last)]
    return np.array(covered, float).reshape(-1, 2)


def load_step_ends(spans: Array) -> Array:
    """Times at which load steps begin and end, told from the windows of a run alone; kinks are none of them.

    Parameters
    ----------
    spans : ndarray, shape (n, 2)
        As of :func:`windows`: cycles lie within a load step.

    Returns
    -------
    ndarray, shape (m,)
    """
    begin, end = spans.T
    within = (begin[1:] <= begin[:, None]) & (end[:, None] <= end[1:])
    shorter = (end - begin)[:, None] < (end - begin)[1:]
    return spans[~(within & shorter).any(axis=1)].ravel()


def corners(loading: Loading, trace: Trace) -> Array:
    """Times at which load steps begin and end, and at which the loading has kinks within them.

    Parameters
    ----------
    loading : Loading
    trace : Trace
        As far as it goes.

    Returns
    -------
    ndarray, shape (n,)
    """
    steps = list(_load_steps(loading, trace))
    ends = [time for _, _, begin, end in steps for time in (begin, end)]
    kinks = [begin + kink for _, segment, begin, end in steps for kink in segment.kinks if begin + kink < end]
    return np.unique(ends + kinks)


def load_steps_begun(loading: Loading, trace: Trace) -> int:
    """How many load steps a run has begun before it ended."""
    return sum(1 for _ in _load_steps(loading, trace))


def _load_steps(loading: Loading, trace: Trace) -> Iterator[tuple[Step, Segment, float, float]]:
    """Load steps that the run has begun, their control laws from time 0 on, and when they begin and end."""
    now, last = float(trace.time[0]), float(trace.time[-1])

    def state(step: Step) -> tuple[float, float]:
        depth, force = (np.interp(now, trace.time, column) for column in (trace.penetration, trace.force))
        return float(depth), float(force)

    for step, segment in loading.segments(state, own_time=True):
        end = _end(segment, trace, now)
        yield step, segment, now, end
        now = end
        if not now < last:
            return


def _end(segment: Segment, trace: Trace, begin: float) -> float:
    """When a load step ends that begins at a time: at its level, if it has one and the run reaches it."""
    end = begin + segment.end
    rows = np.flatnonzero((trace.time >= begin) & (trace.time <= end))
    if segment.trigger is None or rows.size < 2:
        return end
    columns = (trace.penetration, trace.force, trace.contact_radius)
    excess = np.array([segment.trigger.excess(*(float(column[row]) for column in columns)) for row in rows])
    side = math.copysign(1.0, excess[0])
    reached = np.flatnonzero(side * excess[1:] <= AT_LEVEL * float(np.ptp(excess)))
    return float(trace.time[rows[1 + reached[0]]]) if reached.size else end


def _cycles(step: Step, start: float, last: float) -> list[tuple[float, float]]:
    """Whole cycles of an oscillation or sweep before the end of the run, or of the load step."""
    if isinstance(step, Oscillate):
        count = step.angular_frequency * step.duration / (2.0 * math.pi)
        reached = step.angular_frequency * (last - start) / (2.0 * math.pi)
    elif isinstance(step, Sweep):
        count = 0.5 * step.chirp * step.duration**2 / (2.0 * math.pi)
        reached = 0.5 * step.chirp * (last - start) ** 2 / (2.0 * math.pi)
    else:
        return []
    whole = np.arange(math.floor(min(count, reached) * (1.0 + 1e-12)) + 1.0)
    if isinstance(step, Oscillate):
        ends = start + whole * (2.0 * math.pi / step.angular_frequency)
    else:
        ends = start + np.sqrt(4.0 * math.pi * whole / step.chirp)
    return list(zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True))
