"""A run once more, by internal variables at the quadrature points of the whole body.

The surface components of a run and the internal variables of the volume follow the same Prony update, the
former in vectors on the surface, the latter in strains at points:

    ``dev s = G * 2 dev e(u)``,   ``-p = K * div u``   (hereditary products, see ``moduli``).

Here the nodal forces of a run go row by row through the volume, which knows of no contact, of no edge and of
no component: it answers with the displacement of the surface and with the energies that it has stored and
lost. Forces are linear neither in time nor in the edge between two rows, and radii within a node are not in
its force: what is left goes with rows and nodes, refined together.

Each step solves the half-space with the algorithmic moduli ``G_hat, K_hat`` of its size, loaded by the
stress that the past leaves, ``memory``, and by the forces on its surface. One factorisation serves every
distinct ratio; with a constant Poisson's ratio there is one only. The volume strain ``-div u`` lives in the
pressure space, as its projection ``(p - p_memory)/K_hat``. The far field follows its two scalars,
``G * e_1 = F`` and ``(3K + G) * e_2 = 3F``, by the same recursion.

Energies are volume integrals over springs and dashpots. The half-space outside the mesh holds
``-1/2 R . u`` with the reaction ``R`` of its boundary, taken branch by branch; for a constant Poisson's ratio
this is exact (Clapeyron), otherwise an approximation to a part of relative size ``a/R_far``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import SceneError
from fem_solver import forms
from fem_solver.halfspace import Factorisation, HalfSpace
from fem_solver.moduli import Prony
from fem_solver.recorder import Recording
from fem_solver.state import nodal_forces

Array = NDArray[np.float64]
Form = Callable[[Array, Array], float]


@dataclass(frozen=True)
class RelaxingField:
    """A relaxing modulus with the strain-like ``x`` (m,) it acts on and its ``branches`` (branches, m)."""

    modulus: Prony
    x: Array
    branches: Array

    @classmethod
    def at_rest(cls, modulus: Prony, size: int) -> RelaxingField:
        """Undeformed."""
        return cls(modulus, np.zeros(size), np.zeros((len(modulus.times), size)))

    def memory(self, dt: float) -> Array:
        """Stress that the past leaves at the end of a step."""
        return self.modulus.increment(dt).memory(self.branches, self.x)

    def advanced(self, dt: float, x: Array) -> RelaxingField:
        """State at the end of a step."""
        return RelaxingField(self.modulus, x, self.modulus.increment(dt).advance(self.branches, x - self.x))


@dataclass(frozen=True)
class QuadratureState:
    """Nodal unknowns, internal variables in shear and volume and of both amplitudes of the far field, and the
    energy dissipated in the branches so far."""

    unknowns: Array
    shear: RelaxingField
    volume: RelaxingField
    far: tuple[RelaxingField, RelaxingField]
    dissipated: float = 0.0


class QuadratureHistory:
    """Internal variables in the volume, of which ``count`` surface nodes are offered to the indenter."""

    def __init__(self, space: HalfSpace, shear: Prony, bulk: Prony | None, count: int) -> None:
        self.space, self.count = space, count
        self.shear_modulus, self.bulk_modulus = shear, bulk
        self.strain = forms.strain_operator(space.basis)
        weights = forms.volume_weights(space.basis)
        self._weights = np.concatenate([factor * weights.ravel() for factor in forms.CONTRACTION])
        joined = shear if bulk is None else bulk.scaled(3.0).plus(shear)
        self.state = QuadratureState(
            unknowns=np.zeros(space.unknowns),
            shear=RelaxingField.at_rest(shear, self.strain.shape[0] + 2),
            # without compression the pressure is a reaction; it is split like the shear, for the energies
            volume=RelaxingField.at_rest(bulk or shear, space.pressure_basis.N + 2),
            far=(RelaxingField.at_rest(shear, 1), RelaxingField.at_rest(joined, 1)),
        )
        self._factors: dict[float, Factorisation] = {}
        self._weights_of_far = self._factor(self._ratio(np.inf)).compliance()[1]
        far_strain = [self._deviator(shape[: space.basis.N]) for shape in space.far_shapes]
        self._far_shear = np.stack([0.5 * self._weights * field for field in far_strain])
        self._far_volume = np.stack(
            [-(space.divergence @ shape[: space.basis.N]) for shape in space.far_shapes]
        )

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
        if self.bulk_modulus is not None:
            volume = self.state.volume.memory(dt)[:-2]
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
        """Projection of ``-div u`` onto the pressures."""
        pressure = modulus * unknowns[self.space.basis.N :]
        return (pressure - self.state.volume.memory(dt)[:-2]) / self.state.volume.modulus.increment(
            dt
        ).modulus

    def _shear_form(self, a: Array, b: Array) -> float:
        inner = 0.5 * float((self._weights * a[:-2]) @ b[:-2])
        outer = b[-2:] @ (self._far_shear @ a[:-2]) + a[-2:] @ (self._far_shear @ b[:-2])
        return inner - float(outer)

    def _volume_form(self, a: Array, b: Array) -> float:
        inner = 0.0 if self.bulk_modulus is None else float(a[:-2] @ (self.space.mass @ b[:-2]))
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


@dataclass(frozen=True)
class VolumeAnswer:
    """What the volume answers to the forces of a run, and what the surface has said; by row.

    ``apart`` is the largest difference of a node's displacement, over the largest displacement of the run;
    ``stored`` and ``dissipated`` are energies (2, rows) of the body by the volume, and by the surface.
    """

    time: Array
    apart: Array
    stored: Array
    dissipated: Array

    @property
    def errors(self) -> dict[str, float]:
        """Root mean square over the rows, of energies relative to their largest."""
        found = {"displacement": _rms(self.apart)}
        for name, (volume, surface) in (("stored", self.stored), ("dissipated", self.dissipated)):
            largest = float(np.abs(surface).max())
            found[name] = _rms(volume - surface) / largest if largest > 0.0 else 0.0
        return found


def volume(recording: Recording) -> QuadratureHistory:
    """The undeformed volume of a run, on its mesh; ``SceneError`` if that moves: variables at points of one
    mesh are none of another's."""
    setup, places = recording.setup, {step.end.place for step in recording.steps}
    if len(places) != 1:
        raise SceneError("adhesion.zone", "the mesh follows the edge, whose zone is short", "a longer zone")
    space, count = setup.surfaces.volume(places.pop())
    return QuadratureHistory(space, setup.material.shear, setup.material.bulk, count)


def replayed(recording: Recording) -> VolumeAnswer:
    """Put the forces of a run through the volume.

    Parameters
    ----------
    recording : Recording
        Of every row, on one mesh that stays.

    Returns
    -------
    VolumeAnswer

    Raises
    ------
    SceneError
        As of :func:`volume`.
    """
    setup, steps, rows = recording.setup, recording.steps, recording.surfaces
    history, here = volume(recording), setup.surfaces.at(steps[0].end.place)
    apart, stored, dissipated, largest = [], [], [], 0.0
    for step, row in zip(steps, rows, strict=True):  # forces displace a mesh of unit scale by as much more
        history.commit(step.dt, nodal_forces(step.end, here, setup.solid) / here.scale)
        displacement = here.displacement(step.end.components)
        apart.append(float(np.abs(history.displacement - displacement).max()))
        largest = max(largest, float(np.abs(displacement).max()))
        stored.append((here.scale * history.stored_energy, row.stored))
        dissipated.append((here.scale * history.state.dissipated, row.branch_dissipation))
    return VolumeAnswer(
        np.array([row.time for row in rows]),
        np.array(apart) / largest,
        np.array(stored).T,
        np.array(dissipated).T,
    )


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))
