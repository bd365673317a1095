"""A fit from curves to estimates: prepare, search, judge, look with a second solver."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from validation.fits import data_checks
from validation.fits.curve_model import CurveModel
from validation.fits.fineness import fineness
from validation.fits.fit_outcome import explained, judged, unfinished
from validation.fits.fit_result import FitResult, InterruptedFit
from validation.fits.fit_settings import FitSettings
from validation.fits.parameters import CONTACT_POINT, ParameterSet
from validation.fits.problem import FitProblem
from validation.fits.profile_likelihood import LikelihoodProfile, likelihood_profile
from validation.fits.record import Array, MeasuredCurve
from validation.fits.search import BestSoFar, Search, search
from validation.fits.second_solver import SecondSolver, second_solver
from validation.fits.statistics import covariance
from validation.fits.unknowns import bending, unknowns, with_grid, with_spring
from validation.runs.provenance import hashed
from validation.runs.store import Store
from validation.solvers import REFERENCE

MOST_ROWS = 20_000
"""Rows of a curve that are fitted: they resolve a thousandth of the record with twenty rows, and the mean of
more loses nothing that the motion's straight lines and a smooth force hold."""


def question(curves: Sequence[MeasuredCurve], scene: Scene, settings: FitSettings) -> dict[str, str]:
    """Hashes of curves, first guess and parameters; not of how the fit is carried out."""
    varied = settings.vary, settings.tie, settings.per_curve, settings.free, settings.prony
    return {
        "curves": hashed([replace(curve, name="") for curve in curves]),
        "first guess": hashed(scene),
        "parameters": hashed(varied),
    }


def fit_curves(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None = None,
    store: Store | None = None,
    progress: Callable[[str], None] | None = None,
) -> FitResult:
    """Fit a scene to curves.

    Parameters
    ----------
    curves : sequence of MeasuredCurve
    scene : Scene
        First guess, and all that is not varied; its loading steps give way to the measured motions.
    settings : FitSettings
    executor : Executor, optional
        Carries out the runs of a derivative side by side.
    store : Store, optional
        Of runs, from which an interrupted fit goes on.
    progress : callable, optional
        Called with a line of text.

    Returns
    -------
    FitResult

    Raises
    ------
    SceneError
        One line, if data or settings are no good.
    InterruptedFit
        At Ctrl-C.
    """
    began = time.perf_counter()
    curves = _named_apart(curves)
    asked = question(curves, scene, settings)
    scene, settings = with_grid(with_spring(scene, curves), settings)
    problem, warnings = _prepared(curves, scene, settings, executor, store)
    best = BestSoFar(problem, progress)
    error_share: float | None = None
    finished: Search | None = None
    try:
        problem.check_first_guess()
        if settings.resolution is None and settings.solver == REFERENCE:
            problem.tolerance, error_share, problem.step = fineness(problem)
        finished = search(problem, best, settings.starts, settings.seed, partial(explained, problem))
        result = judged(problem, finished, scene, settings, warnings)
        profiles = _profiles(problem, finished.x, result, progress)
        check = _checked(problem, finished, result, progress)
    except KeyboardInterrupt:
        if best.x is None:
            raise InterruptedFit(None) from None
        if progress is not None:
            progress("interrupted: the errors of the best so far are worked out (once more ends at once)")
        found = unfinished(problem, best, finished, scene, settings, warnings)
        raise InterruptedFit(None if found is None else replace(found, question=asked)) from None
    return replace(
        result,
        profiles=profiles,
        check=check,
        error_share=error_share,
        runs=problem.runs,
        seconds=time.perf_counter() - began,
        question=asked,
    )


def first_guesses(
    curves: Sequence[MeasuredCurve], scene: Scene, settings: FitSettings
) -> Iterator[tuple[str, Scene]]:
    """The scene with which the search sets out, for each curve that ever comes to contact, with its name.

    Parameters
    ----------
    curves, scene, settings
        As of :func:`fit_curves`.

    Yields
    ------
    (str, Scene)

    Raises
    ------
    SceneError
        As of :func:`fit_curves`.
    """
    curves = _named_apart(curves)
    problem, _ = _prepared(curves, *with_grid(with_spring(scene, curves), settings), None, None)
    for index, model in enumerate(problem.models):
        values, instrument = problem.parameters.of_curve(problem.parameters.start, index)
        asked = model.scene_of(values, instrument[CONTACT_POINT])
        if asked is not None:
            yield model.curve.name, asked[0]


def _prepared(
    curves: Sequence[MeasuredCurve],
    scene: Scene,
    settings: FitSettings,
    executor: Executor | None,
    store: Store | None,
) -> tuple[FitProblem, list[str]]:
    """The problem to be solved, and warnings about the curves.

    Parameters
    ----------
    curves : sequence of MeasuredCurve
    scene : Scene
    settings : FitSettings
    executor : Executor or None
    store : Store or None

    Returns
    -------
    problem : FitProblem
    warnings : list of str
    """
    shortened = [curve.means(MOST_ROWS) for curve in curves]
    models = [CurveModel.of(curve, scene) for curve, _ in shortened]
    for model in models:
        data_checks.require_contact(model)
    parameters = ParameterSet(tuple(unknowns(models, scene, settings)))
    _check_profiles(parameters, settings)
    warnings = [f"{one.name}: fitted are means of {count} rows" for one, count in shortened if count > 1]
    warnings += [text for model in models for text in data_checks.check(model, parameters)]
    warnings += [text for curve in curves for text in data_checks.of_spring(curve, scene, parameters)]
    problem = FitProblem(
        models,
        parameters,
        settings.solver,
        settings.resolution,
        executor=executor,
        store=store or Store(),
        penalty=bending(settings) if len(settings.prony) > 2 and settings.regularisation > 0.0 else None,
        max_steps=settings.max_steps,
    )
    return problem, warnings


def _check_profiles(parameters: ParameterSet, settings: FitSettings) -> None:
    names = [one.name for one in parameters.parameters]
    for name in settings.profile:
        if name not in (*names, "all"):
            raise SceneError("profile", f"{name} is not varied", f"all, {', '.join(names)}")


def _checked(
    problem: FitProblem, found: Search, result: FitResult, progress: Callable[[str], None] | None
) -> SecondSolver | None:
    """What the second solver says, if there is one.

    Parameters
    ----------
    problem : FitProblem
    found : Search
    result : FitResult
    progress : callable or None

    Returns
    -------
    SecondSolver or None
    """
    solver = result.settings.check_solver
    if solver is None or solver == result.settings.solver:
        return None
    if progress is not None:
        progress(f"the same curves by {solver}")
    spread = covariance(found.jacobian, result.goodness)[0]
    return second_solver(problem, found.x, found.jacobian, spread, solver, None)


def _profiles(
    problem: FitProblem, x: Array, result: FitResult, progress: Callable[[str], None] | None
) -> tuple[LikelihoodProfile, ...]:
    """The profiles that were asked for.

    Parameters
    ----------
    problem : FitProblem
    x : ndarray, shape (P,)
    result : FitResult
    progress : callable or None

    Returns
    -------
    tuple of LikelihoodProfile
    """
    names = [one.name for one in problem.parameters.parameters]
    asked = result.settings.profile
    wanted = names if "all" in asked else [name for name in names if name in asked]
    scale = result.goodness.variance
    made = []
    for name in wanted:
        place = names.index(name)
        one, estimate = problem.parameters.parameters[place], result.estimates[place]
        deviation = estimate.deviation if one.logarithmic else estimate.deviation / one.scale
        made.append(likelihood_profile(problem, place, x, deviation, scale, progress))
    return tuple(made)


def _named_apart(curves: Sequence[MeasuredCurve]) -> list[MeasuredCurve]:
    """Curves with names that differ."""
    if isinstance(curves, MeasuredCurve):
        curves = [curves]
    if not curves or not all(isinstance(curve, MeasuredCurve) for curve in curves):
        raise SceneError(
            "curves", f"got {shown(curves)}", "one or several MeasuredCurve, as read_curves gives them"
        )
    names: dict[str, int] = {}
    made = []
    for curve in curves:
        names[curve.name] = names.get(curve.name, 0) + 1
        again = names[curve.name]
        made.append(curve if again == 1 else replace(curve, name=f"{curve.name}-{again}"))
    return made
