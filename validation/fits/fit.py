"""A fit from curves to estimates: prepare, search, judge."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene import Branch, Scene, SceneError
from contact_scene.errors import not_negative, positive, shown
from contact_scene.run_control import whole_number
from contact_scene.scene_values import with_values
from validation.execution.store import Store
from validation.fits import data_checks
from validation.fits.curve_model import CurveModel
from validation.fits.measured_curve import Array, MeasuredCurve
from validation.fits.parameters import (
    BASELINE,
    CONTACT_POINT,
    DRIFT,
    INSTRUMENT,
    TIME_OFFSET,
    FitParameter,
    ParameterSet,
    scene_parameter,
)
from validation.fits.problem import FitProblem
from validation.fits.profile_likelihood import LikelihoodProfile, likelihood_profile
from validation.fits.search import BestSoFar, Search, search
from validation.fits.second_solver import SecondSolver, second_solver
from validation.fits.statistics import (
    Combination,
    Estimate,
    Goodness,
    bound_notes,
    combinations,
    confused,
    correlation,
    covariance,
    estimates,
    goodness,
)
from validation.solvers import REFERENCE

TOLERANCES = (1.6e-4, 4e-5, 1e-5, 2.5e-6)
"""Tolerances of the reference's time steps that are tried: each is half the step of the one before, the first
is four steps per process zone, the fewest that resolve one."""
ERROR_SHARE = 0.05
"""Error of a run over the noise (root mean square), at most: it moves a parameter by a twentieth of its
standard deviation at the worst."""
ORDER_TWO = 4.0 / 3.0
"""Error of a run over its difference from one of half the step, for a method of second order."""
SMALLEST_STEP, LARGEST_STEP = 1e-4, 1e-2
"""Bounds of the step of differences: the root of the relative error of a run, which makes the error of a
derivative least if the errors of two neighbouring runs have nothing in common, lies between them."""
TIME_SHARE = 0.1
"""Time offset over the duration of a record, at most."""
REGULARISATION = 0.1
"""Weight of the squared second differences of the logarithms of Prony weights, beside squares of residuals:
neighbours on the grid may bend by a factor of exp(3) at the cost of one standard deviation."""


@dataclass(frozen=True)
class FitSettings:
    """What to fit and how.

    Parameters
    ----------
    vary : tuple of str
        ``PATH`` or ``PATH=LOW:HIGH[:linear]``, each a number of the scene.
    tie : tuple of str
        ``PATH=OTHER``: the first keeps its ratio to the second, which is varied.
    per_curve : tuple of str
        Like ``vary``, with a value of its own for each curve.
    free : tuple of str
        Of ``contact_point``, ``baseline``, ``drift``, ``time_offset``, one for each curve.
    prony : tuple of float
        Relaxation times of a fixed grid: their moduli are varied, in place of the scene's branches.
    regularisation : float
        Weight of the bending of the Prony weights.
    starts, seed : int
        Starts of the search, and the seed of those that are drawn.
    profile : tuple of str
        Parameters whose profile likelihood is worked out, or ``all``.
    solver : str
    resolution : int or None
        ``None``: of the reference the coarsest steps whose error is a twentieth of the noise; of others their
        own choice.
    check_solver : str or None
        The second solver; ``None``: none.
    """

    vary: tuple[str, ...] = ()
    tie: tuple[str, ...] = ()
    per_curve: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    prony: tuple[float, ...] = ()
    regularisation: float = REGULARISATION
    starts: int = 3
    seed: int = 0
    profile: tuple[str, ...] = ()
    solver: str = REFERENCE
    resolution: int | None = None
    check_solver: str | None = "bem"

    def __post_init__(self) -> None:
        for name in ("vary", "tie", "per_curve", "free", "profile"):
            given = getattr(self, name)
            if isinstance(given, str) or not all(isinstance(one, str) for one in given):
                raise SceneError(name, f"got {shown(given)}", "several names")
            object.__setattr__(self, name, tuple(given))
        for name in self.free:
            if name not in INSTRUMENT:
                raise SceneError("free", f"got {shown(name)}", ", ".join(INSTRUMENT))
        times = tuple(positive(value, "prony") for value in self.prony)
        object.__setattr__(self, "prony", times)
        if list(times) != sorted(set(times)):
            raise SceneError("prony", f"got {shown(times)}", "rising relaxation times")
        not_negative(self.regularisation, "regularisation")
        whole_number(self.starts, "starts", 1)
        whole_number(self.seed, "seed", 0)


@dataclass(frozen=True)
class FittedCurve:
    """One curve beside what the fit makes of it.

    Parameters
    ----------
    curve : MeasuredCurve
    force : ndarray, shape (N,)
        Fitted, baseline and drift included.
    residuals : ndarray, shape (N,)
        Measured minus fitted over the noise.
    compared : ndarray of bool, shape (N,)
        Rows that took part.
    penetration : ndarray, shape (N,)
        Measured, from the fitted contact point.
    noise : float
    noise_source : str
    failure : str
        Why the run of the best point did not reach its end.
    """

    curve: MeasuredCurve
    force: Array
    residuals: Array
    compared: NDArray[np.bool_]
    penetration: Array
    noise: float
    noise_source: str
    failure: str = ""


@dataclass(frozen=True)
class FitResult:
    """What a fit found, with its errors.

    Parameters
    ----------
    scene : Scene
        The scene with the fitted numbers that all curves share.
    settings : FitSettings
    curves : tuple of FittedCurve
    estimates : tuple of Estimate
    correlations : ndarray, shape (P, P)
    combinations : tuple of Combination
    confused : list of (str, str, float)
    goodness : Goodness
    profiles : tuple of LikelihoodProfile
    check : SecondSolver or None
    resolution : int or None
    tolerance : float or None
        Of the time steps.
    error_share : float or None
        Error of the runs over the noise, root mean square.
    ended : str
    converged : bool
    starts : tuple of float
        Sum of squares after the first iterations of each start.
    warnings : tuple of str
    runs : int
    seconds : float
    """

    scene: Scene
    settings: FitSettings
    curves: tuple[FittedCurve, ...]
    estimates: tuple[Estimate, ...]
    correlations: Array
    combinations: tuple[Combination, ...]
    confused: list[tuple[str, str, float]]
    goodness: Goodness
    profiles: tuple[LikelihoodProfile, ...]
    check: SecondSolver | None
    resolution: int | None
    tolerance: float | None
    error_share: float | None
    ended: str
    converged: bool
    starts: tuple[float, ...]
    warnings: tuple[str, ...]
    runs: int
    seconds: float


class InterruptedFit(KeyboardInterrupt):
    """Ctrl-C during a fit; ``result`` holds the best so far, or ``None`` before the first point."""

    def __init__(self, result: FitResult | None) -> None:
        super().__init__()
        self.result = result


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
    scene, settings = _with_grid(scene, settings)
    models = [CurveModel.of(curve, scene) for curve in curves]
    parameters = ParameterSet(tuple(_parameters(models, scene, settings)))
    warnings = [text for model in models for text in data_checks.check(model, parameters)]
    penalty = _bending(settings) if len(settings.prony) > 2 and settings.regularisation > 0.0 else None
    problem = FitProblem(
        models, parameters, settings.solver, settings.resolution, executor=executor, store=store or Store()
    )
    problem.penalty = penalty
    best = BestSoFar(problem, progress)
    error_share: float | None = None
    finished: Search | None = None
    try:
        if settings.resolution is None and settings.solver == REFERENCE:
            problem.tolerance, error_share, problem.step = _fineness(problem)
        finished = search(problem, best, settings.starts, settings.seed, partial(_explained, problem))
        result = _judged(problem, finished, scene, settings, warnings)
        profiles = _profiles(problem, finished.x, result, progress)
        check = None
        if settings.check_solver is not None and settings.check_solver != settings.solver:
            if progress is not None:
                progress(f"the same curves by {settings.check_solver}")
            spread = covariance(finished.jacobian, result.goodness)[0]
            check = second_solver(problem, finished.x, finished.jacobian, spread, settings.check_solver, None)
    except KeyboardInterrupt:
        if best.x is None:
            raise InterruptedFit(None) from None
        raise InterruptedFit(_unfinished(problem, best, finished, scene, settings, warnings)) from None
    return replace(
        result,
        profiles=profiles,
        check=check,
        error_share=error_share,
        runs=problem.runs,
        seconds=time.perf_counter() - began,
    )


def _explained(problem: FitProblem, residuals: Array) -> bool:
    """Whether residuals are those of a model that explains the data: none of less misfit is sought then."""
    return _goodness(problem, residuals).explained


def _goodness(problem: FitProblem, residuals: Array) -> Goodness:
    of_force = [
        (problem.models[block.curve].curve.name, residuals[block.rows])
        for block in problem.blocks()
        if block.kind == "force"
    ]
    noise_degrees = sum(model.features.noise_degrees for model in problem.models)
    return goodness(residuals, len(problem.parameters), of_force, noise_degrees)


def _judged(
    problem: FitProblem, found: Search, scene: Scene, settings: FitSettings, warnings: Sequence[str]
) -> FitResult:
    """Errors and goodness of what a search found.

    Parameters
    ----------
    problem : FitProblem
    found : Search
    scene : Scene
    settings : FitSettings
    warnings : sequence of str

    Returns
    -------
    FitResult
    """
    parameters = problem.parameters.parameters
    judged = _goodness(problem, found.residuals)
    spread, deviations, directions = covariance(found.jacobian, judged)
    correlations = correlation(spread)
    names = [one.name for one in parameters]
    logarithmic = np.array([one.logarithmic for one in parameters])
    return FitResult(
        scene=with_values(scene, _shared(problem, found.x)),
        settings=settings,
        curves=tuple(_fitted(problem, index, found.x) for index in range(len(problem.models))),
        estimates=estimates(parameters, found.x, spread, bound_notes(parameters, found.x, spread)),
        correlations=correlations,
        combinations=_of_logarithms(spread, names, logarithmic)
        if np.isfinite(spread).all()
        else combinations(names, deviations, directions),
        confused=confused(names, correlations),
        goodness=judged,
        profiles=(),
        check=None,
        resolution=problem.resolution,
        tolerance=problem.tolerance,
        error_share=None,
        ended=found.ended,
        converged=found.converged,
        starts=found.starts,
        warnings=(*warnings, *_failures(problem, found.x)),
        runs=problem.runs,
        seconds=0.0,
    )


def _of_logarithms(
    spread: Array, names: Sequence[str], logarithmic: NDArray[np.bool_]
) -> tuple[Combination, ...]:
    """Products of powers of the positive parameters, all others being free."""
    own = np.flatnonzero(logarithmic).tolist()
    variances, vectors = np.linalg.eigh(spread[np.ix_(own, own)])
    order = np.argsort(variances)[::-1]
    deviations = np.sqrt(np.maximum(variances[order], 0.0))
    return combinations([names[index] for index in own], deviations, vectors.T[order])


def _shared(problem: FitProblem, x: Array) -> Mapping[str, float]:
    """Numbers of the scene that all curves share."""
    values: dict[str, float] = {}
    for one, at in zip(problem.parameters.parameters, x, strict=True):
        if one.curve is None:
            values |= {path: ratio * one.value(float(at)) for path, ratio in one.ratios.items()}
    return values


def _fitted(problem: FitProblem, index: int, x: Array) -> FittedCurve:
    point = problem.parameters.of_curve(x, index)
    [prediction] = problem.predictions([(index, point)])
    model = problem.models[index]
    force = problem.predicted_force(index, prediction, point[1])
    return FittedCurve(
        model.curve,
        force,
        (model.curve.force - force) / model.features.noise,
        problem.compared[index],
        model.curve.motion - point[1][CONTACT_POINT],
        model.features.noise,
        model.features.noise_source,
        prediction.failure,
    )


def _failures(problem: FitProblem, x: Array) -> list[str]:
    points = [problem.parameters.of_curve(x, index) for index in range(len(problem.models))]
    found = problem.predictions(list(enumerate(points)))
    return [
        f"{model.curve.name}: the run of the best point did not reach its end: {one.failure}"
        for model, one in zip(problem.models, found, strict=True)
        if one.failure
    ]


def _unfinished(
    problem: FitProblem,
    best: BestSoFar,
    finished: Search | None,
    scene: Scene,
    settings: FitSettings,
    warnings: Sequence[str],
) -> FitResult | None:
    """The best point of an interrupted fit, with the errors that its derivatives give.

    Parameters
    ----------
    problem : FitProblem
    best : BestSoFar
    finished : Search or None
        If only profiles or the second solver were left.
    scene : Scene
    settings : FitSettings
    warnings : sequence of str

    Returns
    -------
    FitResult or None
        ``None`` if a second interruption came while they were worked out.
    """
    try:
        if finished is None and best.x is not None:
            residuals, jacobian = problem.residuals(best.x), problem.jacobian(best.x)
            finished = Search(best.x, residuals, jacobian, "interrupted", False, ())
        return None if finished is None else _judged(problem, finished, scene, settings, warnings)
    except KeyboardInterrupt:
        return None


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
    unknown = [name for name in asked if name not in (*names, "all")]
    if unknown:
        raise SceneError("profile", f"{unknown[0]} is not varied", f"all, {', '.join(names)}")
    scale = result.goodness.variance
    made = []
    for name in wanted:
        place = names.index(name)
        one, estimate = problem.parameters.parameters[place], result.estimates[place]
        deviation = estimate.deviation if one.logarithmic else estimate.deviation / one.scale
        made.append(likelihood_profile(problem, place, x, deviation, scale, progress))
    return tuple(made)


def _fineness(problem: FitProblem) -> tuple[float, float, float]:
    """Tolerance of time steps with an error small beside the noise, that error, the step of differences."""
    x = problem.parameters.start
    forces = [block.rows for block in problem.blocks() if block.kind == "force"]
    data = np.concatenate([model.curve.force / model.features.noise for model in problem.models])
    size = float(np.sqrt(np.mean(data**2)))
    share, coarse = np.inf, None
    for tolerance, finer in pairwise(TOLERANCES):
        found = []
        for one in (tolerance, finer):
            problem.tolerance = one
            found.append(problem.residuals(x) if one == finer or coarse is None else coarse)
        coarse = found[1]
        change = np.concatenate([(found[1] - found[0])[rows] for rows in forces])
        share = ORDER_TWO * float(np.sqrt(np.mean(change**2)))
        if share <= ERROR_SHARE:
            break
    step = float(np.clip(np.sqrt(share / size), SMALLEST_STEP, LARGEST_STEP))
    return tolerance, share, step


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


def _with_grid(scene: Scene, settings: FitSettings) -> tuple[Scene, FitSettings]:
    """The scene with a Prony series on the fixed grid, and its moduli among the parameters."""
    if not settings.prony:
        return scene, settings
    count = len(settings.prony)
    relaxing = scene.material.glassy_modulus - scene.material.modulus or scene.material.modulus
    branches = tuple(Branch(relaxing / count, time) for time in settings.prony)
    grid = tuple(f"material.branches[{index}].modulus" for index in range(count))
    scene = replace(scene, material=replace(scene.material, branches=branches))
    return scene, replace(settings, vary=(*settings.vary, *grid))


def _bending(settings: FitSettings) -> Callable[[Mapping[str, float]], Array]:
    """Second differences of the logarithms of the Prony weights, weighted."""
    names = [f"material.branches[{index}].modulus" for index in range(len(settings.prony))]
    weight = np.sqrt(settings.regularisation)
    return lambda values: weight * np.diff(np.log([values[name] for name in names]), 2)


def _parameters(models: Sequence[CurveModel], scene: Scene, settings: FitSettings) -> list[FitParameter]:
    tied: dict[str, list[str]] = {}
    for entry in settings.tie:
        path, _, other = entry.partition("=")
        if not path or not other:
            raise SceneError("tie", f"got {shown(entry)}", "PATH=OTHER, both numbers of the scene")
        tied.setdefault(other, []).append(path)
    varied = [entry.partition("=")[0] for entry in (*settings.vary, *settings.per_curve)]
    for other in tied:
        if other not in varied:
            raise SceneError("tie", f"{other} is not varied", "ties to a number that is")
    found = [scene_parameter(scene, entry, tied.get(entry.partition("=")[0], ())) for entry in settings.vary]
    for index, model in enumerate(models):
        for entry in settings.per_curve:
            ties = tied.get(entry.partition("=")[0], ())
            found.append(scene_parameter(model.scene, entry, ties, (index, model.curve.name)))
        found += [_instrument(model, index, name) for name in dict.fromkeys(settings.free)]
    return found


def _instrument(model: CurveModel, index: int, kind: str) -> FitParameter:
    """A parameter of the instrument, with its first guess from the record."""
    curve, seen = model.curve, model.features
    name = f"{kind}@{curve.name}"
    duration = float(curve.time[-1] - curve.time[0])
    if kind == BASELINE:
        reach = float(np.ptp(curve.force))
        return FitParameter(
            name, seen.baseline, seen.baseline - reach, seen.baseline + reach, False, seen.noise, curve=index
        )
    if kind == DRIFT:
        reach = float(np.ptp(curve.force)) / duration
        return FitParameter(
            name,
            seen.drift,
            seen.drift - reach,
            seen.drift + reach,
            False,
            seen.noise / duration,
            curve=index,
        )
    if kind == TIME_OFFSET:
        return FitParameter(
            name, 0.0, -TIME_SHARE * duration, TIME_SHARE * duration, False, duration, curve=index
        )
    reach = float(np.ptp(curve.motion))
    touch = 0.0
    if 0 < seen.first < seen.last and model.scene.loading.start == "jump-in":
        touch = float(curve.motion[seen.first - 1 : seen.first + 1].mean()) - model.scene.loading.penetration
    return FitParameter(name, touch, touch - reach, touch + reach, False, reach, curve=index)
