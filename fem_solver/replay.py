"""A run once more, by internal variables at the quadrature points of the whole body.

The surface components of a run and the internal variables of the volume follow the same Prony update, the
former in vectors on the surface, the latter in strains at points. Here the nodal forces of a run go row by
row through the volume (``quadrature``), which knows of no contact, of no edge and of no component: it answers
with the displacement of the surface and with the energies that it has stored and lost. Forces are linear
neither in time nor in the edge between two rows, and radii within a node are not in its force: what is left
goes with rows and nodes, refined together.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import SceneError
from fem_solver.fields.recording import Recording
from fem_solver.quadrature import QuadratureHistory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class VolumeAnswer:
    """What the volume answers to the forces of a run, and what the surface has said; by row.

    Parameters
    ----------
    time : ndarray, shape (rows,)
    apart : ndarray, shape (rows,)
        Largest difference of a node's displacement, over the largest displacement of the run.
    stored, dissipated : ndarray, shape (2, rows)
        Energies of the body by the volume, and by the surface.
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
    history, scale = volume(recording), setup.surfaces.at(steps[0].end.place).scale
    apart, stored, dissipated = [], [], []
    for step, row in zip(steps, rows, strict=True):  # forces displace a mesh of unit scale by as much more
        history.commit(step.dt, row.forces / scale)
        apart.append(float(np.abs(history.displacement - row.displacement).max()))
        stored.append((scale * history.stored_energy, row.stored))
        dissipated.append((scale * history.state.dissipated, row.branch_dissipation))
    largest = max(float(np.abs(row.displacement).max()) for row in rows)
    return VolumeAnswer(
        np.array([row.time for row in rows]),
        np.array(apart) / largest,
        np.array(stored).T,
        np.array(dissipated).T,
    )


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))
