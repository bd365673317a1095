"""Meshes of crosscontact: an axisymmetric half-space, fitted to the path of a contact edge.

`half_space` meshes what `MeshParameters` ask for, with gmsh or, where that is missing, the structured family;
`cached` does so once in a process; `layer` meshes a layer of unit thickness.
Importing this package does not load gmsh.
"""

from meshes.around_edge import EdgeMeshes
from meshes.halfspace import cached, half_space
from meshes.layer import LayerMesh, layer
from meshes.mesh import BOUNDARIES, HalfSpaceMesh
from meshes.parameters import DOMAIN_RATIO, FAMILIES, WIDEST, MeshParameters
from meshes.structured import structured_half_space, structured_layer

__all__ = [
    "BOUNDARIES",
    "DOMAIN_RATIO",
    "FAMILIES",
    "WIDEST",
    "EdgeMeshes",
    "HalfSpaceMesh",
    "LayerMesh",
    "MeshParameters",
    "cached",
    "half_space",
    "layer",
    "structured_half_space",
    "structured_layer",
]
