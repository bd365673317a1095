"""The reference: the path of the edge under the Abel transform, nearly exact."""

from validation.reference.path.solver import Options, solve

__all__ = ["Options", "solve"]
