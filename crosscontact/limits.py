"""Limits of what Python API and command line take."""

SMALLEST_RESOLUTION = 4
"""Divisions per process zone (without adhesion: per hundredth of the largest contact radius); below it the
stress beside the contact edge is not resolved."""
