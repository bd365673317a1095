"""Quantities of traces and profiles that claims need beyond the observables; pure functions.

Signs as everywhere: penetration ``D`` downwards, force ``F`` and pressure compressive, gap opening.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import SurfaceProfile, Trace
from validation.measure.events import end_of_approach

Array = NDArray[np.float64]

RECOVERED = 0.05
"""Relative difference within which two responses count as the same."""
LARGER = 1.2
"""Least ratio of two values for the first to count as significantly larger."""
STEADY = 1e-3
"""Change, relative to the largest magnitude, below which a quantity counts as constant."""
_NEAREST = 6
"""Points inside the edge from which the exponent of the tension there is read."""


def rising(values: ArrayLike, slack: float = STEADY) -> bool:
    """Whether no value falls below an earlier one by more than ``slack`` of the largest magnitude."""
    y = np.asarray(values, float)
    return bool(np.all(y >= np.maximum.accumulate(y) - slack * np.abs(y).max()))


def bell(values: ArrayLike) -> bool:
    """Whether the values rise to one inner maximum, significantly larger than both ends, and fall again."""
    y = np.asarray(values, float)
    top = int(y.argmax())
    single = rising(y[: top + 1], 0.01) and rising(y[top:][::-1], 0.01)
    return single and bool(y[top] >= LARGER * max(y[0], y[-1]))


def approach(trace: Trace) -> slice:
    """Rows up to the end of the approach."""
    return slice(0, end_of_approach(trace) + 1)


def withdrawal(trace: Trace) -> slice:
    """Rows in contact from the last one at the largest penetration on."""
    deepest = np.flatnonzero(trace.penetration >= trace.penetration.max() * (1.0 - 1e-9))
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    return slice(int(deepest[-1]), int(touching[-1]) + 1)


def hysteresis(trace: Trace) -> float:
    """Area between approach and withdrawal in the plane of ``F`` and ``D``, over ``0 <= D <= D_max``.

    Zero for one elastic curve followed to and fro; once contact is lost the force is zero.
    """
    inward, outward = approach(trace), withdrawal(trace)
    depth = np.linspace(0.0, float(trace.penetration.max()), 2001)
    pressed = np.interp(depth, trace.penetration[inward], trace.force[inward])
    back = trace.penetration[outward][::-1]
    pulled = np.interp(depth, back, trace.force[outward][::-1], left=0.0)
    apart = np.abs(pressed - pulled)
    return float(np.sum(0.5 * (apart[1:] + apart[:-1]) * np.diff(depth)))


def first_slope(trace: Trace, within: float = 0.01) -> float:
    """``dF/dD`` at the start of the withdrawal, over the first row beyond ``within`` of the force's range."""
    rows = withdrawal(trace)
    force, depth = trace.force[rows], trace.penetration[rows]
    far = np.flatnonzero(np.abs(force - force[0]) > within * np.ptp(force))
    last = int(far[0]) if far.size else len(force) - 1
    return float((force[last] - force[0]) / (depth[last] - depth[0]))


def last_slope(trace: Trace, within: float = 0.01) -> float:
    """``dF/dD`` at the end of the approach, over the rows within ``within`` of the force's range from it."""
    rows = approach(trace)
    force, depth = trace.force[rows], trace.penetration[rows]
    far = np.flatnonzero(np.abs(force - force[-1]) > within * np.ptp(force))
    first = int(far[-1]) if far.size else 0
    return float((force[-1] - force[first]) / (depth[-1] - depth[first]))


def on_line(trace: Trace, slope: float) -> float:
    """Share of the withdrawal up to the largest tension over which ``F = F_B + slope (D - D_B)``.

    A deviation of less than ``RECOVERED`` of the change of force so far is none.

    Parameters
    ----------
    trace : Trace
    slope : float
        Force over length.

    Returns
    -------
    float
        0 to 1.
    """
    rows = withdrawal(trace)
    force, depth = trace.force[rows], trace.penetration[rows]
    top = int(force.argmin())
    change = slope * (depth - depth[0])
    off = np.abs(force - force[0] - change) > RECOVERED * np.abs(change) + 1e-12 * np.abs(force).max()
    leaving = np.flatnonzero(off[: top + 1])
    last = depth[int(leaving[0]) - 1] if leaving.size and leaving[0] > 0 else depth[top]
    if leaving.size and leaving[0] == 0:
        return 0.0
    return float((depth[0] - last) / (depth[0] - depth[top]))


def release_rate(trace: Trace, at: int, work: float, window: float = 0.005) -> float:
    """``G = dg - dP/dA`` (Eq. enrelrate2) about row ``at``: what is lost over a window of contact area.

    The window ends between rows, and where the area turns or rests: the mean does not depend on how close the
    rows are, of which a solver puts many where an edge sets out. At least two rows on either side are taken;
    ``work`` where the area is constant.

    Parameters
    ----------
    trace : Trace
    at : int
        Row.
    work : float
        Work of adhesion ``dg``.
    window : float
        Largest difference in contact area from the row's own, relative to it.

    Returns
    -------
    float
        Energy over area.
    """
    area = np.pi * trace.contact_radius**2
    touching = int(np.flatnonzero(area > 0.0)[-1])
    near = np.abs(area - area[at]) <= window * area[at]
    first, last = at, at
    while first > 0 and (near[first] or at - first < 2):
        first -= 1
    while last < touching and (near[last] or last - at < 2):
        last += 1
    around, lost = area[first : last + 1], trace.dissipated_energy[first : last + 1]
    if np.ptp(around) <= 1e-5 * area.max():
        return work
    rising_area = np.argsort(around, kind="stable")  # of equal areas the later row counts
    ends = np.clip(area[at] * np.array([1.0 - window, 1.0 + window]), around.min(), around.max())
    low, high = np.interp(ends, around[rising_area], lost[rising_area])
    return work - float((high - low) / np.diff(ends)[0])


def tension_row(trace: Trace) -> int:
    """Row of the largest tension."""
    return int(trace.force.argmin())


def approach_row(trace: Trace, depth: float) -> int:
    """Row of the approach nearest to a penetration."""
    return int(np.abs(trace.penetration[approach(trace)] - depth).argmin())


def annular_peak(profile: SurfaceProfile) -> tuple[float, float] | None:
    """Radius over contact radius, and pressure over that at the centre, of the largest inner maximum.

    ``None`` if pressure falls from the centre to the edge, or the maximum stands out by less than 0.1 % of
    the largest pressure.
    """
    inside = profile.radius < profile.contact_radius
    r, p = profile.radius[inside], profile.pressure[inside]
    top = int(p.argmax())
    if top == 0 or p[top] <= 0.0 or p[top] - p[0] < STEADY * np.abs(p[top]):
        return None
    return float(r[top] / profile.contact_radius), float(p[top] / p[0]) if p[0] > 0.0 else float("inf")


def edge_exponent(profile: SurfaceProfile) -> float:
    """Exponent of the tension towards the edge, ``d ln(-p)/d ln(a - r)``, from the last points inside."""
    inside = profile.radius < profile.contact_radius
    s = (profile.contact_radius - profile.radius[inside])[-_NEAREST:]
    tension = -profile.pressure[inside][-_NEAREST:]
    if np.any(tension <= 0.0):
        return 0.0
    return float(np.polyfit(np.log(s), np.log(tension), 1)[0])


def gap_exponents(profile: SurfaceProfile, distances: Sequence[float]) -> Array:
    """``d ln g/d ln(r - a)`` between consecutive distances from the edge, shape (n-1,)."""
    open_ = (profile.radius > profile.contact_radius) & (profile.gap > 0.0)
    s, g = np.log(profile.radius[open_] - profile.contact_radius), np.log(profile.gap[open_])
    at = np.log(np.asarray(distances, float))
    return np.diff(np.interp(at, s, g)) / np.diff(at)


def crossing(x: ArrayLike, y: ArrayLike, level: float) -> float | None:
    """Where ``y(x)``, straight lines over ``log x``, first rises through ``level``.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Points of the curve; ``x`` positive and rising.
    level : float

    Returns
    -------
    float or None
        ``None`` if it does not.
    """
    at, values = np.log(np.asarray(x, float)), np.asarray(y, float)
    for i in range(len(values) - 1):
        if values[i] < level <= values[i + 1]:
            share = (level - values[i]) / (values[i + 1] - values[i])
            return float(np.exp(at[i] + share * (at[i + 1] - at[i])))
    return None
