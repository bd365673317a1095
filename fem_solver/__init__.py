"""Adhesive contact of a viscoelastic body by finite elements and node release, of crosscontact."""

from fem_solver.fields.recording import Recording
from fem_solver.fields.states import FieldState, field_states
from fem_solver.options import Options
from fem_solver.solver import record, solve

__all__ = [
    "FieldState",
    "Options",
    "Recording",
    "field_states",
    "record",
    "solve",
]
