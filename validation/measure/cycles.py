"""When the cycles of an oscillating load begin and end."""

from __future__ import annotations

import math

from contact_scene import Loading, Oscillate, Sweep
from validation.solvers.model_range import MOST_CYCLES


def cycle_times(loading: Loading) -> tuple[float, ...]:
    """Times of phase 0, 2 pi, 4 pi, ... of the first oscillation or sweep; empty without one.

    Empty too where there are more than any solver takes, ``MOST_CYCLES``: their times could not be held.

    Steps before it must be controlled by penetration and end at a time, not at a level: otherwise its start
    is known only after the run.
    """
    for step, segment in loading.segments():
        time = segment.start
        if segment.control != "penetration" or not math.isfinite(time):
            return ()
        if isinstance(step, Oscillate):
            period = 2.0 * math.pi / step.angular_frequency
            whole = math.floor(step.duration / period * (1.0 + 1e-12))
            return tuple(time + n * period for n in range(whole + 1)) if whole <= MOST_CYCLES else ()
        if isinstance(step, Sweep):
            whole = math.floor(0.5 * step.chirp * step.duration**2 / (2.0 * math.pi) * (1.0 + 1e-12))
            if whole > MOST_CYCLES:
                return ()
            return tuple(time + math.sqrt(4.0 * math.pi * n / step.chirp) for n in range(whole + 1))
    return ()
