"""Profile likelihood: the least misfit as a function of one parameter, all others fitted anew.

Where it has grown by ``3.84``, the 95 % point of chi-squared with one degree of freedom, the interval ends
(Venzon and Moolgavkar, Appl. Stat. 37, 87, 1988). Unlike the covariance it need not be symmetric, and shows
where a parameter has no lower or upper end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import least_squares

from validation.fits.problem import FitProblem
from validation.fits.record import Array
from validation.fits.statistics import CONFIDENCE

STEPS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
"""Distances from the best value at which the others are fitted, in standard deviations."""
WIDEST = 1.0
"""Standard deviation that the distances are taken of, at most: a factor of 20 on each side."""
EVALUATIONS = 6
"""Of each fit of the others, which starts beside the one before."""


@dataclass(frozen=True)
class LikelihoodProfile:
    """The profile of one parameter.

    Parameters
    ----------
    name : str
    values, increases : ndarray, shape (n,)
        Of the parameter, and of the sum of squares over its least (over the noise actually seen).
    low, high : float or None
        95 % interval; ``None`` where the profile does not grow enough within the distances tried.
    """

    name: str
    values: Array
    increases: Array
    low: float | None
    high: float | None


def likelihood_profile(
    problem: FitProblem,
    place: int,
    x: Array,
    deviation: float,
    scale: float,
    progress: Callable[[str], None] | None = None,
) -> LikelihoodProfile:
    """The profile of a parameter about the best point.

    Parameters
    ----------
    problem : FitProblem
    place : int
        Of the parameter.
    x : ndarray, shape (P,)
        The best point.
    deviation : float
        Standard deviation of the parameter, in numbers of the search.
    scale : float
        Variance of a residual, 1 if the noise explains it.
    progress : callable, optional
        Called with a line of text.

    Returns
    -------
    LikelihoodProfile
    """
    one = problem.parameters.parameters[place]
    low, high = problem.parameters.bounds
    others = np.delete(np.arange(x.size), place)
    size = min(deviation, WIDEST)
    best = problem.residuals(x)
    least = float(best @ best)
    points = [(float(x[place]), 0.0)]
    for sign in (-1.0, 1.0):
        start = x.copy()
        for step in STEPS:
            at = float(np.clip(x[place] + sign * step * size, low[place], high[place]))
            start[place] = at
            start, total = _others_fitted(problem, others, start, low, high)
            points.append((at, (total - least) / scale))
            if progress is not None:
                progress(f"profile of {one.name}: {one.value(at):.4g}")
            if at in (low[place], high[place]):
                break
    points.sort()
    at, increase = np.array(points).T
    increase = np.maximum(increase, 0.0)
    limit = float(stats.chi2.ppf(CONFIDENCE, 1))
    middle = int(np.flatnonzero(at == x[place])[0])
    ends = [
        _crossing(at[middle::-1], increase[middle::-1], limit),
        _crossing(at[middle:], increase[middle:], limit),
    ]
    values = np.array([one.value(float(a)) for a in at])
    found = [None if end is None else one.value(end) for end in ends]
    return LikelihoodProfile(one.name, values, increase, *found)


def _others_fitted(
    problem: FitProblem, others: NDArray[np.int64], start: Array, low: Array, high: Array
) -> tuple[Array, float]:
    """The point of least misfit with one parameter fixed, and its sum of squares.

    Parameters
    ----------
    problem : FitProblem
    others : ndarray of int, shape (P - 1,)
        Places of the free parameters.
    start, low, high : ndarray, shape (P,)

    Returns
    -------
    x : ndarray, shape (P,)
    total : float
    """
    if not others.size:
        residuals = problem.residuals(start)
        return start, float(residuals @ residuals)
    columns = others

    def whole(free: Array) -> Array:
        x = start.copy()
        x[columns] = free
        return x

    found = least_squares(
        lambda free: problem.residuals(whole(free)),
        np.clip(start[columns], low[columns], high[columns]),
        lambda free: problem.jacobian(whole(free))[:, columns],
        (low[columns], high[columns]),
        x_scale="jac",
        ftol=1e-4,
        xtol=1e-5,
        gtol=None,
        max_nfev=EVALUATIONS,
    )
    return whole(found.x), 2.0 * float(found.cost)


def _crossing(at: Array, increase: Array, limit: float) -> float | None:
    """Where a profile passes the limit first, between two points by the root of the increase."""
    above = np.flatnonzero(increase >= limit)
    if not above.size:
        return None
    last = int(above[0])
    before, after = np.sqrt(increase[last - 1]), np.sqrt(increase[last])
    share = (np.sqrt(limit) - before) / (after - before) if after > before else 1.0
    return float(at[last - 1] + share * (at[last] - at[last - 1]))
