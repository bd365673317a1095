"""Ting (1966): loading, hold and unloading of a viscoelastic half-space, without adhesion.

T.C.T. Ting, J. Appl. Mech. 33, 845. When the contact shrinks its edge passes points first covered at an
earlier time ``t1``; there the pressure transform vanishes:

    int_(t1)^t E*(t - s) D'(s) ds = 0,    a(t) = a(t1),    F(t) = 2 int_0^(t1) E*(t - s) a(s) D'(s) ds.

Penetration rises at speed ``V`` until ``tp``, holds until ``th`` and falls at speed ``W``. With
``I(t) = int_0^t E*``, any number of branches included, the condition is

    V [I(t - t1) - I(t - tp)] = W I(t - th),

one rising function of ``t - t1``: one root. Contact is lost where ``t1 = 0`` (for a flat punch too:
``F = 0``). ``F > 0`` presses, ``D > 0`` downwards, ``t = 0`` at first touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import hyp1f1

from contact_scene import FlatPunch, Indenter, Material, TabulatedProfile
from validation.reference import prony_integrals, sneddon

Array = NDArray[np.float64]


def ramp_integral(material: Material, indenter: Indenter, rate: float, covered: float, time: float) -> float:
    """``int_0^a I(t - t_x) dx`` over the points a ramp of speed ``rate`` covered until ``covered <= time``.

    By parts it is ``int_0^covered E*(t - s) a(s) ds + a I(t - covered)``. With ``a = alpha s^(1/n)`` and
    ``p = 1 + 1/n`` each branch gives Kummer's function,
    ``int_0^c exp(-(t-s)/tau) s^(p-1) ds = exp(-(t-c)/tau) (c^p/p) 1F1(1; 1+p; -c/tau)``.
    """
    radius = sneddon.contact_radius(indenter, rate * covered)
    if isinstance(indenter, FlatPunch):
        return radius * float(prony_integrals.relaxation_integral(material, time))
    law = indenter.power
    if law is not None:
        p = 1.0 + 1.0 / law[0]
        relaxed, moduli, times = prony_integrals.plane_spectrum(material)
        memory = np.exp(-(time - covered) / times) * hyp1f1(1.0, 1.0 + p, -covered / times)
        late = radius * float(prony_integrals.relaxation_integral(material, time - covered))
        return radius * covered / p * (relaxed + float(memory @ moduli)) + late

    def carried(x: float) -> float:
        age = max(time - float(sneddon.depth(indenter, x)) / rate, 0.0)
        return float(prony_integrals.relaxation_integral(material, age))

    knots = indenter.radii if isinstance(indenter, TabulatedProfile) else ()
    ends = [0.0, *(r for r in knots if 0.0 < r < radius), radius]
    return float(sum(quad(carried, a, b, epsabs=0.0, epsrel=1e-11, limit=400)[0] for a, b in pairwise(ends)))


@dataclass(frozen=True)
class Ting:
    """Up at ``rise`` (``V``) until ``peak`` (``tp``), a ``hold`` of ``th - tp``, down at ``fall`` (``W``)."""

    material: Material
    indenter: Indenter
    rise: float
    peak: float
    fall: float
    hold: float = 0.0

    def penetration(self, time: ArrayLike) -> Array:
        """``D(t)``; same shape as ``time``."""
        t = np.asarray(time, float)
        falling = np.maximum(t - self.peak - self.hold, 0.0)
        return self.rise * np.minimum(t, self.peak) - self.fall * falling

    def arrival(self, time: float) -> float:
        """``t1``, when the point now at the edge was first covered; 0 from the loss of contact on."""
        release = self.peak + self.hold
        if time <= release:
            return min(time, self.peak)
        target = self._integral(time - self.peak) + self.fall / self.rise * self._integral(time - release)
        if self._integral(time) <= target:
            return 0.0
        young, old = time - self.peak, time
        age = brentq(lambda s: self._integral(s) - target, young, old, xtol=1e-300, rtol=1e-15)
        return time - float(age)

    def contact_radius(self, time: ArrayLike) -> Array:
        """``a(t)``; same shape as ``time``."""
        return np.vectorize(self._radius, otypes=[float])(time)

    def force(self, time: ArrayLike) -> Array:
        """``F(t)``; same shape as ``time``."""
        return np.vectorize(self._force, otypes=[float])(time)

    def detachment(self) -> float:
        """Time at which contact is lost: ``V [I(t) - I(t - tp)] = W I(t - th)``."""
        release = self.peak + self.hold

        def lack(time: float) -> float:
            risen = self._integral(time) - self._integral(time - self.peak)
            return self.fall * self._integral(time - release) - self.rise * risen

        # An elastic half-space holds on longest: until the penetration is back at zero.
        last = release + self.rise * self.peak / self.fall
        if lack(last) <= 0.0:
            return last
        return float(brentq(lack, release, last, xtol=1e-300, rtol=1e-15))

    def _integral(self, time: float) -> float:
        return float(prony_integrals.relaxation_integral(self.material, time))

    def _radius(self, time: float) -> float:
        first = self.arrival(time)
        return sneddon.contact_radius(self.indenter, self.rise * first) if first > 0.0 else 0.0

    def _force(self, time: float) -> float:
        first = self.arrival(time)
        if first <= 0.0:
            return 0.0
        radius = sneddon.contact_radius(self.indenter, self.rise * first)
        swept = ramp_integral(self.material, self.indenter, self.rise, first, time)
        since = self.rise * self._integral(time - self.peak) + self.fall * self._integral(
            time - self.peak - self.hold
        )
        return 2.0 * (self.rise * swept - radius * since)
