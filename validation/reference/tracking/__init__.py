"""Front tracking in Abel space: the nearly exact solution."""

from validation.reference.tracking.options import Options
from validation.reference.tracking.solver import refusal, solve

__all__ = ["Options", "refusal", "solve"]
