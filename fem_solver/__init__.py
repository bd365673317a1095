"""Adhesive contact of a viscoelastic half-space by finite elements and node release."""

from fem_solver.options import Options
from fem_solver.solver import Recording, record, solve

__all__ = ["Options", "Recording", "record", "solve"]
