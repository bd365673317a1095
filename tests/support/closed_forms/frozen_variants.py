"""The frozen limit with a process zone of finite length, and on a spring."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import Material
from validation.reference.finite_zone import FiniteZone
from validation.reference.frozen import FrozenRetraction
from validation.reference.jkr import ElasticContact
from validation.reference.spring import least


@dataclass(frozen=True)
class FrozenZone:
    """Frozen retraction of a sphere with a zone of finite length, exact while that lies within ``a_B``.

    Every stress since the relaxed state is ``Einf*`` times a displacement, and ``q = Einf* (D' - G/rho)``
    with ``rho = Einf/E0`` and ``D' = D - D_B + D_B/rho`` is that of an elastic contact of modulus ``Einf*``,
    radius ``rho R`` and penetration ``D'``: so are tractions, the gap within ``a_B``, and the closure.
    """

    material: Material
    radius: float
    work: float
    zone: float
    start: float

    @property
    def relaxed(self) -> ElasticContact:
        """``a_B``, ``D_B``, ``F_B``."""
        plane = self.material.relaxed_plane_modulus
        return FiniteZone(self.radius, plane, self.work, self.zone).at_penetration(self.start)

    @property
    def equivalent(self) -> FiniteZone:
        """The elastic contact at ``D'``."""
        plane = self.material.glassy_plane_modulus
        return FiniteZone(self._contrast * self.radius, plane, self.work, self.zone)

    @property
    def offset(self) -> float:
        """``D - D'``."""
        return self.start * (1.0 - 1.0 / self._contrast)

    @property
    def _contrast(self) -> float:
        return self.material.glassy_modulus / self.material.modulus


@dataclass(frozen=True)
class FrozenSpring:
    """A relaxed contact pulled away, faster than anything can relax, by a stage and a spring."""

    retraction: FrozenRetraction
    stiffness: float

    def stage(self, state: ElasticContact) -> float:
        """``X = D + F/k``."""
        return state.penetration + state.force / self.stiffness

    def pull_off(self) -> ElasticContact:
        """The state in which contact is lost: where the stage is least on the release branch."""
        start = self.retraction.relaxed.contact_radius

        def state(radius: float) -> ElasticContact:
            law = self.retraction
            return ElasticContact(radius, float(law.penetration(radius)), float(law.force(radius)))

        return state(least(lambda a: self.stage(state(a)), 0.0, start))

    def largest_tension(self) -> ElasticContact:
        """The state of largest tension, which a stiff machine passes before contact is lost."""
        best, lost = self.retraction.pull_off(), self.pull_off()
        return best if best.contact_radius >= lost.contact_radius else lost
