"""A fit from curves to estimates: prepare, search, judge, look with a second solver; and of each of many.

The first start of the search is the scene's own values. If it leads to a model that explains the data there
is nothing better to be found; otherwise more are drawn in its neighbourhood, each is followed a few
iterations, and the best of all to its end. Where the batch solver takes the runs all this is done with it,
and a last search from there has the residuals of the reference; if the two disagree, all is done again.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError
from validation.fits import data_checks
from validation.fits.contact import Array
from validation.fits.model import CurveModel, first_passing
from validation.fits.posterior import sampled, sampler_module
from validation.fits.problem import (
    ERROR_SHARE,
    SETTLED,
    TOLERANCES,
    BatchProblem,
    FitProblem,
    FitSettings,
    Point,
    first_guess,
    question,
    unknowns,
)
from validation.fits.record import MeasuredCurve
from validation.fits.result import (
    CHI_SQUARED,
    Estimate,
    FitResult,
    InterruptedFit,
    LikelihoodProfile,
    SecondSolver,
    covariance,
    goodness,
    independent,
    judged,
    rms,
)
from validation.runs.store import Store
from validation.solvers import REFERENCE

MOST_ROWS = 20_000
"""Rows of a curve that are fitted: twenty resolve a thousandth of the record, in which it is smooth."""
ORDER_TWO = 4.0 / 3.0
"""Error of a run over its difference from a run of half the step, for a method of second order."""
SMALLEST_STEP, LARGEST_STEP = 1e-4, 1e-2
"""Bounds of the step of differences, the root of the relative error of a run: the best if the errors of two
neighbouring runs have nothing in common."""
SPREAD, DRAWN_BEFORE = np.log(3.0), 4
"""Starts are drawn within a factor of three about the scene's values (whoever knows less states bounds); of
so many points the one of least misfit is taken."""
EXPLORING, MOST_EVALUATIONS, PROFILING = 4, 40, 6
"""Evaluations of a start before starts are compared, of the last search, and with one parameter held."""
STEPS, WIDEST = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0), 1.0
"""Distances from the best value at which a profile fits the others, in standard deviations of at most one: a
factor of 20 on each side."""
OF_PARAMETER = ("value", "deviation", "low", "high")


def fit_curves(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None = None,
    progress: Callable[[str], None] | None = None,
    store: Store | None = None,
) -> FitResult:
    """Fit a scene, the first guess and all that is not varied, to curves; the store holds runs, from which an
    interrupted fit goes on."""
    began, curves = time.perf_counter(), named_apart(curves)
    if settings.posterior:
        sampler_module()
    asked, scene = question(curves, scene, settings), first_guess(curves, scene, settings)
    shortened = [curve.means(MOST_ROWS) for curve in curves]
    models = [CurveModel.of(curve, scene, settings.within or 0.0) for curve, _ in shortened]
    varied = unknowns(models, scene, settings)
    names = [one.name for one in varied]
    for name in settings.profile:
        if name not in (*names, "all"):
            raise SceneError("profile", f"{name} is not varied", f"all, {', '.join(names)}")
    warnings = [f"{one.name}: fitted are means of {count} rows" for one, count in shortened if count > 1]
    warnings += data_checks.check(models, scene, varied)
    problem = FitProblem(models, varied, settings, executor, store or Store())
    search = Search(problem, progress)

    def found() -> FitResult:
        how = {"ended": search.ended, "converged": search.converged, "starts": tuple(search.starts)}
        return judged(problem, search.x, scene, warnings, question=asked, runs=search.runs, **how)

    try:
        share = search.carry_out()
        result, best = found(), search.x.copy()
        held = [place for place, name in enumerate(names) if {"all", name} & set(settings.profile)]
        profiles = tuple(copy(search).profile(place, best, result) for place in held)
        check = search.by_second_solver(best, result)
        result = replace(result, profiles=profiles, check=check, error_share=share)
        if settings.posterior:
            try:
                result = replace(result, posterior=sampled(problem, best, result, search.price, search.tell))
            except SceneError as error:
                result = replace(result, warnings=(*result.warnings, str(error)))
    except KeyboardInterrupt:
        kept = None
        if np.isfinite(search.least):
            search.tell("interrupted: the errors of the best so far are worked out (once more ends at once)")
            search.ended = "interrupted"
            with suppress(KeyboardInterrupt):
                kept = found()
        raise InterruptedFit(kept) from None
    return replace(result, runs=search.runs, seconds=time.perf_counter() - began)


def choose_steps(problem: FitProblem, x: Array) -> float | None:
    """Give the runs the coarsest time steps with an error small beside the noise, and differences a step;
    the error over the noise at a point comes back, if it was for the fit to choose."""
    if problem.settings.resolution is not None or problem.settings.solver != REFERENCE:
        return None
    data = np.concatenate([model.curve.force / model.allowed for model in problem.models])
    problem.tolerance = TOLERANCES[0]
    coarse = problem.residuals(x)
    for kept, finer in pairwise(TOLERANCES):
        problem.tolerance = finer
        fine = problem.residuals(x)
        change = np.concatenate([(fine - coarse)[rows] for rows in problem.force_rows])
        share, coarse = ORDER_TWO * rms(change), fine
        problem.tolerance = kept
        if share <= ERROR_SHARE:
            break
    problem.step = float(np.clip(np.sqrt(share / rms(data)), SMALLEST_STEP, LARGEST_STEP))
    return share


class Search:
    """Least squares within bounds, which knows the best point of all that were tried."""

    def __init__(self, problem: FitProblem, progress: Callable[[str], None] | None) -> None:
        self.problem, self.tell = problem, progress or (lambda text: None)
        self.x, self.least = problem.start, np.inf
        self.starts: list[float] = []
        self.ended, self.converged = "interrupted", False
        self._stage, self._points, self.price = "first guess", 0, np.nan
        self._looks, self._all = problem, [problem]
        problem.on_run = self._first_runs

    @property
    def runs(self) -> int:
        """How many were carried out, in batches or by themselves."""
        return sum(one.runs for one in self._all)

    def _first_runs(self) -> None:
        """Say that it moves before there is a point."""
        if not np.isfinite(self.least):
            self.tell(f"{self._stage}, run {self.runs}")

    def residuals(self, x: Array) -> Array:
        """Residuals of the problem; the point is noted."""
        found = self._looks.residuals(x)
        self._points += 1
        total = float(found @ found)
        if total < self.least:
            self.x, self.least = x.copy(), total
        now, best = (np.sqrt(value / found.size) for value in (total, self.least))
        self.tell(f"{self._stage}, point {self._points}: misfit {now:.4g}, best {best:.4g}")
        return found

    def carry_out(self) -> float | None:
        """Find the parameters, from as many starts as it takes; the error over the noise comes back."""
        problem = self.problem
        quick = problem.quick = BatchProblem.of(problem)
        self._all = [problem] if quick is None else [quick, problem]
        for looks in self._all:
            began, stage = time.perf_counter(), "first start"
            if looks is problem:
                self._stage = "choosing time steps"
                share = choose_steps(problem, self.x)
                if quick and quick.agrees(problem, self.x):
                    stage = "by the reference"
                else:
                    problem.quick, self.x, self.starts = None, problem.start, []
            self._looks, self.least, self._stage = looks, np.inf, stage
            nowhere = [one for one in looks.at(self.x).predictions if not one.touching.any()]
            if nowhere or not looks.derivatives(self.x).any():
                reason = "".join(f": {one.failure}" for one in nowhere[:1])
                told = f"no parameter changes the force at the first guess{reason}"
                raise SceneError("vary", told, "a first guess that comes to contact and can be run")
            followed = self._followed(self.x, MOST_EVALUATIONS)
            if len(self.starts) < 2:  # or more were followed in batches
                self.starts = [float(followed.chisqr)]
                followed = self._best_of_more() or followed
            self.price = (time.perf_counter() - began) / looks.runs
        self.ended, self.converged = str(followed.message), bool(followed.success)
        return share

    def _best_of_more(self) -> Any:
        """The search from the best of further starts, each the best of a few points drawn about the scene's
        values, if the first explains too little and one of them is better."""
        problem, settings, first = self.problem, self.problem.settings, self.least
        free = [one.logarithmic for one in problem.unknowns]
        if goodness(self._looks, self._looks.at(self.x)).explained or not any(free):
            return None
        shape = settings.starts - 1, DRAWN_BEFORE, problem.start.size
        drawn = np.random.default_rng(settings.seed).uniform(-SPREAD, SPREAD, shape)
        groups = np.clip(problem.start + drawn * free, *problem.bounds)
        starts = [min(points, key=lambda x: float(np.sum(self.residuals(x) ** 2))) for points in groups]
        for number, x in enumerate(starts, 2):
            self._stage = f"start {number} of {settings.starts}"
            self.starts.append(float(self._followed(x, EXPLORING).chisqr))
        self._stage = "best start"
        return self._followed(self.x, MOST_EVALUATIONS) if self.least < first else None

    def _followed(self, x: Array, evaluations: int, held: int | None = None) -> Any:
        """Least squares from a point, of all parameters but one that is held."""
        try:
            import lmfit
        except ImportError:
            raise SceneError("", "lmfit is not installed", "pip install 'crosscontact[fit]'") from None
        box = lmfit.Parameters()
        for place, (value, low, high) in enumerate(zip(x, *self.problem.bounds, strict=True)):
            box.add(f"x{place}", value, vary=place != held, min=low, max=high)
        varied = [place for place in range(x.size) if place != held]
        search = lmfit.Minimizer(lambda values: self.residuals(_point(values)), box)
        with np.errstate(invalid="ignore"):  # in its own errors, where parameters stand for each other
            return search.least_squares(
                max_nfev=evaluations,
                Dfun=lambda values: self._looks.jacobian(_point(values))[:, varied],
                x_scale="jac",
                ftol=SETTLED / self.problem.size,
                xtol=1e-6,
                gtol=None,
            )

    def profile(self, place: int, best: Array, result: FitResult) -> LikelihoodProfile:
        """Profile likelihood of a parameter, whose interval ends where the least sum of squares has grown by
        the 95 % point of chi-squared (Venzon and Moolgavkar, Appl. Stat. 37, 87, 1988)."""
        problem = self._looks = self.problem.quick or self.problem
        one, deviation = problem.unknowns[place], result.estimates[place].deviation
        low, high = (bounds[place] for bounds in problem.bounds)
        size = min(deviation if one.logarithmic else deviation / one.scale, WIDEST)
        point, points = problem.at(best), {float(best[place]): 0.0}
        least = self._weighed(point, best)
        for sign in (-1.0, 1.0):
            x = best.copy()
            for step in STEPS:
                x[place] = float(np.clip(best[place] + sign * step * size, low, high))
                self._stage = f"profile of {one.name} at {one.value(x[place]):.4g}"
                if len(x) > 1:
                    x = _point(self._followed(x, PROFILING, held=place).params)
                increase = (self._weighed(point, x) - least) / result.goodness.variance
                points[float(x[place])] = max(increase, 0.0)
        at, increases = np.array(sorted(points.items())).T
        middle = int(np.searchsorted(at, best[place]))
        sides = slice(middle, None, -1), slice(middle, None)
        plain = (first_passing(at[s], np.sqrt(increases[s]), np.sqrt(CHI_SQUARED)) for s in sides)
        ends = (None if end is None else one.value(end) for end in plain)
        return LikelihoodProfile(one.name, np.array(list(map(one.value, at.tolist()))), increases, *ends)

    def _weighed(self, best: Point, x: Array) -> float:
        """Sum of squares of the residuals at a point, correlated ones as those of the best point are."""
        return float(np.sum(independent(self._looks, best, self._looks.residuals(x)) ** 2))

    def by_second_solver(self, x: Array, result: FitResult) -> SecondSolver | None:
        """The fitted curves once more by another solver, and how far it would have moved the parameters."""
        problem, solver = self.problem, result.settings.check_solver
        if solver is None or solver == result.settings.solver:
            return None
        self.tell(f"the same curves by {solver}")
        settings = replace(problem.settings, solver=solver, resolution=None)
        point, by_other = problem.at(x), replace(problem, settings=settings, tolerance=None).at(x)
        change = by_other.residuals - point.residuals
        differences: list[dict[str, Any]] = []
        for model, rows, run in zip(problem.models, problem.force_rows, by_other.predictions, strict=True):
            own = change[rows][point.hold[rows]] * model.allowed / model.moments.noise
            relative = rms(own) * model.moments.noise / rms(model.curve.force)
            one = {"curve": model.curve.name, "root_mean_square": rms(own)}
            one |= {"largest": float(np.abs(own).max()), "relative": relative, "failure": run.failure}
            differences.append(one)
        slopes, shifts = problem.jacobian(x), {}
        spread = np.diag(covariance(independent(problem, point, slopes), result.goodness.variance)[0])
        if not any(one["failure"] for one in differences) and np.isfinite(spread).all():
            moved = -np.linalg.lstsq(slopes, change, rcond=None)[0] / np.sqrt(spread)
            shifts = dict(zip(problem.names, moved.tolist(), strict=True))
        return SecondSolver(solver, tuple(differences), shifts)


def _point(values: Any) -> Array:
    """The numbers of the search that parameters of lmfit are."""
    return np.array(list(values.valuesdict().values()))


def named_apart(curves: Sequence[MeasuredCurve]) -> list[MeasuredCurve]:
    """Curves with names that differ."""
    if not curves:
        raise SceneError("curves", "there are none", "one or several MeasuredCurve, or paths of files")
    names = [curve.name for curve in curves]
    before = [names[:place].count(name) for place, name in enumerate(names)]
    named = zip(curves, before, strict=True)
    return [replace(curve, name=f"{curve.name}-{n + 1}") if n else curve for curve, n in named]


@dataclass(frozen=True)
class EachFit:
    """One curve of many with what its fit found, or why there is none."""

    curve: str
    result: FitResult | None = None
    refusal: SceneError | None = None

    @property
    def failure(self) -> str:
        """Why there is no result, if there is none."""
        return "" if self.refusal is None else str(self.refusal)

    @property
    def explained(self) -> bool:
        """Whether there is a model that explains the data."""
        return self.result is not None and self.result.converged and self.result.goodness.explained

    @property
    def estimates(self) -> dict[str, Estimate]:
        """Each parameter by its name without that of the curve."""
        found = () if self.result is None else self.result.estimates
        return {one.name.partition("@")[0]: one for one in found}


def fit_each(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None = None,
    progress: Callable[[str], None] | None = None,
    store: Store | None = None,
) -> Iterator[EachFit]:
    """Fit every curve by itself, whatever becomes of the others, from the answer of the last one in the order
    of the record whose data were explained; contact points start from what each record shows of itself."""
    alone = replace(settings, vary=(*settings.vary, *settings.per_curve), per_curve=())
    guess, store = scene, store or Store()
    for number, curve in enumerate(named_apart(curves), 1):

        def tell(text: str, where: str = f"{number} of {len(curves)}, {curve.name}") -> None:
            if progress is not None:
                progress(f"{where}: {text}")

        try:
            one = EachFit(curve.name, fit_curves([curve], guess, alone, executor, tell, store))
        except SceneError as error:
            one = EachFit(curve.name, refusal=error)
        if one.explained and one.result is not None:
            guess = one.result.scene
        yield one


def dataset(found: Sequence[EachFit]) -> Any:
    """All numbers as an ``xarray.Dataset`` over ``curve`` and ``parameter``; NaN where a fit has none."""
    try:
        import xarray
    except ImportError:
        raise SceneError("", "xarray is not installed", "pip install 'crosscontact[fit]'") from None
    parameters = list(dict.fromkeys(name for one in found for name in one.estimates))
    variables: dict[str, Any] = {}
    for of in OF_PARAMETER:
        values = [[getattr(one.estimates.get(name), of, np.nan) for name in parameters] for one in found]
        variables[of] = ("curve", "parameter"), np.array(values)
    variables["explained"] = "curve", np.array([one.explained for one in found])
    goods = [None if one.result is None else one.result.goodness for one in found]
    for name in ("misfit_over_noise", "rms_over_range"):
        variables[name] = "curve", [getattr(good, name, np.nan) for good in goods]
    variables["failure"] = "curve", np.array([one.failure for one in found], str)
    return xarray.Dataset(variables, {"curve": [one.curve for one in found], "parameter": parameters})
