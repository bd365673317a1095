"""One Prony element in two representations: Maxwell branches driven by ``w``, Voigt units driven by ``q``.

Under the Abel transform every radius ``x`` is such an element. In contact ``w(x, t)`` is prescribed and the
branch forces ``b_k`` relax with the relaxation times ``tau_k``; outside ``q = 0`` and the unit strains
``e_j`` decay with the retardation times ``theta_j``. Both decays are exact for any length of time.

    q = E0* w + sum_k b_k,      w = q/Einf* + sum_j e_j,
    b_k = (E_k/Einf*) q + sum_j [E_k tau_k/(tau_k - theta_j)] e_j,
    e_j = J_j E0* w + sum_k [J_j tau_k/(tau_k - theta_j)] b_k.

Neither ``b`` changes when ``w`` is held nor ``e`` when ``q`` jumps, so that covering a point (``w`` jumps)
and releasing it (``q`` jumps) are changes of representation. Moduli are plane moduli ``E/(1 - nu^2)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene import Material
from validation.reference.creep_compliance import creep_spectrum
from validation.reference.path.layer import HALF_SPACE, Image
from validation.reference.path.numerics import gauss, total
from validation.reference.prony_integrals import NEGLIGIBLE, plane_spectrum
from validation.reference.sneddon import Transform

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rheology:
    """Moduli, times and the two changes of representation; arrays over branches have shape (n,)."""

    relaxed: float
    moduli: Array
    times: Array
    compliances: Array
    retardation: Array
    branches_of_units: Array
    units_of_branches: Array

    @cached_property
    def glassy(self) -> float:
        """``Einf*``."""
        return self.relaxed + float(self.moduli.sum())

    @cached_property
    def shortest(self) -> float:
        """Shortest relaxation time; infinite if nothing relaxes."""
        return float(self.times.min(initial=math.inf))

    def cover(self, units: Array, strain: Array) -> Array:
        """Branch forces just after free points (m, n) have been brought to ``w = strain`` (m,)."""
        return units @ self.branches_of_units + (strain - total(units))[:, None] * self.moduli

    def release(self, branches: Array, strain: Array) -> Array:
        """Unit strains of points (m, n) at ``w = strain`` (m,); a jump of ``q`` does not change them."""
        return branches @ self.units_of_branches + (self.relaxed * strain)[:, None] * self.compliances

    def stress(self, branches: Array, strain: Array) -> Array:
        """``q`` at points in contact."""
        return self.relaxed * strain + total(branches)


@dataclass(frozen=True, eq=False)
class IndentedBody:
    """Material, layer and indenter in Abel space, constant during a run."""

    rheology: Rheology
    transform: Transform
    image: Image = HALF_SPACE

    def shape(self, radius: float) -> float:
        """``G`` at one radius."""
        return float(self.transform(np.array([radius]))[0])

    @lru_cache(maxsize=8)  # noqa: B019
    def integrals(self, radius: float) -> tuple[Array, Array]:
        """``int_0^a phi phi`` (K + 1, K + 1) and ``int_0^a phi G`` (K + 1,)."""
        if not self.image.is_layer:
            return np.array([[radius]]), np.array([self.transform.integral(radius)])
        knots, sums = self._at_knots
        last = int(knots.searchsorted(radius, side="right")) - 1
        both = sums[last] + self._between(knots[last], radius)
        return both[:, :-1], both[:, -1]

    def strain_squared(self, depths: Array, radius: float) -> float:
        """``int_0^a (phi . D - G)^2 dx``."""
        gram, shape = self.integrals(radius)
        return float(depths @ (gram @ depths - 2.0 * shape)) + self.transform.squared(radius)

    @lru_cache(maxsize=2)  # noqa: B019
    def elastic(self, radius: float) -> tuple[Array, Array]:
        """``(D, C)`` of an elastic contact, whatever its modulus: the first times ``D``, less the second.

        ``C = B int_0^a P w^``.
        """
        gram, shape = self.integrals(radius)
        coupling = self.image.coupling
        if not self.image.is_layer:
            return np.ones(1), np.zeros(1)
        right = np.column_stack((np.eye(len(gram))[0], coupling @ shape))
        unit, rest = np.linalg.solve(np.eye(len(gram)) - coupling @ gram, right).T
        return unit, rest

    @cached_property
    def _rule(self) -> tuple[Array, Array]:
        return gauss(4 * len(self.image.axes) + 4)

    def _between(self, low: float, high: float) -> Array:
        """``int phi phi, phi G`` between knots of the profile, beyond which ``G`` may go as a root."""
        points, weights = self._rule
        x = low + (high - low) * points**2
        phi = self.image.functions(x)
        weighted = phi.T * (2.0 * (high - low) * weights * points)
        return np.hstack((weighted @ phi, (weighted @ self.transform(x))[:, None]))

    @cached_property
    def _at_knots(self) -> tuple[Array, Array]:
        knots = self.transform.knots
        knots = np.append(0.0, knots[(knots > 0.0) & (knots < self.image.reach)])
        parts = [self._between(low, high) for low, high in pairwise(knots.tolist())]
        return knots, np.array([np.zeros_like(self._between(0.0, 0.0)), *parts]).cumsum(axis=0)


def rheology(material: Material) -> Rheology:
    """Plane moduli and compliances of a material."""
    relaxed, moduli, times = plane_spectrum(material)
    matters = moduli > NEGLIGIBLE * (relaxed + moduli.sum())
    moduli, times = moduli[matters], times[matters]
    compliances, retardation, distances = creep_spectrum(relaxed, moduli, times)
    shift = -distances.T  # tau_k - theta_j, exact however close they are
    return Rheology(
        relaxed=relaxed,
        moduli=moduli,
        times=times,
        compliances=compliances,
        retardation=retardation,
        branches_of_units=((moduli * times)[:, None] / shift).T,
        units_of_branches=compliances[None, :] * times[:, None] / shift,
    )
