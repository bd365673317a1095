"""The reference: the path of the edge under the Abel transform, nearly exact."""

from validation.reference.path.options import Options
from validation.reference.path.solver import refusal, solve

__all__ = ["Options", "refusal", "solve"]
