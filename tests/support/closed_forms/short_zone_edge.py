r"""Speed of a contact edge with a short process zone, by what drives it: opening and closing.

Within a zone ``da`` the edge moves as one in an infinite body that has always moved at its present speed
(:mod:`..steady_crack`, whose laws are of the near field alone): an opening edge at

    dg = (q(a)^2/(2 pi a)) (1/da) int_0^da J*(y/v) dy,

a closing edge, which has a free surface ahead of it that was never loaded, at

    dg = ((D - G(a))^2/(2 pi a)) (1/da) int_0^da E*(y/v) dy.

Each gives the speed; where no speed is fast enough, ``dg < J*(0) q(a)^2/(2 pi a)``, the edge jumps. Unlike
:mod:`..steady_edge` nothing is supposed of the half-space beyond the zone: it relaxes at its own rate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from contact_scene import Material
from validation.reference.prony_integrals import mean_creep, mean_relaxation

Array = NDArray[np.float64]

CROSSING_TIMES = 1e-9, 1e15
"""Bounds of the time in which the edge crosses its zone, over the shortest and longest relaxation time: an
edge that jumps has the first."""


@dataclass(frozen=True)
class ShortZoneEdge:
    """The edge of a sphere's contact, whose ``zone`` is short against every contact radius that matters."""

    material: Material
    radius: float
    work: float
    zone: float

    def opening_speed(self, contact_radius: float, load: float) -> float:
        """Of an edge with ``q(a) = load``: 0 where it is at rest, very large where it jumps."""
        needed = self.compliance_needed(contact_radius, load)
        if needed * self._relaxed >= 1.0 - 1e-14:
            return 0.0
        return self.zone / self._crossing(mean_creep, needed)

    def crossing_time(self, contact_radius: float, load: float) -> float:
        """Time in which an opening edge with ``q(a) = load`` crosses its zone; 0 where it jumps."""
        needed = self.compliance_needed(contact_radius, load)
        return self._crossing(mean_creep, needed) if needed * self._glassy > 1.0 else 0.0

    def closing_speed(self, contact_radius: float, penetration: float) -> float:
        """Of an edge that advances; 0 where it is at rest, very large where it jumps."""
        stretch = contact_radius**2 / self.radius - penetration
        needed = 2.0 * math.pi * contact_radius * self.work / stretch**2 if stretch > 0.0 else math.inf
        if needed <= self._relaxed * (1.0 + 1e-14):
            return 0.0
        return self.zone / self._crossing(mean_relaxation, needed)

    def compliance_needed(self, contact_radius: float, load: float) -> float:
        """Mean creep compliance at which the edge takes up the work of adhesion."""
        return 2.0 * math.pi * contact_radius * self.work / load**2 if load < 0.0 else math.inf

    def _crossing(self, mean: Callable[[Material, float], Array], value: float) -> float:
        times = self.material.spectrum[1]
        low, high = CROSSING_TIMES[0] * times.min(), CROSSING_TIMES[1] * times.max()
        rising = mean is mean_creep
        fastest, slowest = float(mean(self.material, low)), float(mean(self.material, high))
        if (fastest >= value) if rising else (fastest <= value):
            return float(low)
        if (slowest <= value) if rising else (slowest >= value):
            return float(high)

        def excess(logarithm: float) -> float:
            return float(mean(self.material, math.exp(logarithm))) - value

        return math.exp(brentq(excess, math.log(low), math.log(high), xtol=1e-13, rtol=1e-14))

    @property
    def _relaxed(self) -> float:
        return self.material.relaxed_plane_modulus

    @property
    def _glassy(self) -> float:
        return self.material.glassy_plane_modulus
