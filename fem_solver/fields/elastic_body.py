"""Fields at the quadrature points for forces on the surface, by one back-substitution each.

Stress and strain components in the order ``(rr, zz, tt, rz)``, tension positive. With a constant Poisson's
ratio the surface forces ``f = G_0 w + sum_k b_k`` and the branch variables ``b_k`` are loads on one elastic
solid of unit shear modulus, so each gives a stress field, and

    ``Q(s, s) = dev s : dev s/2 + (G/K) p^2``

is twice the energy density of such a field (``p``: the pressure). Stored energy density
``G_0 Q(w)/2 + sum_k Q(b_k)/(2 G_k)``; dissipation rate density of a branch ``Q(b_k)/(G_k tau_k)``.

The mesh may stand for one that is ``scale`` times as large: the same forces displace that ``1/scale`` and
stress it ``1/scale^2`` times as much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.fields.history import at_points
from fem_solver.fields.point_fields import PointFields
from fem_solver.halfspace import Factorisation, HalfSpace
from fem_solver.prony import Prony

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ElasticState:
    """An elastic solid of unit shear modulus under surface forces.

    Parameters
    ----------
    unknowns : ndarray
        Displacement at the nodes, then, in the mixed form, what is not to be read from here.
    stress, strain : ndarray, shape (4, points)
    twice_energy : ndarray, shape (points,)
        ``Q``.
    """

    unknowns: Array
    stress: Array
    strain: Array
    twice_energy: Array


class ElasticBody:
    """A factorised half-space of constant Poisson's ratio.

    Parameters
    ----------
    space : HalfSpace
    factor : Factorisation
    weights : ndarray, shape (n,)
        Weights of the forces on the first n surface nodes in the far field.
    """

    def __init__(self, space: HalfSpace, factor: Factorisation, weights: Array) -> None:
        self.space, self.factor, self._weights = space, factor, weights
        self._strain = forms.strain_operator(space.basis)
        self.points: int = self._strain.shape[0] // 4

    @property
    def solves(self) -> int:
        """Back-substitutions so far."""
        return self.factor.solves

    def unknowns(self, forces: Array) -> Array:
        """Unknowns of the mesh for unit shear modulus.

        Parameters
        ----------
        forces : ndarray, shape (m,)
            On the first surface nodes, compressive positive.

        Returns
        -------
        ndarray, shape (unknowns,)
        """
        load = np.zeros(self.space.unknowns)
        load[self.space.surface_dofs[: len(forces)]] = -forces
        return self.factor.solve(load, self.factor.far_mix * float(self._weights[: len(forces)] @ forces))

    def under(self, forces: Array, scale: float = 1.0) -> ElasticState:
        """The solid under surface forces, on the mesh ``scale`` times as large.

        Parameters
        ----------
        forces : ndarray, shape (m,)
            On the first surface nodes, compressive positive.
        scale : float

        Returns
        -------
        ElasticState
        """
        unknowns, ratio, space = self.unknowns(forces), self.factor.ratio, self.space
        displacement, shrinks = unknowns[: space.basis.N], scale**-2
        strain = shrinks * (self._strain @ displacement).reshape(4, -1)
        stress = 2.0 * forms.deviator(strain)
        if space.mixed:
            pressure = shrinks * at_points(space, unknowns[space.basis.N :])
            strain = with_volume(strain, -ratio * pressure)
            stress[:3] -= pressure
        else:
            stress[:3] += strain[:3].sum(axis=0) / ratio
        return ElasticState(unknowns / scale, stress, strain, self._twice_energy(stress))

    def relaxing(self, shear: Prony, image: Array, branches: Array, scale: float = 1.0) -> PointFields:
        """The relaxing solid for surface vectors, without the energy lost so far.

        Parameters
        ----------
        shear : Prony
        image : ndarray, shape (m,)
            ``w``: forces that cause the present displacement in a solid of unit shear modulus.
        branches : ndarray, shape (branches, m)
            ``b_k``.
        scale : float
            As of :meth:`under`.

        Returns
        -------
        PointFields
        """
        whole = self.under(image, scale)
        stress, stored = shear.relaxed * whole.stress, 0.5 * shear.relaxed * whole.twice_energy
        rates = np.zeros((len(branches), self.points))
        for k, (modulus, time) in enumerate(zip(shear.moduli, shear.times, strict=True)):
            part = self.under(branches[k], scale)
            energy = part.twice_energy / modulus
            stress, stored, rates[k] = stress + part.stress, stored + 0.5 * energy, energy / time
        return PointFields(whole.unknowns, stress, whole.strain, stored, rates, None)

    def _twice_energy(self, stress: Array) -> Array:
        pressure, shear = stress[:3].mean(axis=0), forms.deviator(stress)
        return 0.5 * np.einsum("i,ip,ip->p", forms.CONTRACTION, shear, shear) + (
            self.factor.ratio * pressure**2
        )


def with_volume(strain: Array, dilatation: Array | float) -> Array:
    """The strain with another volume strain: in the mixed form that of the pressure is the better one."""
    result = forms.deviator(strain)
    result[:3] += dilatation / 3.0
    return result
