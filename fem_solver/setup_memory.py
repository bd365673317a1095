"""Memory of the set-up of a run, from the size of its mesh, before anything is allocated.

The constants are fits to runs with 450 to 5,000 surface nodes (incompressible); on other meshes they hold
within a factor of two or so.
"""

from __future__ import annotations

UNKNOWNS_PER_VERTEX = 9.0
"""Two displacements at each vertex and its three edges, and a pressure."""
NODES_PER_INTERVAL = 2.0
"""Vertices and mid-side nodes."""
_BYTES_PER_UNKNOWN, _BYTES_PER_ENTRY = 9e3, 50.0
"""Matrices and factors in the body; dense blocks, by the square of the surface nodes."""
_RATIOS = 15.0
"""Distinct ratios of moduli, with a factorisation and a compliance each, of a run whose shear and bulk relax
apart."""
_KEPT_PER_UNKNOWN, _KEPT_PER_ENTRY = 2.5e3, 8.0
"""Bytes kept of each."""


def setup_memory(intervals: float, vertices: float, apart: bool = False) -> float:
    """Largest memory of a run before its first row, to a factor of two or so.

    Parameters
    ----------
    intervals : float
        Vertex intervals of the surface up to the radius that the mesh is made for.
    vertices : float
        Vertices of the mesh.
    apart : bool
        Whether shear and bulk relax apart, which takes the history into the body.

    Returns
    -------
    float
        Bytes.
    """
    nodes, unknowns = NODES_PER_INTERVAL * intervals, UNKNOWNS_PER_VERTEX * vertices
    memory = _BYTES_PER_UNKNOWN * unknowns + _BYTES_PER_ENTRY * nodes**2
    if apart:
        memory += _RATIOS * (_KEPT_PER_UNKNOWN * unknowns + _KEPT_PER_ENTRY * nodes**2)
    return memory
