"""Opening edge that takes up more the faster it moves: one equation of motion for the radius.

**Elastic.** The energy release rate ``G(a, D)`` of an elastic contact depends on radius and penetration
alone. An edge that opens at ``v = -da/dt`` takes up ``w(v)``, so that

    da/dt = -w^(-1)(G(a, D(t)))   where G > work,   da/dt = 0   otherwise:

one ordinary differential equation, integrated here by SciPy. ``G`` is that of JKR, or the closure integral of
a finite process zone (D. Maugis, M. Barquins, J. Phys. D 11, 1989 (1978); M. Barquins, D. Maugis,
J. Adhesion 13, 53 (1981)).

**Viscoelastic, steady.** Where the process zone is short against the contact, the half-space outside the
travelling field of the edge is relaxed, and ``G`` is the elastic one of the relaxed modulus. Within that
field the edge opens as one in an infinite body that has always moved at its present speed: it takes up the
work of adhesion times the enhancement of the steady crack (:mod:`validation.reference.steady_crack`),

    G(a, D) = w(v) f(da, v),    da = zone,  or  da = da_0 G/work at a fixed stress.

R.A. Schapery (Int. J. Fracture 11, 141, 1975) and B.N.J. Persson, E.A. Brener (Phys. Rev. E 71, 036123, 2005)
close their laws at a fixed stress in the same way. What is left out is of the order of ``da/a``; of
``v theta/a``, the travelling field of the slowest retardation time over the radius; and of
``da |dv/dt|/v^2``, the change of the speed while the edge passes its zone. All grow as the contact shrinks:
a scene that is to follow the law ends soon after its largest tension, before the contact collapses.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, Material, PowerRate
from validation.reference import steady_crack

Array = NDArray[np.float64]

ReleaseRate = Callable[[float, float], float]
"""Energy release rate at a contact radius and a penetration."""
_SLOWEST, _FASTEST = 1e-60, 1e60
"""Speeds between which an edge is sought, in zones at rest per shortest time: no law of a scene is wider."""


def opening_speed(adhesion: Adhesion, release_rate: float) -> float:
    """``w^(-1)``: speed of an edge that takes up ``release_rate``; 0 where it does not open."""
    if release_rate <= adhesion.work:
        return 0.0
    rate = adhesion.rate
    if isinstance(rate, PowerRate):
        return rate.speed * (release_rate / adhesion.work - 1.0) ** (1.0 / rate.exponent)
    if rate is None or release_rate >= rate.works[-1]:
        return math.inf
    low, high = math.log(rate.speeds[0]), math.log(rate.speeds[-1])
    if release_rate <= rate.works[0]:
        return rate.speeds[0] * (release_rate - adhesion.work) / (rate.works[0] - adhesion.work)
    from scipy.optimize import brentq

    return math.exp(
        brentq(lambda x: adhesion.opening(math.exp(x)) - release_rate, low, high, xtol=1e-15, rtol=1e-15)
    )


@dataclass(frozen=True)
class RatedEdge:
    """An opening edge on an elastic half-space; ``release_rate`` is that of its contact."""

    adhesion: Adhesion
    release_rate: ReleaseRate

    def speed(self, release_rate: float) -> float:
        """Speed at which the edge opens where it is driven by ``release_rate``; 0 where it does not."""
        return opening_speed(self.adhesion, release_rate)

    def departure(self, radius: float, penetration: float, rate: float) -> float:
        """Time at which a pinned edge starts to open while the penetration falls at ``rate``."""
        from scipy.optimize import brentq

        def lack(time: float) -> float:
            return self.release_rate(radius, penetration - rate * time) - self.adhesion.work

        if lack(0.0) >= 0.0:
            return 0.0
        late = 1e-3 * radius / rate
        while lack(late) < 0.0:
            late *= 2.0
        return float(brentq(lack, 0.0, late, xtol=1e-300, rtol=1e-14))

    def radii(
        self, radius: float, penetration: float, rate: float, times: Array, smallest: float = 0.0
    ) -> Array:
        """Contact radius at rising ``times`` (n,) while the penetration falls at ``rate``.

        From an edge at rest, or about to open, at time 0; NaN after it has shrunk to ``smallest``.
        """
        from scipy.integrate import solve_ivp

        start = self.departure(radius, penetration, rate)

        def speed(time: float, state: Array) -> list[float]:
            a = max(float(state[0]), 0.5 * smallest)
            return [-self.speed(self.release_rate(a, penetration - rate * time))]

        def at_smallest(time: float, state: Array) -> float:
            return float(state[0]) - smallest

        at_smallest.terminal = True  # type: ignore[attr-defined]
        later = times[times > start]
        result = np.full(times.shape, np.nan)
        result[times <= start] = radius
        if len(later):
            path = solve_ivp(
                speed,
                (start, float(later[-1])),
                [radius],
                method="LSODA",
                t_eval=later,
                rtol=1e-11,
                atol=1e-12 * radius,
                events=at_smallest,
            )
            result[len(times) - len(later) :][: path.y.shape[1]] = path.y[0]
        return result


@dataclass(frozen=True)
class SteadyEdge(RatedEdge):
    """An opening edge with a short zone on a viscoelastic half-space; ``release_rate`` is the relaxed one."""

    material: Material

    def zone_at(self, release_rate: float) -> float:
        """Length of the process zone at an edge that takes up ``release_rate``."""
        adhesion = self.adhesion
        return adhesion.zone if adhesion.stress is None else adhesion.zone * release_rate / adhesion.work

    def enhancement(self, speed: float, release_rate: float) -> float:
        """``f``: what the half-space adds at a speed, where the zone is that of ``release_rate``."""
        return float(steady_crack.opening(self.material, self.zone_at(release_rate), speed))

    def taken(self, speed: float, release_rate: float) -> float:
        """``w(v) f(da, v)``: equal to ``release_rate`` where that is what drives an edge at ``speed``."""
        return self.adhesion.opening(speed) * self.enhancement(speed, release_rate)

    def speed(self, release_rate: float) -> float:
        """Speed at which the edge opens, 0 where it does not; infinite beyond the largest it can take up."""
        if release_rate <= self.adhesion.work:
            return 0.0
        unit = self.adhesion.zone / min(branch.time for branch in self.material.branches)
        low, high = math.log(_SLOWEST * unit), math.log(_FASTEST * unit)

        from scipy.optimize import brentq

        def excess(logarithm: float) -> float:
            return self.taken(math.exp(logarithm), release_rate) - release_rate

        if excess(low) >= 0.0:
            return 0.0
        if excess(high) <= 0.0:
            return math.inf
        return math.exp(brentq(excess, low, high, xtol=1e-13, rtol=1e-14))
