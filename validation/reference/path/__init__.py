"""The reference: the path of the edge under the Abel transform, nearly exact."""

from validation.reference.path.options import Options
from validation.reference.path.solver import solve

__all__ = ["Options", "solve"]
