"""Step lengths that do not depend on rounding errors.

A step is chosen from differences of rows, which amplify rounding errors and pass them on to the next rows.
Rounded to few digits it is the same on every machine and in every system of units.
"""

from __future__ import annotations

import math

MANTISSA = 2.0**16
"""Sixteen binary digits: coarser than amplified rounding errors, finer than any effect of the step length."""


def rounded_length(length: float, unit: float = 1.0) -> float:
    """``length`` rounded to sixteen binary digits, counted in a ``unit`` that the scene itself gives."""
    mantissa, exponent = math.frexp(length / unit)
    return math.ldexp(round(MANTISSA * mantissa) / MANTISSA, exponent) * unit
