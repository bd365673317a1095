"""Fields at the quadrature points for forces on the surface where bulk relaxes apart from shear.

Under normal pressures the displacement of a half-space is ``A[p/(2 G)] + B[3 p/(2 (3 K + G))]``, where ``A``
changes no volume, so an elastic solid of unit shear modulus gives both: incompressible ``A[w/2]``, and
compressible that and ``B[3 w/(2 (3 K/G + 1))]``. In a relaxing solid either belongs to one of the two moduli
that the surface has in series (see ``series_modulus``), and a branch holds the fields of its springs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.fields.elastic_body import ElasticBody
from fem_solver.fields.point_fields import PointFields
from fem_solver.moduli import Moduli

Array = NDArray[np.float64]


class SeparateBody:
    """Two factorised half-spaces on one mesh.

    Parameters
    ----------
    incompressible, compressible : ElasticBody
        The second with the glassy ``G/K``.
    material : Moduli
    """

    def __init__(self, incompressible: ElasticBody, compressible: ElasticBody, material: Moduli) -> None:
        series, bulk = material.series, material.bulk
        if series is None or bulk is None:
            raise AssertionError("bulk relaxes like shear")
        self._incompressible, self._compressible = incompressible, compressible
        self._series, self._shear, self._bulk = series, material.shear, bulk
        self._unit = material.unit_plane_modulus
        ratio = compressible.factor.ratio
        self._forces_of_volume = 2.0 * (3.0 / ratio + 1.0) / 3.0

    @property
    def solves(self) -> int:
        """Back-substitutions so far."""
        return self._incompressible.factor.solves + self._compressible.factor.solves

    def relaxing(self, v: Array, b: Array, forces: Callable[[Array], Array], scale: float) -> PointFields:
        """The solid for the components of its surface, without the energy lost so far.

        Parameters
        ----------
        v : ndarray, shape (n,)
            Surface components.
        b : ndarray, shape (branches, n)
            Their branch variables.
        forces : callable(ndarray) -> ndarray
            Surface forces on a solid of unit shear modulus for components.
        scale : float
            As of :meth:`~fem_solver.fields.elastic_body.ElasticBody.under`.

        Returns
        -------
        PointFields
        """
        shear, bulk = self._shear, self._bulk
        in_shear, in_both = self._series.parts(v, b)
        unknowns, strain = self._strained(forces(in_shear.whole), forces(in_both.whole), scale)
        stress, stored = _spring(strain, shear.relaxed, bulk.relaxed)
        rates, parts = [], []
        count, nothing = len(bulk.times), np.zeros_like(v)
        for k, (modulus, time) in enumerate(zip(shear.moduli, shear.times, strict=True)):
            parts.append((in_shear.springs[k], in_both.springs[count + k], modulus, 0.0, time))
        for k, (modulus, time) in enumerate(zip(bulk.moduli, bulk.times, strict=True)):
            parts.append((nothing, in_both.springs[k], 0.0, modulus, time))
        for one, other, shear_modulus, bulk_modulus, time in parts:
            _, held = self._strained(forces(one), forces(other), scale)
            borne, energy = _spring(held, shear_modulus, bulk_modulus)
            stress, stored = stress + borne, stored + energy
            rates.append(2.0 * energy / time)
        return PointFields(
            unknowns, stress, strain, stored, np.array(rates).reshape(len(rates), stored.size), None
        )

    def _strained(self, of_shear: Array, of_both: Array, scale: float) -> tuple[Array, Array]:
        """Displacement and strain of surface forces that belong to the two moduli of the surface."""
        beside = 2.0 * self._forces_of_volume / self._unit * of_both
        one = self._incompressible.under(4.0 / self._unit * of_shear - beside, scale)
        other = self._compressible.under(beside, scale)
        count = self._compressible.space.basis.N
        return one.unknowns[:count] + other.unknowns[:count], one.strain + other.strain


def _spring(strain: Array, shear: float, bulk: float) -> tuple[Array, Array]:
    """Stress (4, points) and energy density (points,) of an elastic strain (4, points)."""
    deviator, dilatation = forms.deviator(strain), strain[:3].sum(axis=0)
    stress = 2.0 * shear * deviator
    stress[:3] += bulk * dilatation
    energy = shear * np.einsum("i,ip,ip->p", forms.CONTRACTION, deviator, deviator)
    return stress, energy + 0.5 * bulk * dilatation**2
