"""Fields at the quadrature points of a row, the mesh they belong to, and what gives both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fem_solver.fields.recovery import Recovery
from fem_solver.prony import Prony

Array = NDArray[np.float64]


def branch_names(modulus: Prony, kind: str = "") -> tuple[str, ...]:
    """Names of the branches of a modulus, with the kind before them where there are several."""
    return tuple(f"{kind} tau={time:.6g}".strip() for time in modulus.times)


@dataclass(frozen=True)
class PointFields:
    """State of the body at the quadrature points.

    ``unknowns`` are nodal; ``stress`` and ``strain`` (4, points), ``stored`` (points,), ``rates`` and
    ``dissipated`` (branches, points), the latter ``None`` where it is not known.
    """

    unknowns: Array
    stress: Array
    strain: Array
    stored: Array
    rates: Array
    dissipated: Array | None


@dataclass(frozen=True)
class RowMesh:
    """Mesh of a row, which stands for one ``scale`` times as large.

    Parameters
    ----------
    recovery : Recovery
    radii, height : ndarray, shape (n,)
        Of the surface nodes, and of the indenter there, as large as they are.
    scale : float
    stretch : float
        Contact radius over the radius of the node there: places are given in lengths of the former.
    """

    recovery: Recovery
    radii: Array
    height: Array
    scale: float = 1.0
    stretch: float = 1.0


class FieldSource(Protocol):
    """Fields at rows, asked for in rising order.

    ``names`` are those of the branches; ``volume_solves``, ``linear_solves`` and ``factorisations`` count.
    """

    names: tuple[str, ...]

    @property
    def volume_solves(self) -> int:
        """Back-substitutions in the body so far."""

    @property
    def linear_solves(self) -> int:
        """Projections onto the nodes so far."""

    @property
    def factorisations(self) -> int:
        """Factorisations so far, beside those of the run."""

    def at(self, row: int) -> PointFields:
        """Fields at a row."""

    def mesh(self, row: int) -> RowMesh:
        """The mesh of a row."""
