"""Fields of a run whose mesh stays, from either kind of history.

Stress and strain components in the order ``(rr, zz, tt, rz)``, tension positive. The energy per volume
dissipated so far is quadratic in the history of the branch variables ``b_k`` (see ``elastic_body``),

    ``int Q(b_k)/(G_k tau_k) dt = sum_i Q(v_i)``,

with few vectors ``v_i`` (see ``modes``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fem_solver.fields.elastic_body import ElasticBody, with_volume
from fem_solver.fields.history import Form, SurfaceLog, VolumeLog, at_points, shear_form, volume_form
from fem_solver.fields.modes import LossModes
from fem_solver.fields.point_fields import PointFields, RowMesh, branch_names
from fem_solver.fields.recovery import Recovery
from fem_solver.prony import RelaxingField
from fem_solver.setup import Setup

Array = NDArray[np.float64]


class _OnOneMesh:
    """Fields of a run whose mesh stays: the mesh of every row."""

    factorisations = 1

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._mesh = RowMesh(Recovery(setup.space.basis), setup.radii, setup.height)
        self._before = setup.factor.solves

    @property
    def volume_solves(self) -> int:
        """Back-substitutions in the body so far."""
        return self._setup.factor.solves - self._before

    @property
    def linear_solves(self) -> int:
        """Projections onto the nodes so far."""
        return self._mesh.recovery.solves

    def mesh(self, row: int) -> RowMesh:
        """The mesh of a row."""
        return self._mesh


class CondensedFields(_OnOneMesh):
    """Fields by back-substitution from the surface history; rows in rising order."""

    def __init__(self, setup: Setup, log: SurfaceLog) -> None:
        super().__init__(setup)
        history = log.history
        self._body = ElasticBody(setup.space, setup.factor, setup.weights)
        self._log, self._shear = log, history.shear
        root = history.operator.root()
        self._modes = [LossModes(root) for _ in history.shear.times]
        self._lost = np.zeros((len(history.shear.times), self._body.points))
        self._row = -1
        self._image = np.zeros(len(history.operator.unit))
        self._branches = np.zeros((len(history.shear.times), len(self._image)))
        self.names = branch_names(history.shear)

    def at(self, row: int) -> PointFields:
        """Fields at a row, not before the last one requested."""
        self._replay(row)
        fields = self._body.relaxing(self._shear, self._image, self._branches)
        return replace(fields, dissipated=self._lost.copy())

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
                self._lost[k] += self._body.under(vector).twice_energy


class VolumeFields(_OnOneMesh):
    """Fields from internal variables at the quadrature points, for the stored rows."""

    def __init__(self, setup: Setup, log: VolumeLog) -> None:
        super().__init__(setup)
        history = log.history
        self._space, self._log = history.space, log
        self._strain = history.strain
        self.names = branch_names(history.shear_modulus, "shear")
        if history.bulk_modulus is not None:
            self.names += branch_names(history.bulk_modulus, "bulk")

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
