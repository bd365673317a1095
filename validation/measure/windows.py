"""Windows of a run: the whole of it, its load steps, and the cycles of its oscillations."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, Oscillate, Step, Sweep, Trace

Array = NDArray[np.float64]


def windows(loading: Loading, trace: Trace) -> Array:
    """Begin and end of every window of a run, as far as the run goes; only whole cycles.

    What is left of a cycle in which contact is lost shows when it is lost, not how the edge moves in a cycle.
    The state from which a load step begins is that of the run.

    Parameters
    ----------
    loading : Loading
    trace : Trace

    Returns
    -------
    ndarray, shape (n, 2)
    """
    first, last = float(trace.time[0]), float(trace.time[-1])
    spans = [(first, last)]
    now = first

    def state(step: Step) -> tuple[float, float]:
        depth, force = (np.interp(now, trace.time, column) for column in (trace.penetration, trace.force))
        return float(depth), float(force)

    for step, segment in loading.segments(state):
        now = segment.end
        spans.append((segment.start, segment.end))
        spans += _cycles(step, segment.start, last)
        if not now < last:
            break
    covered = [(begin, min(end, last)) for begin, end in spans if begin < min(end, last)]
    return np.array(covered, float).reshape(-1, 2)


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
