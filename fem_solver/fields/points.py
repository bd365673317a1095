"""Fields at the quadrature points, from either kind of history.

Stress and strain components in the order ``(rr, zz, tt, rz)``, tension positive. With the constant Poisson's
ratio of the condensed path the surface forces ``f = G_0 w + sum_k b_k`` and the branch variables ``b_k`` are
loads on one elastic solid of unit shear modulus, so each gives a stress field by one back-substitution, and

    ``Q(s, s) = dev s : dev s/2 + (G/K) p^2``

is twice the energy density of such a field (``p``: the pressure). Stored energy density
``G_0 Q(w)/2 + sum_k Q(b_k)/(2 G_k)``; dissipation rate density of a branch ``Q(b_k)/(G_k tau_k)``. The energy
per volume dissipated so far is quadratic in the history of ``b_k``,

    ``int Q(b_k)/(G_k tau_k) dt = sum_i Q(v_i)``,

with few vectors ``v_i`` (see ``modes``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver import forms
from fem_solver.fields.history import Form, SurfaceLog, VolumeLog, at_points, shear_form, volume_form
from fem_solver.fields.modes import LossModes
from fem_solver.prony import RelaxingField
from fem_solver.setup import Setup

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointFields:
    """State of the body at the quadrature points.

    ``unknowns`` are nodal; ``stress`` and ``strain`` (4, points), ``stored`` (points,), ``rates`` and
    ``dissipated`` (branches, points).
    """

    unknowns: Array
    stress: Array
    strain: Array
    stored: Array
    rates: Array
    dissipated: Array


def with_volume(strain: Array, dilatation: Array | float) -> Array:
    """The strain with another volume strain: in the mixed form that of the pressure is the better one."""
    result = forms.deviator(strain)
    result[:3] += dilatation / 3.0
    return result


class CondensedFields:
    """Fields by back-substitution from the surface history; rows in rising order."""

    def __init__(self, setup: Setup, log: SurfaceLog) -> None:
        history = log.history
        self._setup, self._log, self._shear = setup, log, history.shear
        self._strain = forms.strain_operator(setup.space.basis)
        self._points = self._strain.shape[0] // 4
        root = history.operator.root()
        self._modes = [LossModes(root) for _ in history.shear.times]
        self._lost = np.zeros((len(history.shear.times), self._points))
        self._row = -1
        self._image = np.zeros(len(history.operator.unit))
        self._branches = np.zeros((len(history.shear.times), len(self._image)))
        self.names = tuple(f"tau={time:.6g}" for time in history.shear.times)

    def at(self, row: int) -> PointFields:
        """Fields at a row, not before the last one requested."""
        self._replay(row)
        shear, image, branches = self._shear, self._image, self._branches
        unknowns = self._setup.body(image)
        unit, strain = self._stress(unknowns), self._strains(unknowns)
        if self._setup.space.mixed:
            strain = with_volume(strain, -self._setup.factor.ratio * self._pressure(unknowns))
        stress, stored = shear.relaxed * unit, 0.5 * shear.relaxed * self._twice_energy(unit)
        rates = np.zeros_like(self._lost)
        for k, (modulus, time) in enumerate(zip(shear.moduli, shear.times, strict=True)):
            part = self._stress(self._setup.body(branches[k]))
            energy = self._twice_energy(part) / modulus
            stress, stored, rates[k] = stress + part, stored + 0.5 * energy, energy / time
        return PointFields(unknowns, stress, strain, stored, rates, self._lost.copy())

    def _replay(self, row: int) -> None:
        if row < self._row:
            raise ValueError(f"row {row} requested after row {self._row}")
        for dt, image in self._log.steps[self._row + 1 : row + 1]:
            step, change = self._shear.increment(dt), image - self._image
            if 0.0 < dt < np.inf:
                weights = self._shear.loss_weights(dt)
                for k, modes in enumerate(self._modes):
                    modes.add(weights[:, k], self._shear.moduli[k], self._branches[k], change)
            self._branches = step.advance(self._branches, change)
            self._image = image
        self._row = row
        for k, modes in enumerate(self._modes):
            for vector in modes.take():
                self._lost[k] += self._twice_energy(self._stress(self._setup.body(vector)))

    def _strains(self, unknowns: Array) -> Array:
        return (self._strain @ unknowns[: self._setup.space.basis.N]).reshape(4, -1)

    def _stress(self, unknowns: Array) -> Array:
        """Stress in a solid of unit shear modulus."""
        strain = self._strains(unknowns)
        stress = 2.0 * forms.deviator(strain)
        if self._setup.space.mixed:
            stress[:3] -= self._pressure(unknowns)
        else:
            stress[:3] += strain[:3].sum(axis=0) / self._setup.factor.ratio
        return stress

    def _pressure(self, unknowns: Array) -> Array:
        space = self._setup.space
        return at_points(space, unknowns[space.basis.N :])

    def _twice_energy(self, stress: Array) -> Array:
        pressure, shear = stress[:3].mean(axis=0), forms.deviator(stress)
        return 0.5 * np.einsum("i,ip,ip->p", forms.CONTRACTION, shear, shear) + (
            self._setup.factor.ratio * pressure**2
        )


class VolumeFields:
    """Fields from internal variables at the quadrature points, for the stored rows."""

    def __init__(self, log: VolumeLog) -> None:
        history = log.history
        self._space, self._log = history.space, log
        self._strain = history.strain
        self.names = tuple(f"shear tau={time:.6g}" for time in history.shear_modulus.times)
        if history.bulk_modulus is not None:
            self.names += tuple(f"bulk tau={time:.6g}" for time in history.bulk_modulus.times)

    def at(self, row: int) -> PointFields:
        """Fields at a stored row."""
        recorded, space = self._log[row], self._space
        state = recorded.internal
        total = [
            part.modulus.relaxed * part.x + part.branches.sum(axis=0) for part in (state.shear, state.volume)
        ]
        stress = total[0][:-2].reshape(4, -1).copy()
        pressure = at_points(space, total[1][:-2])
        stress[:3] += -pressure if space.mixed else pressure
        strain = (self._strain @ state.unknowns[: space.basis.N]).reshape(4, -1)
        if space.mixed:
            dilatation = 0.0 if self._log.incompressible else -at_points(space, state.volume.x[:-2])
            strain = with_volume(strain, dilatation)
        stored, rates = np.zeros(stress.shape[1]), []
        parts: list[tuple[RelaxingField, Form]] = [(state.shear, shear_form)]
        if not self._log.incompressible:
            parts.append((state.volume, volume_form(space)))
        for part, form in parts:
            stored += 0.5 * part.modulus.relaxed * form(part.x, part.x)
            for branch, modulus, time in zip(
                part.branches, part.modulus.moduli, part.modulus.times, strict=True
            ):
                energy = form(branch, branch) / modulus
                stored += 0.5 * energy
                rates.append(energy / time)
        return PointFields(
            state.unknowns,
            stress,
            strain,
            stored,
            np.array(rates).reshape(len(self.names), stored.size),
            recorded.dissipated,
        )
