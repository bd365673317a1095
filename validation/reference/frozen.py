"""Frozen limit: a relaxed adhesive contact pulled away faster than anything can relax.

Limit of vanishing process zone of the retraction studied by Mandriota, Menga and Carbone, section "Results"
(flat-punch line of their Fig. 4), here for any axisymmetric indenter. The relaxed contact at ``D_B`` has
radius ``a_B`` (JKR with ``E0*``) and, in Sneddon's coordinate, ``q = E0* (D_B - G(x))``. A jump of the
penetration adds the glassy response of whatever area is still in contact,
``q = E0* (D_B - G) + Einf* (D - D_B)``:

    a = a_B:  F = F_B - 2 a_B Einf* (D_B - D)                     until K^2 = 2 Einf* dg at a_B,
    a < a_B:  q(a) = -sqrt(2 pi a Einf* dg),
              F(a) = 2 E0* (a G(a) - H(a)) - sqrt(8 pi a^3 Einf* dg).

The second line is a JKR contact of modulus ``E0*`` and work ``dg Einf/E0`` in force and radius, not in
penetration. The largest tension is that contact's pull-off if it happens at a radius below ``a_B``, and
``-F(a_B)`` otherwise. ``F > 0`` presses, ``D > 0`` downwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from contact_scene import FlatPunch, Indenter, Material, TabulatedProfile
from validation.reference import sneddon
from validation.reference.jkr import JKR, ElasticContact, NoEquilibrium

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrozenRetraction:
    """Instant retraction from the relaxed equilibrium at the penetration ``start``, ``D_B``."""

    material: Material
    indenter: Indenter
    work: float
    start: float

    @cached_property
    def relaxed(self) -> ElasticContact:
        """``a_B``, ``D_B``, ``F_B``.

        Raises
        ------
        NoEquilibrium
            If there is no relaxed contact at ``D_B``.
        """
        law = JKR(self.indenter, self.material.relaxed_plane_modulus, self.work)
        if self.indenter.power is not None:
            return law.at_penetration(self.start)
        radius = self.indenter.radius if isinstance(self.indenter, FlatPunch) else self._outermost(law)
        force = self.material.relaxed_plane_modulus * sneddon.unit_force(self.indenter, radius, self.start)
        return ElasticContact(radius, self.start, float(force))

    def force_while_frozen(self, penetration: ArrayLike) -> Array:
        """``F_B - 2 a_B Einf* (D_B - D)``; same shape as ``penetration``."""
        drop = self.start - np.asarray(penetration, float)
        return self.relaxed.force - 2.0 * self.relaxed.contact_radius * self._glassy * drop

    def penetration(self, contact_radius: ArrayLike) -> Array:
        """``D`` on the release branch, ``a <= a_B``."""
        a = np.asarray(contact_radius, float)
        edge = np.sqrt(2.0 * np.pi * a * self._glassy * self.work)
        relaxed = self.material.relaxed_plane_modulus * (self.start - sneddon.depth(self.indenter, a))
        return self.start - (relaxed + edge) / self._glassy

    def force(self, contact_radius: ArrayLike) -> Array:
        """``F(a)`` on the release branch, ``a <= a_B``."""
        a = np.asarray(contact_radius, float)
        pressed = sneddon.force(self.indenter, a, self.material.relaxed_plane_modulus)
        return pressed - np.sqrt(8.0 * np.pi * a**3 * self._glassy * self.work)

    def release(self) -> ElasticContact:
        """Where the edge starts to recede: ``K^2 = 2 Einf* dg`` at ``a_B``."""
        a = self.relaxed.contact_radius
        return ElasticContact(a, float(self.penetration(a)), float(self.force(a)))

    def pull_off(self) -> ElasticContact:
        """The state of largest tension; its force is negative."""
        radius = self.relaxed.contact_radius
        if self.indenter.power is not None:
            ratio = self.material.glassy_modulus / self.material.modulus
            plateau = JKR(self.indenter, self.material.relaxed_plane_modulus, self.work * ratio)
            best = min(radius, plateau.pull_off_force_control().contact_radius)
        else:
            grid = np.linspace(0.0, radius, 401)[1:]
            k = int(np.argmin(self.force(grid)))
            best = float(grid[k])
            if 0 < k < len(grid) - 1:
                bracket = (grid[k - 1], grid[k + 1])
                near = {"method": "bounded", "options": {"xatol": 1e-9 * best}}
                best = float(minimize_scalar(self.force, bounds=bracket, **near).x)
        return ElasticContact(best, float(self.penetration(best)), float(self.force(best)))

    @property
    def _glassy(self) -> float:
        return self.material.glassy_plane_modulus

    def _outermost(self, law: JKR) -> float:
        """Largest root of ``D(a) = D_B`` for a tabulated profile, sought from outside inwards."""
        high = self.indenter.radii[-1] if isinstance(self.indenter, TabulatedProfile) else 1.0
        while law.penetration(high) < self.start:
            high *= 2.0
        grid = np.geomspace(1e-6 * high, high, 1001)
        below = np.flatnonzero(law.penetration(grid) < self.start)
        if below.size == 0:
            raise NoEquilibrium(f"no relaxed contact at penetration {self.start:g}")
        k = int(below[-1])
        return float(
            brentq(lambda a: float(law.penetration(a)) - self.start, grid[k], grid[k + 1], xtol=1e-300)
        )
