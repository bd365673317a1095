"""What counts as equal in a run."""

ROUND_OFF = 1e-9
"""Difference, relative to the largest value of a column, below which two of its values count as equal."""
