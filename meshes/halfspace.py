"""The half-space meshed by gmsh: a quarter disc with prescribed surface vertices and a graded interior."""

from __future__ import annotations

from dataclasses import asdict
from functools import lru_cache
from itertools import pairwise
from types import ModuleType

import numpy as np

from meshes.gmsh_session import find_gmsh, session
from meshes.mesh import Array, HalfSpaceMesh, Indices, assemble
from meshes.parameters import MeshParameters
from meshes.structured import structured_half_space
from meshes.surface import layers, surface_radii

TRIANGLE = 2
"""Type number of the three-node triangle in gmsh."""


def half_space(parameters: MeshParameters) -> HalfSpaceMesh:
    """Mesh the half-space with the family that ``parameters`` names.

    Where gmsh cannot be loaded, a warning names what is missing and the structured family is used;
    ``parameters.family`` of the mesh is the family used.
    """
    gmsh = find_gmsh() if parameters.family == "gmsh" else None
    if gmsh is None:
        return structured_half_space(parameters)
    points, triangles = _triangulate(gmsh, parameters)
    return assemble(points, triangles, parameters)


@lru_cache(maxsize=16)
def cached(parameters: MeshParameters) -> HalfSpaceMesh:
    """Return ``half_space(parameters)``, built once in a process while it is among the last asked for."""
    return half_space(parameters)


def _triangulate(gmsh: ModuleType, parameters: MeshParameters) -> tuple[Array, Indices]:
    radii = surface_radii(parameters)
    shape = _unit_free(parameters)
    if surface_radii(shape).size != radii.size:  # a strip that ends within round-off of another interval
        shape = parameters
    # gmsh has absolute tolerances, which fail for small lengths: lengths in units of the strip
    unit = parameters.fine_to
    with session(gmsh):
        _geometry(gmsh, surface_radii(shape) / shape.fine_to)
        field = gmsh.model.mesh.field.add("MathEval")
        gmsh.model.mesh.field.setString(field, "F", _size_field(shape, shape.fine_to))
        gmsh.model.mesh.field.setAsBackgroundMesh(field)
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, corners = gmsh.model.mesh.getElementsByType(TRIANGLE)
    points = coordinates.reshape(-1, 3)[:, :2].T * unit
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(tags.size)
    triangles = number[corners.astype(np.int64)].reshape(-1, 3).T
    surface = np.flatnonzero(points[1] == 0.0)
    if surface.size != radii.size:
        raise RuntimeError(f"gmsh placed {surface.size} vertices on the surface instead of {radii.size}")
    points[0, surface[np.argsort(points[0, surface])]] = radii  # undo the rounding of the change of unit
    return points, triangles


def _unit_free(parameters: MeshParameters) -> MeshParameters:
    """The same shape in units of the fine size, rounded to nine digits.

    The triangulation depends on the last digits, and a mesh in millimetres should be that in metres.
    """
    size = parameters.fine_size
    lengths = {
        name: float(f"{value / size:.8e}")
        for name, value in asdict(parameters).items()
        if name not in ("family", "grading") and value is not None
    }
    return MeshParameters(**lengths, grading=parameters.grading, family=parameters.family)


def _geometry(gmsh: ModuleType, radii: Array) -> None:
    """Quarter disc whose surface consists of one straight, undivided line per pair of surface vertices."""
    geo = gmsh.model.geo
    surface = [geo.addPoint(float(r), 0.0, 0.0) for r in radii]
    bottom = geo.addPoint(0.0, -float(radii[-1]), 0.0)
    lines = [geo.addLine(left, right) for left, right in pairwise(surface)]
    arc = geo.addCircleArc(bottom, surface[0], surface[-1])
    axis = geo.addLine(surface[0], bottom)
    geo.addPlaneSurface([geo.addCurveLoop([axis, arc, *(-line for line in reversed(lines))])])
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    geo.synchronize()


def _size_field(parameters: MeshParameters, unit: float) -> str:
    """Size ``fine_size + grading * distance from the strip`` as an expression in gmsh's coordinates."""
    strip = layers(parameters).strip / unit
    start, stop, size = (f"{value:.17f}" for value in (strip[0], strip[-1], parameters.fine_size / unit))
    # |x - start| + |x - stop| exceeds the length of the strip by twice the radial distance from it
    beyond = f"0.5 * (Fabs(x - {start}) + Fabs(x - {stop}) - ({stop} - {start}))"
    return f"{size} + {parameters.grading:.17f} * Sqrt(({beyond})^2 + y^2)"
