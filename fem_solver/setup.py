"""Discrete problem of a scene on a mesh: half-space, history, edge law and step limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SceneError, UnsupportedScene
from contact_scene.run_control import installed_memory
from fem_solver.condensed import CondensedHistory
from fem_solver.edge import AdhesionlessEdge, EdgeLaw
from fem_solver.edge_geometry import SURFACE_MARGIN, EdgeGeometry, surface_margin
from fem_solver.halfspace import Factorisation, HalfSpace
from fem_solver.irreversible_edge import edge_law
from fem_solver.moduli import Moduli, moduli
from fem_solver.options import DEFAULT_TOLERANCE, Options
from fem_solver.quadrature import QuadratureHistory
from fem_solver.setup_memory import setup_memory
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]

_TRAVEL_SHARE = 0.01
"""Edge travel per step without adhesion, relative to the radius the mesh is made for."""


@dataclass(frozen=True)
class Setup:
    """Discrete half-space with its history, and the edge law.

    Parameters
    ----------
    space : HalfSpace
    factor : Factorisation
        Of the relaxed solid.
    weights : ndarray, shape (n,)
        Weights of the nodal forces in the far field.
    history : CondensedHistory or QuadratureHistory
    geometry : EdgeGeometry
    law : EdgeLaw
    radii, height : ndarray, shape (n,)
        Radii of the surface nodes, and the indenter's height above its lowest point there.
    travel : float
        Edge travel allowed per step of a solid with a history, a length.
    resolved_from : float
        Smallest contact radius at which the mesh resolves the process zone; 0 without adhesion.
    shortest_time : float
        Shortest relaxation time; infinite for an elastic solid.
    compliance : float
        Of the machine; 0 where it is rigid.
    """

    space: HalfSpace
    factor: Factorisation
    weights: Array
    history: CondensedHistory | QuadratureHistory
    geometry: EdgeGeometry
    law: EdgeLaw
    radii: Array
    height: Array
    travel: float
    resolved_from: float
    shortest_time: float
    compliance: float = 0.0
    jump_tolerance = 1.0
    stretch = 1.0

    @property
    def tolerance(self) -> float:
        """Relative accuracy of the force in time where the options ask for none."""
        return DEFAULT_TOLERANCE

    @property
    def has_history(self) -> bool:
        """Whether the solid relaxes: otherwise each state is an equilibrium by itself."""
        return math.isfinite(self.shortest_time)


def set_up(scene: Scene, mesh: Any, options: Options) -> Setup:
    """Assemble and factorise.

    Parameters
    ----------
    scene, mesh, options
        As of :func:`fem_solver.solve`.

    Returns
    -------
    Setup

    Raises
    ------
    UnsupportedScene
        If the chosen form or path does not apply to the scene.
    SceneError
        If the mesh is too large for the memory of the machine.
    """
    material = moduli(scene.material)
    _check(material, options)
    _check_memory(mesh, not material.alike)
    space = HalfSpace(mesh, options.form == "mixed", options.far_field)
    reach = float(mesh.parameters.fine_to)
    stress = scene.adhesion.stress if scene.adhesion is not None else None
    count = _node_count(space.radii, surface_margin(stress) * reach)
    history: CondensedHistory | QuadratureHistory
    if material.alike if options.path == "auto" else options.path == "condensed":
        factor = space.factorise(material.ratio, count)
        compliance, weights = factor.compliance()
        history = CondensedHistory(SurfaceOperator(compliance), material.shear)
        glassy = history.operator
    else:
        history = QuadratureHistory(space, material.shear, material.bulk, count)
        factor, weights = history.factor, history.weights
        glassy = history.instantaneous
    radii = space.radii[:count]
    height = scene.indenter.height(radii)
    # contact radii are those of the glassy response, in which the edge moves
    effective = glassy.effective_radii(material.unit_plane_modulus)
    geometry, law = _edge(scene, radii, height, effective, history.operator, reach)
    times = np.append(material.shear.times, [] if material.bulk is None else material.bulk.times)
    return Setup(
        space=space,
        factor=factor,
        weights=weights,
        history=history,
        geometry=geometry,
        law=law,
        radii=radii,
        height=height,
        travel=_edge_travel(geometry, reach, options.resolution),
        resolved_from=_resolved_from(mesh, geometry.zone),
        shortest_time=float(times.min()) if times.size else math.inf,
        compliance=scene.loading.compliance,
    )


def _edge(
    scene: Scene, radii: Array, height: Array, effective: Array, operator: SurfaceOperator, reach: float
) -> tuple[EdgeGeometry, EdgeLaw]:
    """Where the edge may be, and by which law it moves.

    Parameters
    ----------
    scene : Scene
    radii, height : ndarray, shape (n,)
        Of the surface nodes, and of the indenter there.
    effective : ndarray, shape (n,)
        Contact radii that the nodes stand for.
    operator : SurfaceOperator
        Of the relaxed solid.
    reach : float
        Radius up to which the mesh is fine.

    Returns
    -------
    EdgeGeometry
    EdgeLaw
    """
    limit = scene.indenter.edge
    if scene.adhesion is None or not scene.is_adhesive:
        stress = None if scene.adhesion is None else scene.adhesion.stress
        geometry = EdgeGeometry(radii, effective, None, reach, limit, stress=stress)
        depths = operator.elastic_depths(height).tolist()
        positions = operator.transform_radii(radii).tolist()
        return geometry, AdhesionlessEdge(geometry, positions, depths, scene.indenter.plane_tip)
    adhesion = scene.adhesion
    geometry = EdgeGeometry(
        radii, effective, adhesion.zone, reach, limit, stress=adhesion.stress, shortest=adhesion.closing_zone
    )
    return geometry, edge_law(geometry, adhesion)


def _check(material: Moduli, options: Options) -> None:
    if options.form != "mixed" and material.bulk is None:
        raise UnsupportedScene(
            "material.poisson", "the displacement form needs compressibility", "form mixed"
        )
    if options.path == "condensed" and not material.alike:
        raise UnsupportedScene("material.bulk", "separate relaxation is not condensable", "path quadrature")


def _check_memory(mesh: Any, apart: bool) -> None:
    """Refuse a mesh too large for the memory of the machine, before anything is assembled."""
    installed = installed_memory()
    radii = mesh.points[0][mesh.points[1] == 0.0]
    intervals = int(np.count_nonzero(radii <= SURFACE_MARGIN * float(mesh.parameters.fine_to))) - 1
    needed = setup_memory(intervals, mesh.points.shape[1], apart)
    if installed is not None and needed > installed:
        problem = f"takes about {1e-9 * needed:.3g} GB of memory, {1e-9 * installed:.3g} GB are installed"
        raise SceneError("mesh", problem, "a coarser mesh, or a contact of fewer process zones")


def _edge_travel(geometry: EdgeGeometry, reach: float, resolution: int | None) -> float:
    """Edge travel allowed per step: a quarter of a division of the process zone, or of an element."""
    if geometry.zone is None:
        return _TRAVEL_SHARE * reach * (4.0 / resolution if resolution else 1.0)
    if resolution:
        return geometry.zone / (4.0 * resolution)
    return 0.25 * (2.0 * float(np.median(np.diff(geometry.radii[geometry.radii <= reach]))))


def _resolved_from(mesh: Any, zone: float | None) -> float:
    """The closure looks one zone to either side of the edge; a mesh that is fine to the axis resolves all."""
    fine_from = float(mesh.parameters.fine_from)
    return fine_from + zone if zone is not None and fine_from > 0.0 else 0.0


def _node_count(radii: Array, reach: float) -> int:
    """Vertices and mid-side nodes in turn, ending with a vertex."""
    count = int(np.searchsorted(radii, reach))
    return min(count + 1 - count % 2, len(radii))
