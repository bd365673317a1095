"""A fit from curves to estimates: prepare, search, judge, look with a second solver; and of each of many."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError
from contact_scene.scene import with_values
from validation.fits import data_checks
from validation.fits import result as results
from validation.fits.contact import Array, least_squares
from validation.fits.model import CurveModel, FittedCurve, rms
from validation.fits.parameters import FitSettings, Unknown, first_guess, question, unknowns
from validation.fits.posterior import sampled, sampler_module
from validation.fits.problem import FitProblem
from validation.fits.record import MeasuredCurve
from validation.runs.process import caught
from validation.runs.store import Store

MOST_ROWS = 20_000
"""Rows of a curve that are fitted: twenty resolve a thousandth of the record, in which it is smooth."""
OF_PARAMETER = ("value", "deviation", "low", "high")


def fit_curves(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None = None,
    progress: Callable[[str], None] | None = None,
    store: Store | None = None,
) -> results.FitResult:
    """Fit a scene, the first guess and all that is not varied, to curves; the store holds runs, from which an
    interrupted fit goes on."""
    began, curves = time.perf_counter(), named_apart(curves)
    if settings.posterior:
        sampler_module()
    asked, scene = question(curves, scene, settings), first_guess(curves, scene, settings)
    shortened = [curve.means(MOST_ROWS) for curve in curves]
    models = [CurveModel.of(curve, scene, settings.within or 0.0, settings.free) for curve, _ in shortened]
    varied = unknowns(models, scene, settings)
    names = [one.name for one in varied]
    for name in settings.profile:
        if name not in (*names, "all"):
            raise SceneError("profile", f"{name} is not varied", f"all, {', '.join(names)}")
    warnings = [f"{one.name}: fitted are means of {count} rows" for one, count in shortened if count > 1]
    warnings += data_checks.check(models, scene, varied)
    tell = progress or (lambda text: None)
    problem = FitProblem(models, varied, settings, executor, store or Store(), tell)
    best: Array | None = None

    def found() -> results.FitResult:
        x = problem.best if best is None else best
        return judged(problem, x, scene, warnings, question=asked, runs=problem.all_runs)

    try:
        share = problem.search()
        best = problem.best
        result, looks = found(), problem.quick if problem.quick and problem.trusted else problem
        variance = result.goodness.variance
        profiles = tuple(
            looks.profile(place, best, result.estimates[place].deviation, variance)
            for place, name in enumerate(names)
            if {"all", name} & set(settings.profile)
        )
        result = replace(result, profiles=profiles, solver_error_over_noise=share)
        if settings.check_solver not in (None, settings.solver):
            check = by_second_solver(problem, best, variance, settings.check_solver)
            result = replace(result, second_solver=check)
        if settings.posterior:
            try:
                result = replace(result, posterior=sampled(problem, looks, best, variance))
            except SceneError as error:
                result = replace(result, warnings=(*result.warnings, str(error)))
    except KeyboardInterrupt:
        kept = None
        if np.isfinite(problem.least):
            tell("interrupted: the errors of the best so far are worked out (once more ends at once)")
            problem.ended = "interrupted"
            caught()
            with suppress(KeyboardInterrupt):
                kept = found()
        raise results.InterruptedFit(kept) from None
    return replace(result, runs=problem.all_runs, seconds=time.perf_counter() - began)


def judged(
    problem: FitProblem, x: Array, scene: Scene, warnings: Sequence[str], **how: Any
) -> results.FitResult:
    """Errors and goodness of the point at which a search ended; ``how`` it was carried out."""
    from scipy.linalg import block_diag

    point, curves = problem.at(x), problem.curves_at(x)
    good = results.goodness(curves, problem.residuals(x), problem.settings, x.size)
    unknowns, found = list(problem.unknowns), x.tolist()
    for at, one in enumerate(curves):  # parts of the background start from nothing and have no bounds
        for (part, column), much in zip(one.model.parts.items(), one.background.tolist(), strict=True):
            name, scale = f"{part}@{one.curve.name}", 1.0 / float(np.abs(column).max())
            unknowns.append(Unknown(name, 0.0, -math.inf, math.inf, False, scale, at))
            found.append(much / scale)
    columns = block_diag(*(one.columns for one in point)) * [one.scale for one in unknowns[x.size :]]
    whole = np.column_stack([problem.derivatives(x), columns]) * results.independent(point)[:, None]
    names, positive = [one.name for one in unknowns], np.array([one.logarithmic for one in unknowns])
    spread = results.covariance(whole, good.variance)[0]
    told = "the run of the best point did not reach its end"
    return results.FitResult(
        scene=with_values(scene, problem.values(x)),
        settings=problem.settings,
        curves=tuple(curves),
        estimates=tuple(map(results.Estimate.of, unknowns, found, np.diag(spread).tolist())),
        correlations=(together := results.correlation(spread)),
        combinations=results.combinations(names, whole, positive, good.variance),
        hardly_told_apart=results.confused(names, together),
        goodness=good,
        warnings=(*warnings, *(f"{one.curve.name}: {told}: {one.failure}" for one in curves if one.failure)),
        step_tolerance=problem.tolerance,
        ended=problem.ended,
        converged=problem.converged,
        starts=tuple(problem.starts),
        **how,
    )


def by_second_solver(problem: FitProblem, x: Array, variance: float, solver: str) -> dict[str, Any]:
    """The fitted curves once more by another solver, and how far it would have moved the parameters."""
    problem.tell(f"the same curves by {solver}")
    settings, point = replace(problem.settings, solver=solver, resolution=None), problem.at(x)
    other = replace(problem, settings=settings, tolerance=None, quick=None, tell=lambda text: None).at(x)
    change = [two.values - one.values for one, two in zip(point, other, strict=True)]
    differences: list[dict[str, Any]] = []
    for one, two, apart in zip(point, other, change, strict=True):
        if isinstance(one, FittedCurve) and isinstance(two, FittedCurve):
            own = apart[: one.of_run.size][one.compared] * one.model.allowed / one.model.moments.noise
            relative = rms(own) * one.model.moments.noise / rms(one.curve.force)
            found = {"curve": one.curve.name, "root_mean_square": rms(own)}
            found |= {"largest": float(np.abs(own).max()), "relative": relative, "failure": two.failure}
            differences.append(found)
    slopes, shifts = problem.derivatives(x, following=True), {}
    spread = np.diag(results.covariance(slopes * results.independent(point)[:, None], variance)[0])
    if not any(one["failure"] for one in differences) and np.isfinite(spread).all():
        moved = -least_squares(slopes, np.concatenate(change)) / np.sqrt(spread)
        shifts = dict(zip(problem.names, moved.tolist(), strict=True))
    return {"solver": solver, "differences": differences, "shifts": shifts}


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
    result: results.FitResult | None = None
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
    def estimates(self) -> dict[str, results.Estimate]:
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
