"""Quantities that claims need beyond the observables: of traces, profiles, and the elastic limits.

Signs as everywhere: penetration ``D`` downwards, force ``F`` and pressure compressive, gap opening.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from contact_scene import Sphere, SurfaceProfile, Trace
from contact_scene.trace import Array
from validation.cases import load
from validation.claims.claim import RECOVERED, STEADY
from validation.claims.evidence import Evidence
from validation.measure.events import end_of_approach
from validation.measure.observables import CycleLoss, cycle_losses
from validation.measure.scaling import unit_sizes
from validation.measure.windows import cycle_times
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR

NEAREST = 6
"""Points inside the edge from which the exponent of the tension there is read."""
BASE = "cycle-v0.02"
"""Built-in scene with the material, sphere and adhesion of all claims but the sweep."""
SOFT, STIFF = False, True
"""Relaxed and glassy."""


@cache
def jkr(glassy: bool, scene: str = BASE) -> JKR:
    """The elastic limit with a vanishing process zone."""
    asked = load(scene).scene
    assert asked.adhesion is not None
    material = asked.material
    modulus = material.glassy_plane_modulus if glassy else material.relaxed_plane_modulus
    return JKR(asked.indenter, modulus, asked.adhesion.work)


@cache
def elastic(glassy: bool) -> FiniteZone:
    """The elastic limit of the model: the paper's closure over its process zone."""
    asked, limit = load(BASE).scene, jkr(glassy)
    assert asked.adhesion is not None
    assert isinstance(asked.indenter, Sphere)
    return FiniteZone(asked.indenter.radius, limit.plane_modulus, limit.work, asked.adhesion.zone)


def elastic_pull_off(law: FiniteZone) -> float:
    """Pull-off force of an elastic sphere over ``F_JKR``."""
    return -law.pull_off_force_control().force / unit_sizes(load(BASE).scene)["jkr-force"]


def crossing(x: ArrayLike, y: ArrayLike, level: float) -> float | None:
    """Where ``y(x)``, straight lines over ``log x``, first rises through ``level``; ``None`` if nowhere."""
    at, values = np.log(np.asarray(x, float)), np.asarray(y, float)
    through = np.flatnonzero((values[:-1] < level) & (level <= values[1:]))
    if not through.size:
        return None
    pair = slice(through[0], through[0] + 2)
    return float(np.exp(np.interp(level, values[pair], at[pair])))


def approach(trace: Trace) -> slice:
    """Rows up to the end of the approach."""
    return slice(0, end_of_approach(trace) + 1)


def withdrawal(trace: Trace) -> slice:
    """Rows in contact from the last one at the largest penetration on."""
    deepest = np.flatnonzero(trace.penetration >= trace.penetration.max() * (1.0 - 1e-9))
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    return slice(int(deepest[-1]), int(touching[-1]) + 1)


def tension_row(trace: Trace) -> int:
    """Row of the largest tension."""
    return int(trace.force.argmin())


def approach_row(trace: Trace, depth: float) -> int:
    """Row of the approach nearest to a penetration."""
    return int(np.abs(trace.penetration[approach(trace)] - depth).argmin())


def sweep_cycles(runs: Evidence) -> tuple[CycleLoss, ...]:
    """Loss of every cycle of the sweep."""
    return cycle_losses(runs.trace("sweep"), cycle_times(load("sweep").scene.loading))


def hysteresis(trace: Trace) -> float:
    """Area between approach and withdrawal in the plane of ``F`` and ``D``, over ``0 <= D <= D_max``.

    Zero for one elastic curve followed to and fro; once contact is lost the force is zero.
    """
    inward, outward = approach(trace), withdrawal(trace)
    depth = np.linspace(0.0, float(trace.penetration.max()), 2001)
    pressed = np.interp(depth, trace.penetration[inward], trace.force[inward])
    back = trace.penetration[outward][::-1]
    apart = np.abs(pressed - np.interp(depth, back, trace.force[outward][::-1], left=0.0))
    return float(np.sum(0.5 * (apart[1:] + apart[:-1]) * np.diff(depth)))


def first_slope(trace: Trace, within: float = 0.01) -> float:
    """``dF/dD`` at the start of the withdrawal, over the first row beyond ``within`` of the force's range."""
    rows = withdrawal(trace)
    return _slope(trace.force[rows], trace.penetration[rows], within)


def last_slope(trace: Trace, within: float = 0.01) -> float:
    """``dF/dD`` at the end of the approach, from the last row beyond ``within`` of the force's range."""
    rows = approach(trace)
    return _slope(trace.force[rows][::-1], trace.penetration[rows][::-1], within)


def _slope(force: Array, depth: Array, within: float) -> float:
    """Slope from the first row to the nearest one that is farther in force."""
    far = np.flatnonzero(np.abs(force - force[0]) > within * np.ptp(force))
    last = int(far[0]) if far.size else len(force) - 1
    return float((force[last] - force[0]) / (depth[last] - depth[0]))


def on_line(trace: Trace, slope: float) -> float:
    """Share of the withdrawal up to the largest tension over which ``F = F_B + slope (D - D_B)``, 0 to 1.

    A deviation of less than ``RECOVERED`` of the change of force so far is none.
    """
    rows = withdrawal(trace)
    force, depth = trace.force[rows], trace.penetration[rows]
    top = int(force.argmin())
    change = slope * (depth - depth[0])
    off = np.abs(force - force[0] - change) > RECOVERED * np.abs(change) + 1e-12 * np.abs(force).max()
    leaving = np.flatnonzero(off[: top + 1])
    last = max(int(leaving[0]) - 1, 0) if leaving.size else top
    return float((depth[0] - depth[last]) / (depth[0] - depth[top]))


def release_rate(trace: Trace, at: int, work: float, window: float = 0.005) -> float:
    """``G = dg - dP/dA`` (Eq. enrelrate2) about row ``at``: what is lost over a window of contact area.

    The window is relative to the row's own area and ends between rows, and where the area turns or rests: the
    mean does not depend on how close the rows are. At least two rows on either side are taken; ``work``, the
    work of adhesion ``dg``, where the area is constant.
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
    distance = (profile.contact_radius - profile.radius[inside])[-NEAREST:]
    tension = -profile.pressure[inside][-NEAREST:]
    if np.any(tension <= 0.0):
        return 0.0
    return float(np.polyfit(np.log(distance), np.log(tension), 1)[0])


def gap_exponents(profile: SurfaceProfile, distances: ArrayLike) -> Array:
    """``d ln g/d ln(r - a)`` between consecutive distances from the edge, shape (n-1,)."""
    open_ = (profile.radius > profile.contact_radius) & (profile.gap > 0.0)
    s, g = np.log(profile.radius[open_] - profile.contact_radius), np.log(profile.gap[open_])
    at = np.log(np.asarray(distances, float))
    return np.diff(np.interp(at, s, g)) / np.diff(at)


def elastic_gap_exponents(law: JKR, a: float, distances: Array) -> Array:
    """The same of the elastic contact of this radius in equilibrium."""
    r = a + distances
    stretch = a**2 - float(law.penetration(a))
    angle = np.arccos(a / r)
    gap = (2.0 * stretch * angle + (r**2 - 2.0 * a**2) * angle + a * np.sqrt(r**2 - a**2)) / np.pi
    return np.diff(np.log(gap)) / np.diff(np.log(distances))
