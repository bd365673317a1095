"""Meshes of crosscontact: an axisymmetric half-space, fitted to the path of a contact edge.

`fit` chooses mesh parameters for a contact problem, `half_space` meshes them (with gmsh or, where that is
missing, the structured family), `cached` does so once in a process.
Importing this package loads neither gmsh nor meshio.
"""

from meshes.around_edge import EdgeMeshes
from meshes.files import read, write
from meshes.halfspace import cached, half_space
from meshes.mesh import BOUNDARIES, HalfSpaceMesh, Quality
from meshes.parameters import FAMILIES, MeshParameters, fit
from meshes.structured import structured_half_space
from meshes.surface import surface_radii

__all__ = [
    "BOUNDARIES",
    "FAMILIES",
    "EdgeMeshes",
    "HalfSpaceMesh",
    "MeshParameters",
    "Quality",
    "cached",
    "fit",
    "half_space",
    "read",
    "structured_half_space",
    "surface_radii",
    "write",
]
