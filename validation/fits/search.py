"""The search for the parameters of least misfit: least squares within bounds, from several starts.

The first start is the scene's own values, the others are drawn in its neighbourhood; each is followed a few
iterations, and the best to its end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from validation.fits.measured_curve import Array
from validation.fits.problem import FitProblem

SPREAD = np.log(3.0)
"""Starts are drawn within a factor of three about the scene's values: whoever knows less states bounds."""
DRAWN_BEFORE = 4
"""Points drawn for a start, of which the one of least misfit is taken: a point costs no derivatives."""
EXPLORING = 4
"""Evaluations of a start before the starts are compared."""
MOST_EVALUATIONS = 40
"""Evaluations of the last search."""
MISFIT_CHANGE = 1e-5
"""Change of the sum of squares, relative, at which a search ends: of some hundred rows it is far below one,
which is what a parameter moved by its standard deviation costs."""
PARAMETER_CHANGE = 1e-6
"""Change of all parameters, relative, at which a search ends."""


@dataclass(frozen=True)
class Search:
    """What a search found.

    Parameters
    ----------
    x : ndarray, shape (P,)
    residuals : ndarray, shape (R,)
    jacobian : ndarray, shape (R, P)
    ended : str
        Why it ended.
    converged : bool
    starts : tuple of float
        Misfit (sum of squares) of each start after its first iterations.
    """

    x: Array
    residuals: Array
    jacobian: Array
    ended: str
    converged: bool
    starts: tuple[float, ...]


class BestSoFar:
    """The point of least misfit of all that were tried, for whoever interrupts.

    Parameters
    ----------
    problem : FitProblem
    progress : callable, optional
        Called with a line of text at each point.
    """

    def __init__(self, problem: FitProblem, progress: Callable[[str], None] | None = None) -> None:
        self._problem, self._progress = problem, progress
        self.x: Array | None = None
        self.sum_of_squares = np.inf
        self.evaluations = 0
        self.stage = ""

    def residuals(self, x: Array) -> Array:
        """Residuals of the problem; the point is noted."""
        found = self._problem.residuals(x)
        self.evaluations += 1
        total = float(found @ found)
        if total < self.sum_of_squares:
            self.x, self.sum_of_squares = x.copy(), total
        if self._progress is not None:
            now, best = (np.sqrt(value / found.size) for value in (total, self.sum_of_squares))
            self._progress(f"{self.stage}, point {self.evaluations}: misfit {now:.4g}, best {best:.4g}")
        return found


def search(problem: FitProblem, best: BestSoFar, starts: int, seed: int) -> Search:
    """Find the parameters.

    Parameters
    ----------
    problem : FitProblem
    best : BestSoFar
        Keeps the best point, whatever happens.
    starts : int
        How many.
    seed : int
        Of the starts that are drawn.

    Returns
    -------
    Search
    """
    tried = []
    for number, x in enumerate(_starts(problem, best, starts, seed)):
        best.stage = f"start {number + 1} of {starts}"
        tried.append(_followed(problem, best, x, EXPLORING if starts > 1 else MOST_EVALUATIONS))
    costs = [2.0 * float(one.cost) for one in tried]
    last = tried[int(np.argmin(costs))]
    if starts > 1 and last.status == 0:
        best.stage = "best start"
        last = _followed(problem, best, last.x, MOST_EVALUATIONS)
    return Search(last.x, last.fun, last.jac, str(last.message), last.status > 0, tuple(costs))


def _followed(problem: FitProblem, best: BestSoFar, x: Array, evaluations: int) -> Any:
    return least_squares(
        best.residuals,
        x,
        problem.jacobian,
        problem.parameters.bounds,
        x_scale="jac",
        ftol=MISFIT_CHANGE,
        xtol=PARAMETER_CHANGE,
        gtol=None,
        max_nfev=evaluations,
    )


def _starts(problem: FitProblem, best: BestSoFar, starts: int, seed: int) -> list[Array]:
    """Where to begin: the scene's values, then the best of a few points drawn about them for each start."""
    own = problem.parameters.start
    low, high = problem.parameters.bounds
    inside = 1e-9 * np.minimum(high - low, 1.0)
    own = np.clip(own, low + inside, high - inside)
    free = np.array([one.logarithmic for one in problem.parameters.parameters])
    if starts < 2 or not free.any():
        return [own]
    drawn = np.random.default_rng(seed).random((DRAWN_BEFORE * (starts - 1), int(free.sum())))
    found = []
    for group in np.split(drawn, starts - 1):
        points = []
        for shares in group:
            x = own.copy()
            x[free] = np.clip(
                own[free] + SPREAD * (2.0 * shares - 1.0), low[free] + inside[free], high[free] - inside[free]
            )
            best.stage = "drawing starts"
            values = best.residuals(x)
            points.append((float(values @ values), x))
        found.append(min(points, key=lambda point: point[0])[1])
    return [own, *found]
