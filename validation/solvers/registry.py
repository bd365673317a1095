"""All solvers by name."""

from __future__ import annotations

from validation.solvers.base import Solver
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.front_tracking import FrontTracking

SOLVERS: dict[str, Solver] = {
    method.name: method for method in (BoundaryElements(), FiniteElements(), FrontTracking())
}


def register(method: Solver) -> None:
    """Add a solver; commands and reports run it after those registered before.

    Raises
    ------
    ValueError
        If there is a solver of this name.
    """
    if method.name in SOLVERS:
        raise ValueError(f'there is a solver named "{method.name}" already')
    SOLVERS[method.name] = method


def unregister(name: str) -> None:
    """Remove a solver."""
    del SOLVERS[name]


def solver(name: str) -> Solver:
    """The solver of this name.

    Raises
    ------
    KeyError
        If there is none.
    """
    return SOLVERS[name]


def solvers() -> tuple[Solver, ...]:
    """All solvers, in the order of their registration."""
    return tuple(SOLVERS.values())
