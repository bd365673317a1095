"""Adhesive contact of a viscoelastic body by finite elements and node release, of crosscontact."""

from fem_solver.fields import FieldState, field_states
from fem_solver.recorder import Recording
from fem_solver.setup import Options
from fem_solver.solver import record, solve

__all__ = [
    "FieldState",
    "Options",
    "Recording",
    "field_states",
    "record",
    "solve",
]
