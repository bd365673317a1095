"""Observed order, Richardson value and error bound from a sequence of values on a refinement ladder.

A level has a size ``h`` (relative, the finest last) and a value ``f``; ``f = f* + C h^p`` is assumed.
No absolute value enters an order: an error that grows has a negative order, values that go to and fro
have none without the exact value.

References: L. F. Richardson, *Phil. Trans. R. Soc. A* 226 (1927) 299; P. J. Roache, *J. Fluids Eng.* 116
(1994) 405; I. B. Celik et al., *J. Fluids Eng.* 130 (2008) 078001; W. L. Oberkampf and C. J. Roy,
*Verification and Validation in Scientific Computing* (2010), Sec. 8.7.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

ROUND_OFF = 1e-12
"""Relative difference below which two values count as equal."""
ORDERS = (-20.0, 20.0)
"""Interval in which an observed order is searched."""
SAFE, UNSAFE = 1.25, 3.0
"""Safety factors of the grid convergence index, with the nominal order observed and without (Roache 1994)."""
NEAR = 0.1
"""Largest relative difference of the observed from the nominal order at which the nominal one is used."""
ASYMPTOTIC = (0.7, 1.4)
"""Ratio of a coarse difference to its prediction within which a ladder counts as asymptotic."""


@dataclass(frozen=True)
class Extrapolation:
    """Order, extrapolated value and error bound of one observable on one ladder.

    ``orders`` are those of every three neighbouring levels, coarse to fine, from differences alone; ``None``
    where they go to and fro, do not differ, or a level failed. ``richardson`` is extrapolated to ``h = 0``
    from the finest two levels with the finest observed order. ``bound`` is the grid convergence index of the
    finest level, relative to the scale, with its ``safety`` factor. ``asymptotic`` is a difference two levels
    coarser than the finest over its prediction by the finest three levels; 1 on an exact power law. (The
    usual ratio of two grid convergence indices is 1 by construction when both take the same observed order; a
    fourth level is needed to test anything.)
    """

    orders: tuple[float | None, ...]
    richardson: float | None
    bound: float | None
    safety: float | None
    asymptotic: float | None
    verdict: str


def extrapolate(
    sizes: Sequence[float], values: Sequence[float | None], nominal: float, scale: float
) -> Extrapolation:
    """Extrapolate to ``h = 0`` and bound the error, from the differences of the values alone.

    The extrapolation ``f* = f1 + (f1 - f2)/(r^p - 1)`` (Richardson 1927) and the grid convergence index
    ``safety |f1 - f2|/(r^p - 1)/scale`` (Roache 1994) use the finest three levels that did not fail, the test
    of the order the fourth. Sizes fall; values are ``None`` where a level failed; ``scale`` is the magnitude
    that bound and round-off are relative to, in the unit of the values.
    """
    _check(sizes)
    orders = tuple(observed_order(sizes[i : i + 3], values[i : i + 3], scale) for i in range(len(sizes) - 2))
    known = [(h, f) for h, f in zip(sizes, values, strict=True) if f is not None]
    if len(known) < 3:
        return Extrapolation(orders, None, None, None, None, "fewer than three levels have a value")
    h, f = [pair[0] for pair in known], [pair[1] for pair in known]
    jumps = [d for a, b in pairwise(f) if (d := abs(b - a)) > ROUND_OFF * scale]
    if not jumps:
        return Extrapolation(orders, f[-1], 0.0, None, None, "no level differs")
    last = f[-1] - f[-2]
    if abs(last) <= ROUND_OFF * scale:  # a quantity that moves in jumps
        verdict = "the finest two do not differ, coarser ones do: bound by the last jump"
        return Extrapolation(orders, None, UNSAFE * jumps[-1] / scale, UNSAFE, None, verdict)
    order = observed_order(h[-3:], f[-3:], scale)
    safety, trusted = UNSAFE, min(max(0.5, order if order is not None else 0.5), nominal)
    if order is not None and order > 0.0 and abs(order - nominal) <= NEAR * nominal:
        safety, trusted = SAFE, nominal
    bound = safety * abs(last) / ((h[-2] / h[-1]) ** trusted - 1.0) / scale
    if order is None:
        return Extrapolation(orders, None, bound, safety, None, "the values go to and fro: no order")
    if order <= 0.0:
        return Extrapolation(orders, None, bound, safety, None, "the differences grow: not convergent here")
    richardson = f[-1] + last / ((h[-2] / h[-1]) ** order - 1.0)
    if len(known) < 4:
        return Extrapolation(orders, richardson, bound, safety, None, "no fourth level to check with")
    predicted = last * (h[-3] ** order - h[-4] ** order) / (h[-1] ** order - h[-2] ** order)
    ratio = (f[-3] - f[-4]) / predicted
    asymptotic = ASYMPTOTIC[0] <= ratio <= ASYMPTOTIC[1]
    verdict = "asymptotic" if asymptotic else "not asymptotic: the order still changes"
    return Extrapolation(orders, richardson, bound, safety, ratio, verdict)


def observed_order(sizes: Sequence[float], values: Sequence[float | None], scale: float) -> float | None:
    """Order ``p`` of three levels from ``(f3 - f2)/(f2 - f1) = (h3^p - h2^p)/(h2^p - h1^p)``.

    ``None`` if a level failed, the values go to and fro, do not differ by more than round-off, or no ``p``
    fits.
    """
    from scipy.optimize import brentq

    (h3, h2, h1), (f3, f2, f1) = sizes, values
    if f3 is None or f2 is None or f1 is None:
        return None
    coarse, fine = f2 - f3, f1 - f2
    if min(abs(coarse), abs(fine)) <= ROUND_OFF * scale or coarse * fine < 0.0:
        return None
    a, b = math.log(h3 / h2), math.log(h2 / h1)

    def excess(p: float) -> float:
        # ln of (r32^p - 1) r21^p / (r21^p - 1), rising in p; (b p) carries the factor h2^p/h1^p
        if abs(p) * max(a, b) < 1e-8:
            ratio = math.log(a / b) + 0.5 * (a - b) * p
        else:
            ratio = math.log(math.expm1(a * p) / math.expm1(b * p))
        return ratio + b * p - math.log(coarse / fine)

    if excess(ORDERS[0]) > 0.0 or excess(ORDERS[1]) < 0.0:
        return None
    return float(brentq(excess, *ORDERS, xtol=1e-13))


def reference_orders(sizes: Sequence[float], errors: Sequence[float | None]) -> tuple[float | None, ...]:
    """Signed order of every two neighbouring levels, ``ln|e_coarse/e_fine| / ln(h_coarse/h_fine)``.

    Negative where the error grows; ``None`` where a level failed or an error is below round-off.
    """
    _check(sizes)
    return tuple(
        None
        if coarse is None or fine is None or min(abs(coarse), abs(fine)) <= ROUND_OFF
        else math.log(abs(coarse / fine)) / math.log(big / small)
        for (coarse, fine), (big, small) in zip(pairwise(errors), pairwise(sizes), strict=True)
    )


def fitted_slope(across: Sequence[float | None], up: Sequence[float | None]) -> float | None:
    """Slope of the line of least squares through the logarithms of positive pairs; ``None`` below three."""
    pairs = [(x, y) for x, y in zip(across, up, strict=True) if x and y and x > 0.0 and y > 0.0]
    if len(pairs) < 3 or len({x for x, _ in pairs}) == 1:
        return None
    x, y = np.log(np.array(pairs, float)).T
    x = x - x.mean()
    return float(x @ y / (x @ x))


def _check(sizes: Sequence[float]) -> None:
    if any(not big > small > 0.0 for big, small in pairwise(sizes)):
        raise ValueError(f"sizes {tuple(sizes)}: must be positive and fall from level to level")
