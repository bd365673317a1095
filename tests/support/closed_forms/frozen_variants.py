"""The frozen limit with a process zone of finite length, and on a spring."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import Material
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import ElasticContact


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
