"""A root between two ends: what a run needs of SciPy, which takes longer to load than most runs take."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable

MOST = 200
"""Most evaluations: twice what bisection takes over the whole range of exponents of a bracket of 1e-30."""


def bracketed(function: Callable[[float], float], first: float, last: float, narrow: float = 0.0) -> float:
    """Root between two ends at which a function has opposite signs, to ``narrow`` or to rounding.

    By inverse quadratic interpolation where that is safe, otherwise by halves (T.R. Chandrupatla, Adv. Eng.
    Software 28, 145 (1997)).
    """
    a, b = first, last
    fa, fb = function(a), function(b)
    if fa == 0.0 or fb == 0.0:
        return a if fa == 0.0 else b
    if not fa * fb < 0.0:
        raise ValueError(f"no change of sign between {first:g} and {last:g}: {fa:g}, {fb:g}")
    share = 0.5
    for _ in range(MOST):
        x = a + share * (b - a)
        fx = function(x)
        if (fx > 0.0) == (fa > 0.0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        best, least = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        shortest = (2.0 * sys.float_info.epsilon * abs(best) + 0.5 * narrow) / abs(b - a)
        if least == 0.0 or shortest > 0.5:
            return best
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        share = 0.5
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        share = min(max(share, shortest), 1.0 - shortest) if math.isfinite(share) else 0.5
    return best


def dip(function: Callable[[float], float], first: float, last: float, narrow: float) -> tuple[float, float]:
    """The lowest place between two ends, to ``narrow``, and its value; the first found that is not positive.

    By the golden section.
    """
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = first, last
    x, y = b - golden * (b - a), a + golden * (b - a)
    low, high = function(x), function(y)
    while min(low, high) > 0.0 and abs(b - a) > narrow:
        if low < high:
            b, y, high = y, x, low
            x = b - golden * (b - a)
            low = function(x)
        else:
            a, x, low = x, y, high
            y = a + golden * (b - a)
            high = function(y)
    return (x, low) if low < high else (y, high)
