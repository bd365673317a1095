"""Lengths of steps that rounding does not reach.

A step is chosen from differences of rows, which magnify rounding, and moves the next rows by it. Chosen with
few digits it is the same on every machine and in every system of units.
"""

from __future__ import annotations

import math

KEPT = 2.0**12


def few_digits(length: float) -> float:
    """``length`` rounded to twelve binary digits."""
    mantissa, exponent = math.frexp(length)
    return math.ldexp(round(KEPT * mantissa) / KEPT, exponent)
