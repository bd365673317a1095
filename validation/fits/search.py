"""The search for the parameters of least misfit: least squares within bounds, from several starts.

The first start is the scene's own values. If it leads to a model that explains the data there is nothing
better to be found; otherwise more are drawn in its neighbourhood, each is followed a few iterations, and the
best of them to its end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from contact_scene import SceneError
from validation.fits.problem import FitProblem
from validation.fits.record import Array

SPREAD = np.log(3.0)
"""Starts are drawn within a factor of three about the scene's values: whoever knows less states bounds."""
DRAWN_BEFORE = 4
"""Points drawn for a start, of which the one of least misfit is taken: a point costs no derivatives."""
EXPLORING = 4
"""Evaluations of a start before the starts are compared."""
MOST_EVALUATIONS = 40
"""Evaluations of the last search."""
MISFIT_CHANGE = 1e-6
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
        Sum of squares of each start: of the first at its end, of the others after a few iterations.
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


def search(
    problem: FitProblem, best: BestSoFar, starts: int, seed: int, explained: Callable[[Array], bool]
) -> Search:
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
    explained : callable
        Whether residuals are those of a model that explains the data.

    Returns
    -------
    Search
    """
    low, high = problem.parameters.bounds
    inside = 1e-9 * np.minimum(high - low, 1.0)
    own = np.clip(problem.parameters.start, low + inside, high - inside)
    best.stage = "first start"
    if not problem.jacobian(own).any():
        raise _without_influence(problem, own)
    last = _followed(problem, best, own, MOST_EVALUATIONS)
    costs = [2.0 * float(last.cost)]
    if not explained(last.fun):
        for number, x in enumerate(_more_starts(problem, best, own, starts, seed)):
            if not problem.jacobian(x).any():  # nowhere to go from here
                continue
            best.stage = f"start {number + 2} of {starts}"
            other = _followed(problem, best, x, EXPLORING)
            costs.append(2.0 * float(other.cost))
            if other.cost < last.cost:
                last = other
        if last.status == 0:
            best.stage = "best start"
            last = _followed(problem, best, last.x, MOST_EVALUATIONS)
    return Search(last.x, last.fun, last.jac, str(last.message), last.status > 0, tuple(costs))


def _without_influence(problem: FitProblem, x: Array) -> SceneError:
    """The error for a first guess from which no search can set out."""
    points = [problem.parameters.of_curve(x, index) for index in range(len(problem.models))]
    failures = [one.failure for one in problem.predictions(list(enumerate(points))) if one.failure]
    reason = f": {failures[0]}" if failures else ""
    problem_text = f"no parameter changes the force at the first guess{reason}"
    return SceneError("vary", problem_text, "a first guess that comes to contact and can be run")


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


def _more_starts(problem: FitProblem, best: BestSoFar, own: Array, starts: int, seed: int) -> list[Array]:
    """The best of a few points drawn about the scene's values, for each further start.

    Parameters
    ----------
    problem : FitProblem
    best : BestSoFar
    own : ndarray, shape (P,)
        The scene's values.
    starts, seed : int
        The first start included.

    Returns
    -------
    list of ndarray, shape (P,)
    """
    low, high = problem.parameters.bounds
    free = np.array([one.logarithmic for one in problem.parameters.parameters])
    if starts < 2 or not free.any():
        return []
    drawn = np.random.default_rng(seed).random((starts - 1, DRAWN_BEFORE, int(free.sum())))
    best.stage = "drawing starts"
    found = []
    for group in drawn:
        points = []
        for shares in group:
            x = own.copy()
            x[free] = np.clip(own[free] + SPREAD * (2.0 * shares - 1.0), low[free], high[free])
            values = best.residuals(x)
            points.append((float(values @ values), x))
        found.append(min(points, key=lambda point: point[0])[1])
    return found
