"""Stress, strain, energy and dissipation under the surface at requested rows of a run.

Coordinates ``(r, z)``, the body in ``z <= 0``; displacement along them. Stress and strain are positive in
tension and have the components ``(rr, zz, tt, rz)``, ``tt`` being the hoop and ``rz`` the tensor shear.
Surface quantities are those of :class:`contact_scene.SurfaceProfile`: displacement positive downwards.
Units are the scene's. The work done here is added to the counters of the trace.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import SurfaceProfile
from fem_solver.recorder import Recording, profile
from fem_solver.recovery import Recovery
from fem_solver.state import ComponentState, transferred
from fem_solver.strained_body import Losses, Springs, StrainedBody

Array = NDArray[np.float64]

_VOLUMES = 4
"""Volumes kept, some 200 MB each: one for each halving of the radius, on a layer for each place."""


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
    dissipated : ndarray, shape (B, n)
        Energy per volume lost so far.
    surface : SurfaceProfile
        Radius, displacement, pressure and gap of the surface.
    element_volumes : ndarray, shape (m,)
        Volumes of revolution.
    element_stored : ndarray, shape (m,)
    element_rate : ndarray, shape (B, m)
    element_dissipated : ndarray, shape (B, m)
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
    dissipated: Array
    surface: SurfaceProfile
    element_volumes: Array
    element_stored: Array
    element_rate: Array
    element_dissipated: Array

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
        Of a run whose options record it.
    labels : mapping of int to str
        Rows and their labels.

    Yields
    ------
    FieldState

    Raises
    ------
    KeyError
        If a row was not recorded.
    """
    missing = sorted(row for row in labels if not 0 <= row < len(recording.steps))
    if missing:
        raise KeyError(f"rows not recorded: {missing}")
    if not labels:
        return
    bodies = _Bodies(recording)
    counters, counted = recording.trace.counters, np.zeros(3, int)
    for row in sorted(labels):
        state = bodies.at(row, labels[row])
        before, counted = counted, bodies.work
        factorisations, volume_solves, linear_solves = (counted - before).tolist()
        counters.factorisations += factorisations
        counters.volume_solves += volume_solves
        counters.linear_solves += linear_solves
        yield state


class _Bodies:
    """The body at rows in rising order, each on the mesh where that row has it.

    Stress, strain and what is stored need the surface components of the row, what the branches have lost all
    steps up to it (see ``strained_body``). What the surface holds within an element is in no density.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording, self._surfaces = recording, recording.setup.surfaces
        self._springs = Springs(recording.setup.material)
        self._volumes: dict[Any, tuple[StrainedBody, Recovery]] = {}
        self._dropped = np.zeros(3, int)
        self._solid = recording.setup.solid
        self._next, self._place = 0, self._surfaces.for_history(recording.steps[0].end.place)
        self._here = Losses(self._springs)
        self._lost = np.zeros((len(self._springs.names), self._volume(self._place)[0].points))

    @property
    def work(self) -> NDArray[np.int_]:
        """Factorisations, back-substitutions in the body and projections onto the nodes so far."""
        return sum((_work(*parts) for parts in self._volumes.values()), self._dropped)

    def at(self, row: int, label: str) -> FieldState:
        """The body at a row, not before the last one requested."""
        for step in self._recording.steps[self._next : row + 1]:
            begin, end = (self._for_history(one) for one in (step.begin, step.end))
            self._move(end.place)
            self._here.add(step.dt, begin, end)
        self._next = row + 1
        self._move(self._recording.steps[row].end.place)
        self._sum_up()
        trace, state = self._recording.trace, self._recording.steps[row].end
        here, (body, recovery) = self._surfaces.at(self._place), self._volume(self._place)
        fields = body.fields(state.components, state.branches, here)
        nodal = recovery.nodal(np.concatenate([fields.stress, fields.strain]))
        return FieldState(
            row=row,
            time=float(trace.time[row]),
            penetration=float(trace.penetration[row]),
            force=float(trace.force[row]),
            contact_radius=float(trace.contact_radius[row]),
            label=label,
            branches=self._springs.names,
            points=here.scale * here.stretch * recovery.points,
            triangles=recovery.triangles,
            displacement=recovery.displacement(fields.unknowns),
            stress=nodal[:4],
            strain=nodal[4:],
            stored_energy_density=recovery.densities(fields.stored[None])[0],
            dissipation_rate=recovery.densities(fields.rates),
            dissipated=recovery.densities(self._lost),
            surface=profile(self._recording.surfaces[row], state, here, self._solid),
            element_volumes=here.scale**3 * recovery.volumes,
            element_stored=recovery.means(fields.stored[None])[0],
            element_rate=recovery.means(fields.rates),
            element_dissipated=recovery.means(self._lost),
        )

    def _for_history(self, state: ComponentState) -> ComponentState:
        """A state on the mesh on which losses are summed up."""
        surfaces = self._surfaces
        there = surfaces.for_history(state.place)
        return transferred(state, surfaces.at(state.place), surfaces.at(there), self._solid)

    def _move(self, place: Any) -> None:
        """Take what has been lost so far to the mesh at another place."""
        if place == self._place:
            return
        self._sum_up()
        unit = self._surfaces.at(self._place).scale / self._surfaces.at(place).scale
        left, new = (self._volume(one)[1] for one in (self._place, place))
        self._lost, self._place = new.taken_over(self._lost, left, unit), place

    def _sum_up(self) -> None:
        """Add the losses of the steps on this mesh."""
        here = self._surfaces.at(self._place)
        self._lost = self._lost + self._here.density(self._volume(self._place)[0], here)
        self._here = Losses(self._springs)

    def _volume(self, place: Any) -> tuple[StrainedBody, Recovery]:
        """The volume below a place and its projection; those that were needed last are kept."""
        key = self._surfaces.volume_of(place)
        if key not in self._volumes:
            space, count = self._surfaces.volume(place)
            self._volumes[key] = StrainedBody(space, count, self._springs), Recovery(space.basis)
            if len(self._volumes) > _VOLUMES:
                self._dropped += _work(*self._volumes.pop(next(iter(self._volumes))))
        return self._volumes[key]


def _work(body: StrainedBody, recovery: Recovery) -> NDArray[np.int_]:
    """Factorisations, back-substitutions in the body and projections onto the nodes."""
    return np.array([body.factorisations + 1, body.solves, recovery.solves])
