"""Reference solutions: front tracking for any scene, closed forms for special ones."""

from validation.reference.tracking import Options, solve

__all__ = ["Options", "solve"]
