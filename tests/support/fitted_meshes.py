"""Meshes of a scene of either kind, whatever its process zone."""

from __future__ import annotations

import math

from contact_scene import Scene
from meshes import EdgeMeshes, HalfSpaceMesh
from validation.solvers.finite_elements import FiniteElements


def mesh_for(scene: Scene, resolution: int | None) -> HalfSpaceMesh:
    """Fine along the whole path of the edge."""
    return FiniteElements(followed_beyond=math.inf).mesh(scene, resolution)


def edge_meshes(scene: Scene, resolution: int | None) -> EdgeMeshes:
    """Fine around the edge, with which they travel."""
    return FiniteElements(followed_beyond=0.0).mesh(scene, resolution)
