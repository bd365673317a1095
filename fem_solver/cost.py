"""What a run costs, from the size of its mesh, before anything is allocated.

The constants are fits to runs with 450 to 5,000 surface nodes (incompressible, one thread); on other machines
and meshes they hold within a factor of two or so.
"""

from __future__ import annotations

from dataclasses import dataclass

_UNKNOWNS_PER_VERTEX = 9.0
"""Two displacements at each vertex and its three edges, and a pressure."""
_NODES_PER_INTERVAL = 2.0
"""Vertices and mid-side nodes."""
_BYTES_PER_UNKNOWN, _BYTES_PER_ENTRY = 9e3, 50.0
"""Largest memory of the set-up: matrices and factors in the body; dense blocks, by the square of the surface
nodes."""
_SECONDS_PER_UNKNOWN, _SECONDS_PER_CUBE = 6.5e-5, 4e-10
"""Processor time of the set-up: assembly and elimination in the body; dense algebra, by the cube of the
surface nodes."""
_SECONDS_OF_STEP, _SECONDS_PER_ENTRY, _SECONDS_PER_BRANCH = 1e-3, 4e-9, 1e-8
"""Processor time of an accepted step: of any size; for the products with the compliance, by the square of the
nodes; and for every branch and node."""
_BYTES_PER_ROW = 600.0
"""Memory of a row."""
_RATIOS = 15.0
"""Distinct ratios of moduli, with a factorisation and a compliance each, of a run whose shear and bulk relax
apart."""
_KEPT_PER_UNKNOWN, _KEPT_PER_ENTRY = 2.5e3, 8.0
"""Bytes kept of each."""
_SECONDS_OF_SOLUTION = 4e-6
"""Processor time per unknown of the solutions in the body that such a step takes."""


@dataclass(frozen=True)
class RunCost:
    """Forecast of what a run takes, to a factor of two or so.

    Parameters
    ----------
    nodes : float
        Surface nodes offered to the indenter.
    unknowns : float
        Of the body.
    bytes_of_setup, bytes_per_row : float
        Largest memory before the first row, and what each row adds.
    seconds_of_setup, seconds_per_step : float
        Processor time.
    """

    nodes: float
    unknowns: float
    bytes_of_setup: float
    bytes_per_row: float
    seconds_of_setup: float
    seconds_per_step: float


def run_cost(intervals: float, vertices: float, branches: int, apart: bool = False) -> RunCost:
    """Forecast from the size of a mesh.

    Parameters
    ----------
    intervals : float
        Vertex intervals of the surface up to the radius that the mesh is made for.
    vertices : float
        Vertices of the mesh.
    branches : int
        Of the material.
    apart : bool
        Whether shear and bulk relax apart, which takes the history into the body.

    Returns
    -------
    RunCost
    """
    nodes, unknowns = _NODES_PER_INTERVAL * intervals, _UNKNOWNS_PER_VERTEX * vertices
    memory = _BYTES_PER_UNKNOWN * unknowns + _BYTES_PER_ENTRY * nodes**2
    setup = _SECONDS_PER_UNKNOWN * unknowns + _SECONDS_PER_CUBE * nodes**3
    step = _SECONDS_OF_STEP + _SECONDS_PER_ENTRY * nodes**2 + _SECONDS_PER_BRANCH * branches * nodes
    if apart:
        memory += _RATIOS * (_KEPT_PER_UNKNOWN * unknowns + _KEPT_PER_ENTRY * nodes**2)
        setup *= _RATIOS
        step += _SECONDS_OF_SOLUTION * unknowns * (1.0 + branches)
    return RunCost(nodes, unknowns, memory, _BYTES_PER_ROW, setup, step)
