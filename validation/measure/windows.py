"""Windows of a run: the whole of it, its load steps, and the cycles of its oscillations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from contact_scene import Loading, Step, Trace
from contact_scene.loading import Segment
from contact_scene.trace import Array
from validation.solvers.model_range import MOST_CYCLES

REACHED = 1e-9
"""Part of what a quantity does in a load step to which its level ends the step."""


def windows(loading: Loading, trace: Trace) -> Array:
    """Begin and end of every window of a run, shape (n, 2), as far as the run goes; only whole cycles.

    What is left of a cycle in which contact is lost shows when it is lost, not how the edge moves in a cycle.
    The state from which a load step begins is that of the run, and one that ends at a level does so where the
    run has reached it.
    """
    last = float(trace.time[-1])
    spans = [(float(trace.time[0]), last)]
    for step, _, begin, end in _load_steps(loading, trace):
        spans.append((begin, end))
        spans += pairwise(begin + time for time in step.cycle_times(min(end, last) - begin))
    covered = [(begin, min(end, last)) for begin, end in spans if begin < min(end, last)]
    return np.array(covered, float).reshape(-1, 2)


def load_step_ends(spans: Array) -> Array:
    """Times at which load steps begin and end, told from the windows alone: cycles lie within a load step."""
    begin, end = spans.T
    within = (begin[1:] <= begin[:, None]) & (end[:, None] <= end[1:])
    shorter = (end - begin)[:, None] < (end - begin)[1:]
    return spans[~(within & shorter).any(axis=1)].ravel()


def corners(loading: Loading, trace: Trace) -> Array:
    """Times at which load steps begin and end, and at which the loading has kinks within them."""
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
    reached = np.flatnonzero(side * excess[1:] <= REACHED * float(np.ptp(excess)))
    return float(trace.time[rows[1 + reached[0]]]) if reached.size else end


def cycle_times(loading: Loading) -> tuple[float, ...]:
    """Times of phase 0, 2 pi, 4 pi, ... of the first oscillation or sweep; empty without one.

    Empty too where there are more than any solver takes, ``MOST_CYCLES``: their times could not be held.
    Steps before it must be controlled by penetration and end at a time, not at a level: otherwise its start
    is known only after the run.
    """
    for step, segment in loading.segments():
        if segment.control != "penetration" or not math.isfinite(segment.start):
            return ()
        cycles = step.cycles_by(math.inf)
        if cycles > 0.0:
            times = step.cycle_times(math.inf) if cycles <= MOST_CYCLES else ()
            return tuple(segment.start + time for time in times)
    return ()
