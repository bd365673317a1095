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
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar

from contact_scene import Indenter, Sphere
from validation.reference import sneddon
from validation.reference.finite_zone import FiniteZone
from validation.reference.frozen import FrozenRetraction
from validation.reference.jkr import JKR, NoEquilibrium, State


@dataclass(frozen=True)
class SpringContact:
    """An elastic adhesive contact on a spring of ``stiffness`` > 0 (force per length)."""

    law: JKR | FiniteZone
    stiffness: float

    def stage(self, state: State) -> float:
        """``X = D + F/k``."""
        return state.penetration + state.force / self.stiffness

    def pull_off(self) -> State:
        """The state of the least stage position, at which contact is lost."""
        law = self.law
        low = law.pull_off_penetration_control().contact_radius
        high = law.pull_off_force_control().contact_radius
        if isinstance(law, JKR):
            return law.state(float(brentq(self._slope, low, high, xtol=1e-300, rtol=1e-14)))
        return law.state(_least(lambda a: self.stage(law.state(a)), low, high))

    def largest_tension(self) -> State:
        """The state of largest tension of a slow retraction; before the pull-off, or at it."""
        return self.law.pull_off_force_control()

    def at_stage(self, stage: float) -> State:
        """The stable state (largest radius) at a position of the stage.

        Raises
        ------
        NoEquilibrium
            Beyond :meth:`pull_off`.
        """
        limit = self.pull_off()
        if stage < self.stage(limit):
            raise NoEquilibrium(f"no equilibrium at {stage:g}, the least stage is {self.stage(limit):g}")
        low, high = limit.contact_radius, 2.0 * limit.contact_radius
        while self.stage(self.law.state(high)) < stage:
            high *= 2.0
        radius = brentq(lambda a: self.stage(self.law.state(a)) - stage, low, high, xtol=1e-300, rtol=1e-14)
        return self.law.state(float(radius))

    def lost_in_snap(self) -> float:
        """Energy lost when contact is lost at the limit point, at constant stage."""
        limit = self.pull_off()
        return self.energy(limit) - np.pi * limit.contact_radius**2 * self.law.work

    def energy(self, state: State) -> float:
        """Elastic energy of half-space and spring."""
        indenter: Indenter = self.law.indenter if isinstance(self.law, JKR) else Sphere(self.law.radius)

        def density(x: float) -> float:
            return (state.penetration - float(sneddon.depth(indenter, x))) ** 2

        half_space = self.law.plane_modulus * quad(density, 0.0, state.contact_radius, epsrel=1e-12)[0]
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


@dataclass(frozen=True)
class FrozenSpring:
    """A relaxed contact pulled away, faster than anything can relax, by a stage and a spring."""

    retraction: FrozenRetraction
    stiffness: float

    def stage(self, state: State) -> float:
        """``X = D + F/k``."""
        return state.penetration + state.force / self.stiffness

    def pull_off(self) -> State:
        """The state in which contact is lost: where the stage is least on the release branch."""
        start = self.retraction.relaxed.contact_radius

        def state(radius: float) -> State:
            law = self.retraction
            return State(radius, float(law.penetration(radius)), float(law.force(radius)))

        return state(_least(lambda a: self.stage(state(a)), 0.0, start))

    def largest_tension(self) -> State:
        """The state of largest tension, which a stiff machine passes before contact is lost."""
        best, lost = self.retraction.pull_off(), self.pull_off()
        return best if best.contact_radius >= lost.contact_radius else lost


def _least(curve: Callable[[float], float], low: float, high: float) -> float:
    """Argument of the least value, at one of the ends if it is there."""
    fine = {"method": "bounded", "options": {"xatol": 1e-13 * high}}
    inner = float(minimize_scalar(curve, bounds=(low, high), **fine).x)
    return inner if curve(inner) < curve(high) else high
