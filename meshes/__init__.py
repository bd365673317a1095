"""Meshes of an axisymmetric half-space, fitted to the path of a contact edge."""

from meshes.mesh import BOUNDARIES, HalfSpaceMesh, Quality
from meshes.parameters import FAMILIES, MeshParameters, fit
from meshes.structured import structured_half_space
from meshes.surface import surface_radii

__all__ = [
    "BOUNDARIES",
    "FAMILIES",
    "HalfSpaceMesh",
    "MeshParameters",
    "Quality",
    "fit",
    "structured_half_space",
    "surface_radii",
]
