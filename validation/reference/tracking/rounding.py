"""Lengths of steps that rounding does not reach.

A step is chosen from differences of rows, which magnify rounding, and moves the next rows by it. Chosen with
few digits it is the same on every machine and in every system of units.
"""

from __future__ import annotations

import math

KEPT = 2.0**16  # far above what rounding is magnified to, far below what a step does to the result


def few_digits(length: float, unit: float = 1.0) -> float:
    """``length`` rounded to sixteen binary digits, counted in a ``unit`` that the scene itself gives."""
    mantissa, exponent = math.frexp(length / unit)
    return math.ldexp(round(KEPT * mantissa) / KEPT, exponent) * unit
