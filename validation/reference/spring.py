"""Adhesive contact in series with a spring: the limit point of the combined system.

With the stage at ``X`` and a spring of stiffness ``k`` the indenter is at ``D = X - F/k`` (stiffness of the
machine: D. Maugis and M. Barquins, J. Phys. D 11, 1989 (1978)). On a curve of equilibria ``D(a), F(a)`` the
contact is stable while ``X(a) = D(a) + F(a)/k`` rises with ``a``, and is lost where it is least. For a
vanishing process zone (:mod:`validation.reference.jkr`)

    X'(a) = (a G' - S/2)/a + (2 E*/k) (a G' - 3 S/2),

which vanishes at ``a G'(a) = m S(a)`` with ``m = (k + 6 E* a)/(2 k + 4 E* a)``: 1/2 under a rigid machine,
3/2 under a dead load, whatever the profile. What is lost in the snap, at constant stage, is

    U(a, D) + F^2/(2 k) - pi a^2 dg,    U = E* int_0^a (D - G(x))^2 dx.

``F > 0`` presses, ``D`` and ``X`` positive downwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from contact_scene import Indenter, Sphere
from validation.reference import sneddon
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR, ElasticContact, largest_radius


@dataclass(frozen=True)
class SpringContact:
    """An elastic adhesive contact on a spring of ``stiffness`` > 0 (force per length)."""

    law: JKR | FiniteZone
    stiffness: float

    def stage(self, state: ElasticContact) -> float:
        """``X = D + F/k``."""
        return state.penetration + state.force / self.stiffness

    def pull_off(self) -> ElasticContact:
        """The state of the least stage position, at which contact is lost."""
        law = self.law
        low = law.pull_off_penetration_control().contact_radius
        high = law.pull_off_force_control().contact_radius
        if isinstance(law, JKR):
            return law.state(float(brentq(self._slope, low, high, xtol=1e-300, rtol=1e-14)))
        return law.state(least(lambda a: self.stage(law.state(a)), low, high))

    def largest_tension(self) -> ElasticContact:
        """The state of largest tension of a slow retraction; before the pull-off, or at it."""
        return self.law.pull_off_force_control()

    def at_stage(self, stage: float) -> ElasticContact:
        """The stable state (largest radius) at a position of the stage.

        Raises
        ------
        NoEquilibrium
            Beyond :meth:`pull_off`.
        """
        low = self.pull_off().contact_radius
        return self.law.state(largest_radius(lambda a: self.stage(self.law.state(a)), stage, low))

    def lost_in_snap(self) -> float:
        """Energy lost when contact is lost at the limit point, at constant stage."""
        limit = self.pull_off()
        return self.energy(limit) - np.pi * limit.contact_radius**2 * self.law.work

    def energy(self, state: ElasticContact) -> float:
        """Elastic energy of half-space and spring."""
        indenter: Indenter = self.law.indenter if isinstance(self.law, JKR) else Sphere(self.law.radius)
        held = state.contact_radius, state.penetration
        half_space = sneddon.stored_energy(indenter, *held, self.law.plane_modulus)
        return half_space + 0.5 * state.force**2 / self.stiffness

    def _slope(self, radius: float) -> float:
        """``a X'(a) k/(k + 2 E* a)``, of the vanishing zone."""
        law, k = self.law, self.stiffness
        assert isinstance(law, JKR)
        exponent, coefficient = law.indenter.power or (np.nan, np.nan)
        along = exponent * coefficient * sneddon.shape_factor(exponent) * radius**exponent
        stretch = np.sqrt(2.0 * np.pi * radius * law.work / law.plane_modulus)
        soft = 2.0 * law.plane_modulus * radius
        return float(along - (k + 3.0 * soft) / (2.0 * k + 2.0 * soft) * stretch)


def least(curve: Callable[[float], float], low: float, high: float) -> float:
    """Argument of the least value, at one of the ends if it is there."""
    fine = {"method": "bounded", "options": {"xatol": 1e-13 * high}}
    inner = float(minimize_scalar(curve, bounds=(low, high), **fine).x)
    return inner if curve(inner) < curve(high) else high
