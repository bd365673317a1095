"""History at quadrature points: shear and bulk may relax apart.

    ``dev s = G * 2 dev e(u)``,   ``-p = K * div u``   (hereditary products, see ``prony``)

Each step solves the half-space with the algorithmic moduli ``G_hat, K_hat`` of its size, loaded by the
stress that the past leaves, ``memory``; the surface sees ``u = free + C(G_hat/K_hat) f/G_hat``. One
factorisation and one surface compliance are kept for every distinct ratio; with a constant Poisson's ratio
there is one only. In the mixed form the volume strain ``-div u`` lives in the pressure space, as its
projection ``(p - p_memory)/K_hat``.

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
from fem_solver.condensed import Response
from fem_solver.halfspace import Factorisation, HalfSpace
from fem_solver.prony import Prony
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]
Form = Callable[[Array, Array], float]


@dataclass(frozen=True)
class Relaxing:
    """A modulus with its strain-like vector and branch variables.

    The vector holds a field and, behind it, the two far amplitudes; ``branches`` has shape (branches, m).
    """

    modulus: Prony
    x: Array
    branches: Array

    @classmethod
    def at_rest(cls, modulus: Prony, size: int) -> Relaxing:
        """Undeformed."""
        return cls(modulus, np.zeros(size), np.zeros((len(modulus.times), size)))

    def memory(self, dt: float) -> Array:
        """Stress that the past leaves at the end of a step."""
        return self.modulus.increment(dt).memory(self.branches, self.x)

    def advanced(self, dt: float, x: Array) -> Relaxing:
        """State at the end of a step."""
        return Relaxing(self.modulus, x, self.modulus.increment(dt).advance(self.branches, x - self.x))


@dataclass(frozen=True)
class Pending:
    """What a step needs again when it is accepted."""

    dt: float
    modulus: float
    ratio: float
    load: Array
    far_memory: Array


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
        measure = forms.measure(space.basis)
        self._measure = np.concatenate([weight * measure.ravel() for weight in forms.CONTRACTION])
        self._points = measure.ravel()
        self.shear = Relaxing.at_rest(shear, self.strain.shape[0] + 2)
        volume_size = space.pressure_basis.N if space.mixed else measure.size
        # without compression the pressure is a reaction; it is split like the shear, for the energies
        self.volume = Relaxing.at_rest(bulk or shear, volume_size + 2)
        joined = shear if bulk is None else bulk.scaled(3.0).plus(shear)
        self.far = (Relaxing.at_rest(shear, 1), Relaxing.at_rest(joined, 1))
        self.unknowns = np.zeros(space.unknowns)
        self._operators: dict[float, tuple[Factorisation, SurfaceOperator]] = {}
        self.weights: Array = np.zeros(0)
        self._pending: Pending | None = None
        #: of the relaxed solid
        self.factor, self.operator = self._operator(self._ratio(np.inf))
        far_strain = [self._deviator(shape[: space.basis.N]) for shape in space.far_shapes]
        self._far_shear = np.stack([0.5 * self._measure * field for field in far_strain])
        self._far_volume = np.stack([self._volume_force(shape) for shape in space.far_shapes])
        self.dissipated = 0.0
        self.updates = 0

    @property
    def state(self) -> tuple[Array, Relaxing, Relaxing]:
        """Unknowns, shear and volume history."""
        return self.unknowns, self.shear, self.volume

    @property
    def volume_solves(self) -> int:
        """Back-substitutions in the volume so far."""
        return sum(factor.solves for factor, _ in self._operators.values())

    @property
    def solves(self) -> dict[float, int]:
        """Back-substitutions so far, by ratio of moduli."""
        return {ratio: factor.solves for ratio, (factor, _) in self._operators.items()}

    def factorise_again(self, solves: dict[float, int]) -> None:
        """The factors that a run had made when it was kept, and the work it had done with them."""
        for ratio, count in solves.items():
            self._operator(ratio)[0].solves = count

    @property
    def factorisations(self) -> int:
        """Factorisations so far."""
        return len(self._operators)

    @property
    def instantaneous(self) -> SurfaceOperator:
        """Surface of the glassy solid."""
        return self._operator(self._ratio(0.0))[1]

    def respond(self, dt: float) -> Response:
        """Response to forces at the end of a step; changes nothing."""
        pending = self._prepare(dt)
        factor, operator = self._operator(pending.ratio)
        free = factor.solve(pending.load, pending.far_memory)
        return Response(operator, pending.modulus, -free[self.space.surface_dofs[: self.count]])

    def commit(self, dt: float, response: Response, forces: Array) -> None:
        """Accept the step that ends with these surface forces."""
        pending = self._prepare(dt)
        modulus = pending.modulus
        factor, _ = self._operator(pending.ratio)
        load = pending.load.copy()
        load[self.space.surface_dofs[: self.count]] -= forces / modulus
        total = float(self.weights @ forces)
        amplitudes = pending.far_memory + factor.far_mix * total / modulus
        unknowns = factor.solve(load, amplitudes)
        shear = self.shear.advanced(dt, np.append(2.0 * self._deviator(unknowns), amplitudes))
        volume = self.volume.advanced(dt, np.append(self._volume_strain(dt, unknowns, modulus), amplitudes))
        if 0.0 < dt < np.inf:
            self.dissipated += self._loss(dt, self.shear, shear, self._shear_form)
            self.dissipated += self._loss(dt, self.volume, volume, self._volume_form)
        self.shear, self.volume, self.unknowns = shear, volume, unknowns
        first, second = self.far
        self.far = first.advanced(dt, amplitudes[:1]), second.advanced(dt, amplitudes[1:])
        self._pending = None
        self.updates += 1

    @property
    def displacement(self) -> Array:
        """Surface displacement, downwards; shape (count,)."""
        return -self.unknowns[self.space.surface_dofs[: self.count]]

    @property
    def stored_energy(self) -> float:
        """Energy of all springs, in shear and in volume."""
        return self._stored(self.shear, self._shear_form) + self._stored(self.volume, self._volume_form)

    def _ratio(self, dt: float) -> float:
        if self.bulk_modulus is None:
            return 0.0
        ratio = self.shear_modulus.increment(dt).modulus / self.bulk_modulus.increment(dt).modulus
        return float(f"{ratio:.12e}")  # so that equal moduli count as equal

    def _operator(self, ratio: float) -> tuple[Factorisation, SurfaceOperator]:
        if ratio not in self._operators:
            factor = self.space.factorise(ratio)
            compliance, self.weights = factor.compliance(
                self.count, self.weights if self.weights.size else None
            )
            self._operators[ratio] = factor, SurfaceOperator(compliance)
        return self._operators[ratio]

    def _prepare(self, dt: float) -> Pending:
        if self._pending is not None and self._pending.dt == dt:
            return self._pending
        modulus = self.shear_modulus.increment(dt).modulus
        space = self.space
        load = np.zeros(space.unknowns)
        stress = self.shear.memory(dt)[:-2]
        volume = self.volume.memory(dt)[:-2]
        if not space.mixed:
            stress = stress + np.concatenate([np.tile(volume, 3), np.zeros_like(volume)])
        elif self.bulk_modulus is not None:
            load[space.basis.N :] = -(space.mass @ volume) / self.bulk_modulus.increment(dt).modulus
        load[: space.basis.N] = -(self.strain.T @ (self._measure * stress)) / modulus
        far = [-part.memory(dt)[0] / part.modulus.increment(dt).modulus for part in self.far]
        if self.bulk_modulus is None:
            far[1] = 0.0
        self._pending = Pending(dt, modulus, self._ratio(dt), load, np.array(far))
        return self._pending

    def _deviator(self, unknowns: Array) -> Array:
        strains = (self.strain @ unknowns[: self.space.basis.N]).reshape(4, -1)
        return forms.deviator(strains).ravel()

    def _volume_strain(self, dt: float, unknowns: Array, modulus: float) -> Array:
        """``div u`` at the points; in the mixed form the projection of ``-div u`` onto the pressures."""
        if not self.space.mixed:
            strains = (self.strain @ unknowns).reshape(4, -1)
            return strains[:3].sum(axis=0)
        pressure = modulus * unknowns[self.space.basis.N :]
        return (pressure - self.volume.memory(dt)[:-2]) / self.volume.modulus.increment(dt).modulus

    def _volume_force(self, shape: Array) -> Array:
        """Work of a unit pressure-like field on a far shape, per entry of the volume field."""
        if self.space.mixed:
            return -(self.space.divergence @ shape[: self.space.basis.N])
        strains = (self.strain @ shape).reshape(4, -1)
        return self._points * strains[:3].sum(axis=0)

    def _shear_form(self, a: Array, b: Array) -> float:
        inner = 0.5 * float((self._measure * a[:-2]) @ b[:-2])
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
    def _stored(part: Relaxing, form: Form) -> float:
        energy = part.modulus.relaxed * form(part.x, part.x)
        for branch, modulus in zip(part.branches, part.modulus.moduli, strict=True):
            energy += form(branch, branch) / modulus
        return 0.5 * energy

    @staticmethod
    def _loss(dt: float, old: Relaxing, new: Relaxing, form: Form) -> float:
        weights, change, total = old.modulus.loss_weights(dt), new.x - old.x, 0.0
        for k, (branch, modulus) in enumerate(zip(old.branches, old.modulus.moduli, strict=True)):
            forms_ = form(branch, branch) / modulus, form(branch, change), modulus * form(change, change)
            total += float(weights[:, k] @ forms_)
        return total
