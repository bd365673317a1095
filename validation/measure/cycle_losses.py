"""Energy lost in each cycle of an oscillating load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Trace
from validation.measure.round_off import ROUND_OFF

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CycleLoss:
    """Energy lost over one oscillation.

    Parameters
    ----------
    start, end : float
        Times of equal phase, one period apart.
    angular_frequency : float
        ``2 pi/(end - start)``, the mean over the cycle.
    loop : float
        ``integral F dD`` over the cycle.
    dissipated : float
        Increase of the solver's dissipated energy over the cycle.
    """

    start: float
    end: float
    angular_frequency: float
    loop: float
    dissipated: float


def cycle_losses(trace: Trace, times: ArrayLike) -> tuple[CycleLoss, ...]:
    """Losses of the cycles between consecutive ``times``, as far as the run went.

    A time that is no row of the trace is interpolated linearly, which costs second order in the row
    spacing; pass them to the solver as stop times to have them stepped onto.
    """
    if len(trace) < 2:
        return ()
    ends = np.asarray(times, float)
    slack = ROUND_OFF * (trace.time[-1] - trace.time[0])
    ends = ends[(ends >= trace.time[0] - slack) & (ends <= trace.time[-1] + slack)]
    work = np.concatenate(([0.0], np.cumsum(np.diff(trace.external_work))))
    at = [_until(trace, work, float(time)) for time in ends]
    return tuple(
        CycleLoss(float(a), float(b), float(2 * np.pi / (b - a)), right[0] - left[0], right[1] - left[1])
        for a, b, left, right in zip(ends[:-1], ends[1:], at[:-1], at[1:], strict=True)
    )


def _until(trace: Trace, work: Array, time: float) -> tuple[float, float]:
    """``integral F dD`` and dissipated energy up to ``time``; ``F`` and ``D`` almost linear between rows."""
    i = int(np.clip(np.searchsorted(trace.time, time, side="right") - 1, 0, len(trace) - 2))
    step = trace.time[i + 1] - trace.time[i]
    part = float(np.clip((time - trace.time[i]) / step, 0.0, 1.0)) if step > 0 else 1.0
    first, last = trace.force[i], trace.force[i + 1]
    depth = trace.penetration[i + 1] - trace.penetration[i]
    straight = (first + 0.5 * part * (last - first)) * part * depth
    done = straight + part * (work[i + 1] - work[i] - 0.5 * (first + last) * depth)
    loss = trace.dissipated_energy[i] + part * (trace.dissipated_energy[i + 1] - trace.dissipated_energy[i])
    return float(work[i] + done), float(loss)
