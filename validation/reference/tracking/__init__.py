"""Front tracking in Abel space: the nearly exact solution."""

from validation.reference.tracking.options import Options
from validation.reference.tracking.solver import solve

__all__ = ["Options", "solve"]
