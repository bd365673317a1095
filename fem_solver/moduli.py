"""Shear and bulk relaxation of a material as Prony series, and the one modulus of its surface.

A frictionless surface answers with ``1/E* = 1/(4 G) + 3/(4 (3 K + G))``, two moduli in series, whatever
relaxes; as one, ``G``, where all relax alike. The energies are those of the body: what ``1/(2 G)`` answers to
the pressures of the surface changes no volume, what ``3/(2 (3 K + G))`` answers does, and holds a third of
its shear energy beside it; neither works on the other, and each energy is a multiple of the same form of the
pressures (by Clapeyron's theorem, from the derivatives of ``1/E*`` with respect to G and K).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import BulkRelaxation, Material
from fem_solver.prony import Prony

Array = NDArray[np.float64]

_LEAST_SHARE = 1e-14
"""Modulus of a branch, relative to the glassy one, that is a rounding error."""


class OneModulus:
    """Two moduli that bear the same stress, as one of the sum of their strains.

    The energy of springs and dashpots over the strain ``x`` and those ``q`` of the dashpots of both,
    ``m(0) x^2/2 - x g.q + q.H q/2`` once the strain of the first modulus is eliminated, with the loss
    ``sum_k m_k tau_k q_k'^2``: in the eigenvectors of ``H`` with respect to that loss each internal variable
    goes its own way, as in a Maxwell branch, with the same energies. What no strain reaches is left out.

    Parameters
    ----------
    one, other : Prony

    Attributes
    ----------
    modulus : Prony
    """

    def __init__(self, one: Prony, other: Prony) -> None:
        whole = one.glassy + other.glassy
        self._share = other.glassy / whole  # of the strain, taken by the first modulus in a jump
        self._count = len(one.moduli)
        coupling = np.append(self._share * one.moduli, (1.0 - self._share) * other.moduli)
        self._signed = np.append(one.moduli, -other.moduli) / whole
        stiffness = np.diag(np.append(one.moduli, other.moduli))
        stiffness -= whole * np.outer(self._signed, self._signed)
        root = np.sqrt(np.append(one.moduli * one.times, other.moduli * other.times))
        rates, modes = np.linalg.eigh(stiffness / np.outer(root, root))
        amplitudes = modes.T @ (coupling / root)
        moduli = amplitudes**2 / rates
        reached = moduli > _LEAST_SHARE * one.glassy * self._share
        relaxed = one.relaxed * other.relaxed / (one.relaxed + other.relaxed)
        self.modulus = Prony(relaxed, moduli[reached], 1.0 / rates[reached])
        self._dashpots = (modes[:, reached] * (amplitudes / rates)[reached]) / root[:, None]

    def parts(self, x: Array, branches: Array) -> tuple[StrainedModulus, StrainedModulus]:
        """What both moduli have gone through."""
        dashpots = self._dashpots @ (x - branches / self.modulus.moduli[:, None])
        first = self._share * x + self._signed @ dashpots
        own, others = dashpots[: self._count], dashpots[self._count :]
        return StrainedModulus(first, first - own), StrainedModulus(x - first, x - first - others)


@dataclass(frozen=True)
class StrainedModulus:
    """Strain of a modulus, shape (n,), and of the springs of its branches, (branches, n)."""

    whole: Array
    springs: Array


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
