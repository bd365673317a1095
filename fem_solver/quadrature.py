"""History at quadrature points: shear and bulk may relax apart.

    ``dev s = G * 2 dev e(u)``,   ``-p = K * div u``   (hereditary products, see ``prony``)

Each step solves the half-space with the algorithmic moduli ``G_hat, K_hat`` of its size, loaded by the
stress that the past leaves, ``memory``, and by the forces on its surface. One factorisation serves every
distinct ratio; with a constant Poisson's ratio there is one only. In the mixed form the volume strain
``-div u`` lives in the pressure space, as its projection ``(p - p_memory)/K_hat``.

The far field follows its two scalars, ``G * e_1 = F`` and ``(3K + G) * e_2 = 3F``, by the same recursion.

Energies are volume integrals over springs and dashpots. The half-space outside the mesh holds
``-1/2 R . u`` with the reaction ``R`` of its boundary, taken branch by branch; for a constant Poisson's ratio
this is exact (Clapeyron), otherwise an approximation to a part of relative size ``a/R_far``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.halfspace import Factorisation, HalfSpace
from fem_solver.prony import Prony, RelaxingField

Array = NDArray[np.float64]
Form = Callable[[Array, Array], float]


@dataclass(frozen=True)
class QuadratureState:
    """Internal variables in the volume.

    Parameters
    ----------
    unknowns : ndarray, shape (unknowns,)
        Displacement and, in the mixed form, pressure.
    shear, volume : RelaxingField
    far : tuple of RelaxingField
        The two amplitudes of the far field.
    dissipated : float
        Energy dissipated in the branches so far.
    """

    unknowns: Array
    shear: RelaxingField
    volume: RelaxingField
    far: tuple[RelaxingField, RelaxingField]
    dissipated: float = 0.0


class QuadratureHistory:
    """Internal variables in the volume.

    Parameters
    ----------
    space : HalfSpace
    shear : Prony
    bulk : Prony or None
        ``None``: incompressible.
    count : int
        Number of surface nodes offered to the indenter.
    """

    def __init__(self, space: HalfSpace, shear: Prony, bulk: Prony | None, count: int) -> None:
        self.space, self.count = space, count
        self.shear_modulus, self.bulk_modulus = shear, bulk
        self.strain = forms.strain_operator(space.basis)
        weights = forms.volume_weights(space.basis)
        self._weights = np.concatenate([factor * weights.ravel() for factor in forms.CONTRACTION])
        self._points = weights.ravel()
        volume_size = space.pressure_basis.N if space.mixed else weights.size
        joined = shear if bulk is None else bulk.scaled(3.0).plus(shear)
        self.state = QuadratureState(
            unknowns=np.zeros(space.unknowns),
            shear=RelaxingField.at_rest(shear, self.strain.shape[0] + 2),
            # without compression the pressure is a reaction; it is split like the shear, for the energies
            volume=RelaxingField.at_rest(bulk or shear, volume_size + 2),
            far=(RelaxingField.at_rest(shear, 1), RelaxingField.at_rest(joined, 1)),
        )
        self._factors: dict[float, Factorisation] = {}
        self._weights_of_far = self._factor(self._ratio(np.inf)).compliance()[1]
        far_strain = [self._deviator(shape[: space.basis.N]) for shape in space.far_shapes]
        self._far_shear = np.stack([0.5 * self._weights * field for field in far_strain])
        self._far_volume = np.stack([self._volume_force(shape) for shape in space.far_shapes])

    def commit(self, dt: float, forces: Array) -> None:
        """Accept the step that ends with these surface forces.

        Parameters
        ----------
        dt : float
            Length of the step.
        forces : ndarray, shape (count,)
            Nodal forces at its end, compressive positive.
        """
        old, modulus, factor = (
            self.state,
            self.shear_modulus.increment(dt).modulus,
            self._factor(self._ratio(dt)),
        )
        load, far_memory = self._past(dt, modulus)
        load[self.space.surface_dofs[: self.count]] -= forces / modulus
        total = float(self._weights_of_far @ forces)
        amplitudes = far_memory + factor.far_mix * total / modulus
        unknowns = factor.solve(load, amplitudes)
        shear = old.shear.advanced(dt, np.append(2.0 * self._deviator(unknowns), amplitudes))
        volume = old.volume.advanced(dt, np.append(self._volume_strain(dt, unknowns, modulus), amplitudes))
        dissipated = old.dissipated
        if 0.0 < dt < np.inf:
            dissipated += self._loss(dt, old.shear, shear, self._shear_form)
            dissipated += self._loss(dt, old.volume, volume, self._volume_form)
        far = old.far[0].advanced(dt, amplitudes[:1]), old.far[1].advanced(dt, amplitudes[1:])
        self.state = QuadratureState(unknowns, shear, volume, far, dissipated)

    @property
    def displacement(self) -> Array:
        """Surface displacement, downwards; shape (count,)."""
        return -self.state.unknowns[self.space.surface_dofs[: self.count]]

    @property
    def stored_energy(self) -> float:
        """Energy of all springs, in shear and in volume."""
        state = self.state
        return self._stored(state.shear, self._shear_form) + self._stored(state.volume, self._volume_form)

    def _ratio(self, dt: float) -> float:
        if self.bulk_modulus is None:
            return 0.0
        ratio = self.shear_modulus.increment(dt).modulus / self.bulk_modulus.increment(dt).modulus
        return float(f"{ratio:.12e}")  # equal to round-off: the same factors

    def _factor(self, ratio: float) -> Factorisation:
        if ratio not in self._factors:
            self._factors[ratio] = self.space.factorise(ratio, self.count)
        return self._factors[ratio]

    def _past(self, dt: float, modulus: float) -> tuple[Array, Array]:
        """Load that the past leaves at the end of a step, and amplitudes of the far field."""
        space = self.space
        load = np.zeros(space.unknowns)
        stress = self.state.shear.memory(dt)[:-2]
        volume = self.state.volume.memory(dt)[:-2]
        if not space.mixed:
            stress = stress + np.concatenate([np.tile(volume, 3), np.zeros_like(volume)])
        elif self.bulk_modulus is not None:
            load[space.basis.N :] = -(space.mass @ volume) / self.bulk_modulus.increment(dt).modulus
        load[: space.basis.N] = -(self.strain.T @ (self._weights * stress)) / modulus
        far = [-part.memory(dt)[0] / part.modulus.increment(dt).modulus for part in self.state.far]
        if self.bulk_modulus is None:
            far[1] = 0.0
        return load, np.array(far)

    def _deviator(self, unknowns: Array) -> Array:
        strains = (self.strain @ unknowns[: self.space.basis.N]).reshape(4, -1)
        return forms.deviator(strains).ravel()

    def _volume_strain(self, dt: float, unknowns: Array, modulus: float) -> Array:
        """``div u`` at the points; in the mixed form the projection of ``-div u`` onto the pressures."""
        if not self.space.mixed:
            strains = (self.strain @ unknowns).reshape(4, -1)
            return strains[:3].sum(axis=0)
        pressure = modulus * unknowns[self.space.basis.N :]
        return (pressure - self.state.volume.memory(dt)[:-2]) / self.state.volume.modulus.increment(
            dt
        ).modulus

    def _volume_force(self, shape: Array) -> Array:
        """Work of a unit pressure-like field on a far shape, per entry of the volume field."""
        if self.space.mixed:
            return -(self.space.divergence @ shape[: self.space.basis.N])
        strains = (self.strain @ shape).reshape(4, -1)
        return self._points * strains[:3].sum(axis=0)

    def _shear_form(self, a: Array, b: Array) -> float:
        inner = 0.5 * float((self._weights * a[:-2]) @ b[:-2])
        outer = b[-2:] @ (self._far_shear @ a[:-2]) + a[-2:] @ (self._far_shear @ b[:-2])
        return inner - float(outer)

    def _volume_form(self, a: Array, b: Array) -> float:
        inner = 0.0
        if not self.space.mixed:
            inner = float((self._points * a[:-2]) @ b[:-2])
        elif self.bulk_modulus is not None:
            inner = float(a[:-2] @ (self.space.mass @ b[:-2]))
        outer = b[-2:] @ (self._far_volume @ a[:-2]) + a[-2:] @ (self._far_volume @ b[:-2])
        return inner - 0.5 * float(outer)

    @staticmethod
    def _stored(part: RelaxingField, form: Form) -> float:
        energy = part.modulus.relaxed * form(part.x, part.x)
        for branch, modulus in zip(part.branches, part.modulus.moduli, strict=True):
            energy += form(branch, branch) / modulus
        return 0.5 * energy

    @staticmethod
    def _loss(dt: float, old: RelaxingField, new: RelaxingField, form: Form) -> float:
        weights, change, total = old.modulus.loss_weights(dt), new.x - old.x, 0.0
        for k, (branch, modulus) in enumerate(zip(old.branches, old.modulus.moduli, strict=True)):
            forms_ = form(branch, branch) / modulus, form(branch, change), modulus * form(change, change)
            total += float(weights[:, k] @ forms_)
        return total
