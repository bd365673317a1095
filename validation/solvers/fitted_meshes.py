"""Meshes fitted to a scene: fine along the whole path of the contact edge, or around the edge alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import meshes
from contact_scene import Adhesion, Scene, SceneError
from validation.solvers.contact_range import largest_contact_radius
from validation.solvers.run_options import specified

DIVISIONS = 10
"""Elements per process zone where no resolution is specified."""
ADHESIONLESS_DIVISIONS = 4
"""Nodes per hundredth of the largest contact radius, without adhesion and with no resolution specified.

Without adhesion the edge rests on nodes, mid-side nodes among them: two divisions are an element.
"""
LEAST_DIVISIONS = 4
"""Smallest resolution that a user may choose; coarser meshes serve estimates of the error alone. The zone of
a closing edge then has an element at least: with less the edge closes in steps, behind where it should be."""
GRADING = 0.2
"""Growth of the element size with the distance from the contact edge, where none is specified."""


def mesh_for(
    scene: Scene,
    resolution: int | None,
    grading: float | None = None,
    domain_ratio: float | None = None,
    cached: bool = True,
) -> meshes.HalfSpaceMesh:
    """A graded half-space fitted to the scene, at a number of elements per process zone.

    Without adhesion the nodes per hundredth of the largest contact radius take their place.

    Parameters
    ----------
    scene : Scene
    resolution : int, optional
        Elements per process zone, or nodes per hundredth of the largest contact radius.
    grading, domain_ratio : float, optional
        Growth of the element size with the distance from the edge; domain radius over the largest contact
        radius.
    cached : bool
        Take the mesh from the cache if it is there.

    Returns
    -------
    HalfSpaceMesh

    Raises
    ------
    SceneError
        If no mesh of reasonable size resolves the process zone.
    """
    parameters = mesh_parameters(scene, resolution, grading, domain_ratio)
    return meshes.cached(parameters) if cached else meshes.half_space(parameters)


def mesh_parameters(
    scene: Scene, resolution: int | None, grading: float | None = None, domain_ratio: float | None = None
) -> meshes.MeshParameters:
    """Parameters of the mesh fitted to a scene.

    Parameters
    ----------
    scene, resolution, grading, domain_ratio
        As of :func:`mesh_for`.

    Returns
    -------
    MeshParameters

    Raises
    ------
    SceneError
        If no mesh of reasonable size resolves the process zone.
    """
    largest = largest_contact_radius(scene)
    edge = scene.indenter.edge if math.isfinite(scene.indenter.edge) else None
    sizes = {"grading": grading or GRADING, **specified(domain_ratio=domain_ratio)}
    if scene.adhesion is not None and scene.is_adhesive:
        zone, divisions = resolved_length(scene.adhesion), resolution or DIVISIONS
        sizes["margin"] = 2.0 * scene.adhesion.zone / zone
    else:
        zone, divisions = 0.02 * largest, resolution or ADHESIONLESS_DIVISIONS
        sizes["margin"] = 1.0

    smallest = 0.0 if edge is None or peels(scene) else edge

    def fitted(count: int) -> meshes.MeshParameters:
        return meshes.fit(smallest, largest, zone, count, edge=edge, **sizes)

    return _fitted_or_refused(fitted, divisions)


def edge_meshes(
    scene: Scene,
    resolution: int | None,
    grading: float | None = None,
    domain_ratio: float | None = None,
    cached: bool = True,
) -> meshes.EdgeMeshes:
    """Meshes that are fine around the contact edge only.

    Parameters
    ----------
    scene, resolution, grading, domain_ratio, cached
        As of :func:`mesh_for`; the domain radius is over the contact radius.

    Returns
    -------
    EdgeMeshes
    """
    if scene.adhesion is None:
        raise SceneError(
            "adhesion", "is missing: the mesh follows the edge by process zones", "work and zone"
        )
    largest, divisions = largest_contact_radius(scene), resolution or DIVISIONS
    return meshes.EdgeMeshes(
        resolved_length(scene.adhesion), divisions, largest, grading or GRADING, domain_ratio, cached
    )


def edge_mesh_parameters(
    scene: Scene, resolution: int | None, grading: float | None = None, domain_ratio: float | None = None
) -> meshes.MeshParameters:
    """Parameters of the mesh around the edge of the largest contact.

    Parameters
    ----------
    scene, resolution, grading, domain_ratio
        As of :func:`edge_meshes`.

    Returns
    -------
    MeshParameters

    Raises
    ------
    SceneError
        If no mesh of reasonable size resolves the process zone.
    """
    largest = largest_contact_radius(scene)

    def fitted(count: int) -> meshes.MeshParameters:
        made = edge_meshes(scene, count, grading, domain_ratio)
        return made.parameters(made.place(largest).level)

    return _fitted_or_refused(fitted, resolution or DIVISIONS)


def resolved_length(adhesion: Adhesion) -> float:
    """Length that the resolution divides: the process zone, or less where that of a closing edge is short."""
    return min(adhesion.zone, LEAST_DIVISIONS * adhesion.closing_zone)


def divisions_of_zone(scene: Scene, resolution: int) -> int:
    """Elements in a process zone at rest; without adhesion the resolution."""
    if scene.adhesion is None or not scene.is_adhesive:
        return resolution
    return round(resolution * scene.adhesion.zone / resolved_length(scene.adhesion))


def peels(scene: Scene) -> bool:
    """Whether the contact edge takes time to leave the rim of a punch; otherwise it stays or goes at once."""
    rated = scene.adhesion is not None and scene.adhesion.rate is not None
    return scene.is_adhesive and (rated or bool(scene.material.spectrum[0].size))


def _fitted_or_refused(
    fitted: Callable[[int], meshes.MeshParameters], divisions: int
) -> meshes.MeshParameters:
    """Parameters of a mesh, or the refusal of one that is too large."""
    try:
        return fitted(divisions)
    except ValueError as error:
        raise SceneError("", f"no mesh for this scene: {error}", _advice(fitted, divisions)) from None


def _advice(fitted: Callable[[int], meshes.MeshParameters], refused: int) -> str:
    """The finest resolution below a refused one of which a mesh can be made, if a user may choose one."""

    def possible(divisions: int) -> bool:
        try:
            fitted(divisions)
        except ValueError:
            return False
        return True

    return finest_resolution(possible, refused)


def finest_resolution(possible: Callable[[int], bool], refused: int) -> str:
    """What is allowed in place of a refused resolution, in words.

    Parameters
    ----------
    possible : callable
        Whether a run at a resolution is possible; whatever is coarser is so, too.
    refused : int

    Returns
    -------
    str
    """
    low, high = LEAST_DIVISIONS - 1, max(refused, LEAST_DIVISIONS)
    while high - low > 1:
        middle = (low + high) // 2
        if possible(middle):
            low = middle
        else:
            high = middle
    if low < LEAST_DIVISIONS:
        return "a longer process zone, a smaller contact, or another solver"
    return f"a coarser resolution, at most {low}"
