"""Reference solutions: front tracking for any scene, closed forms for special ones."""

from validation.reference.tracking import Options, refusal, solve

__all__ = ["Options", "refusal", "solve"]
