"""The paper's axisymmetric boundary-element solver, of crosscontact: any Prony material, loading, closure."""

from bem_solver.options import Options
from bem_solver.solver import solve

__all__ = ["Options", "solve"]
