"""Meshes of crosscontact: an axisymmetric half-space, fitted to the path of a contact edge.

`fit` chooses mesh parameters for a contact problem, `half_space` meshes them (with gmsh or, where that is
missing, the structured family), `cached` does so once in a process.
Importing this package does not load gmsh.
"""

from meshes.around_edge import EdgeMeshes
from meshes.halfspace import cached, half_space
from meshes.mesh import BOUNDARIES, HalfSpaceMesh
from meshes.parameters import DOMAIN_RATIO, FAMILIES, WIDEST, MeshParameters, fit
from meshes.structured import structured_half_space

__all__ = [
    "BOUNDARIES",
    "DOMAIN_RATIO",
    "FAMILIES",
    "WIDEST",
    "EdgeMeshes",
    "HalfSpaceMesh",
    "MeshParameters",
    "cached",
    "fit",
    "half_space",
    "structured_half_space",
]
