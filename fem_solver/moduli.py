"""Shear and bulk relaxation of a material, as Prony series."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact_scene import BulkRelaxation, Material
from fem_solver.prony import Prony
from fem_solver.series_modulus import OneModulus


@dataclass(frozen=True)
class Moduli:
    """Shear and bulk relaxation; ``bulk`` is ``None`` if incompressible."""

    shear: Prony
    bulk: Prony | None
    alike: bool

    @property
    def ratio(self) -> float:
        """Relaxed ``G/K``."""
        return 0.0 if self.bulk is None else self.shear.relaxed / self.bulk.relaxed

    @property
    def instantaneous_ratio(self) -> float:
        """Glassy ``G/K``."""
        if self.alike or self.bulk is None:
            return self.ratio
        return self.shear.glassy / self.bulk.glassy

    @property
    def unit_plane_modulus(self) -> float:
        """``E*`` of the glassy solid at unit shear modulus, ``2/(1 - nu)``."""
        ratio = self.instantaneous_ratio
        poisson = (3.0 - 2.0 * ratio) / (2.0 * (3.0 + ratio))
        return 2.0 / (1.0 - poisson)

    @property
    def surface(self) -> Prony:
        """``E*(t)`` over :attr:`unit_plane_modulus`, what the surface answers with (``series_modulus``)."""
        return self.shear if self.series is None else self.series.modulus

    @property
    def series(self) -> OneModulus | None:
        """``4 G`` and ``4 (3 K + G)/3`` as one, over :attr:`unit_plane_modulus`; ``None`` if all relax alike.

        The branches of the second are those of the bulk, then those of the shear.
        """
        if self.alike or self.bulk is None:
            return None
        unit = 4.0 / self.unit_plane_modulus
        joined = self.bulk.scaled(unit).plus(self.shear.scaled(unit / 3.0))
        return OneModulus(self.shear.scaled(unit), joined)


def moduli(material: Material) -> Moduli:
    """Shear modulus ``E(t)/(2 (1 + nu))`` and what ``material.bulk`` makes of the bulk modulus."""
    values, times = material.spectrum
    young = Prony(material.modulus, values, times)
    shear = young.scaled(0.5 / (1.0 + material.poisson))
    compressible = material.poisson < 0.5
    factor = 1.0 / (3.0 * (1.0 - 2.0 * material.poisson)) if compressible else math.inf
    if material.bulk is None:
        return Moduli(shear, young.scaled(factor) if compressible else None, True)
    none = np.zeros(0)
    if isinstance(material.bulk, BulkRelaxation):
        relaxed = material.bulk.modulus or material.modulus * factor
        branches = [branch for branch in material.bulk.branches if branch.modulus > 0.0]
        bulk = Prony(
            relaxed,
            np.array([b.modulus for b in branches], float),
            np.array([b.time for b in branches], float),
        )
    else:
        bulk = Prony(material.modulus * factor, none, none)
    return Moduli(shear, bulk, shear.times.size == 0 and bulk.times.size == 0)
