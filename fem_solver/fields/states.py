"""Stress, strain, energy and dissipation under the surface at requested rows of a run.

Coordinates ``(r, z)``, the body in ``z <= 0``; displacement along them. Stress and strain are positive in
tension and have the components ``(rr, zz, tt, rz)``, ``tt`` being the hoop and ``rz`` the tensor shear.
Surface quantities are those of :class:`contact_scene.SurfaceProfile`: displacement positive downwards.
Units are the scene's. The work done here is added to the counters of the trace.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import SurfaceProfile
from fem_solver.fields.fixed_mesh import CondensedFields, VolumeFields
from fem_solver.fields.following_log import FollowingLog
from fem_solver.fields.following_mesh import FollowingFields
from fem_solver.fields.history import HistoryLog, SurfaceLog, VolumeLog
from fem_solver.fields.point_fields import FieldSource
from fem_solver.fields.recording import Recording
from fem_solver.following.setup import FollowingSetup
from fem_solver.profiles import profile
from fem_solver.setup import Setup

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FieldState:
    """The whole body at one row of the trace.

    Nodal arrays have n columns, arrays over finite elements m; B is the number of branches.

    Parameters
    ----------
    row : int
        Of the trace.
    time, penetration, force, contact_radius : float
    label : str
        Name of the moment, "" if it has none.
    branches : tuple of str
        Names of the branches, in the order of the dissipation arrays.
    points : ndarray, shape (n, 2)
        ``(r, z)`` of the undeformed body.
    triangles : ndarray of int, shape (4 m, 3)
        Finite elements cut in four; triangle i lies in element ``i % m``.
    displacement : ndarray, shape (n, 2)
        ``(u_r, u_z)``.
    stress, strain : ndarray, shape (4, n)
        Components ``rr, zz, tt, rz``.
    stored_energy_density : ndarray, shape (n,)
        Energy of all springs per volume.
    dissipation_rate : ndarray, shape (B, n)
        Power per volume lost in each branch.
    dissipated : ndarray, shape (B, n), or None
        Energy per volume lost so far; ``None`` where branches lose it and the mesh follows the edge.
    surface : SurfaceProfile
        Radius, displacement, pressure and gap of the surface.
    element_volumes : ndarray, shape (m,)
        Volumes of revolution.
    element_stored : ndarray, shape (m,)
    element_rate : ndarray, shape (B, m)
    element_dissipated : ndarray, shape (B, m), or None
        Means over each element: times its volume and summed, they are the integrals over the mesh.
    """

    row: int
    time: float
    penetration: float
    force: float
    contact_radius: float
    label: str
    branches: tuple[str, ...]
    points: Array
    triangles: NDArray[np.int64]
    displacement: Array
    stress: Array
    strain: Array
    stored_energy_density: Array
    dissipation_rate: Array
    dissipated: Array | None
    surface: SurfaceProfile
    element_volumes: Array
    element_stored: Array
    element_rate: Array
    element_dissipated: Array | None

    @property
    def hydrostatic(self) -> Array:
        """Mean normal stress, tension positive; shape (n,)."""
        return self.stress[:3].mean(axis=0)

    @property
    def von_mises(self) -> Array:
        """Equivalent stress ``sqrt(3/2 dev s : dev s)``; shape (n,)."""
        shear = self.stress.copy()
        shear[:3] -= self.hydrostatic
        return np.sqrt(1.5 * (np.sum(shear[:3] ** 2, axis=0) + 2.0 * shear[3] ** 2))

    @property
    def principal(self) -> Array:
        """Principal stresses, the largest first; shape (3, n)."""
        rr, zz, tt, rz = self.stress
        middle, radius = 0.5 * (rr + zz), np.hypot(0.5 * (rr - zz), rz)
        return -np.sort(-np.stack([middle + radius, middle - radius, tt]), axis=0)

    @property
    def max_shear(self) -> Array:
        """Largest shear stress, half the difference of the extreme principal stresses; shape (n,)."""
        principal = self.principal
        return 0.5 * (principal[0] - principal[2])


def field_states(recording: Recording, labels: Mapping[int, str]) -> Iterator[FieldState]:
    """The body at rows of the trace, one after the other in the order of time.

    Parameters
    ----------
    recording : Recording
        Of a run whose options record its history. With a constant Poisson's ratio every row is available,
        otherwise those recorded.
    labels : mapping of int to str
        Rows and their labels.

    Yields
    ------
    FieldState

    Raises
    ------
    KeyError
        If a row was not recorded.
    ValueError
        If the recording does not begin at the start of the loading.
    """
    log = recording.log
    if log is None:
        raise KeyError("nothing was recorded: the options of the run record nothing")
    missing = sorted(row for row in labels if row not in log)
    if missing:
        raise KeyError(f"rows not recorded: {missing}")
    source = _source(recording.setup, log)
    counters, counted = recording.trace.counters, (0, 0, 0)
    for row in sorted(labels):
        state = _state(recording, source, row, labels[row])
        before, counted = counted, (source.factorisations, source.volume_solves, source.linear_solves)
        counters.factorisations += counted[0] - before[0]
        counters.volume_solves += counted[1] - before[1]
        counters.linear_solves += counted[2] - before[2]
        yield state


def _source(setup: Setup | FollowingSetup, log: HistoryLog) -> FieldSource:
    if isinstance(setup, FollowingSetup) and isinstance(log, FollowingLog):
        return FollowingFields(setup, log)
    if isinstance(setup, Setup) and isinstance(log, SurfaceLog):
        return CondensedFields(setup, log)
    if isinstance(setup, Setup) and isinstance(log, VolumeLog):
        return VolumeFields(setup, log)
    raise AssertionError("the log is of another kind of run")


def _state(recording: Recording, source: FieldSource, row: int, label: str) -> FieldState:
    trace, mesh, fields = recording.trace, source.mesh(row), source.at(row)
    recovery, lost = mesh.recovery, fields.dissipated
    nodal = recovery.nodal(np.concatenate([fields.stress, fields.strain]))
    return FieldState(
        row=row,
        time=float(trace.time[row]),
        penetration=float(trace.penetration[row]),
        force=float(trace.force[row]),
        contact_radius=float(trace.contact_radius[row]),
        label=label,
        branches=source.names,
        points=mesh.scale * mesh.stretch * recovery.points,
        triangles=recovery.triangles,
        displacement=recovery.displacement(fields.unknowns),
        stress=nodal[:4],
        strain=nodal[4:],
        stored_energy_density=recovery.densities(fields.stored[None])[0],
        dissipation_rate=recovery.densities(fields.rates),
        dissipated=None if lost is None else recovery.densities(lost),
        surface=profile(recording.surfaces[row], mesh.radii, mesh.height, mesh.stretch),
        element_volumes=mesh.scale**3 * recovery.volumes,
        element_stored=recovery.means(fields.stored[None])[0],
        element_rate=recovery.means(fields.rates),
        element_dissipated=None if lost is None else recovery.means(lost),
    )
