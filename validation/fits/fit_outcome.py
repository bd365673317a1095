"""From where a search ended to what a fit states: values, errors, goodness, the fitted curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from contact_scene.scene import with_values
from validation.fits.fit_result import FitResult, FittedCurve
from validation.fits.fit_settings import FitSettings
from validation.fits.goodness import Goodness, goodness
from validation.fits.parameters import CONTACT_POINT
from validation.fits.problem import FitProblem
from validation.fits.record import Array
from validation.fits.search import BestSoFar, Search
from validation.fits.statistics import (
    Combination,
    bound_notes,
    combinations,
    confused,
    correlation,
    covariance,
    estimates,
)


def explained(problem: FitProblem, residuals: Array) -> bool:
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


def judged(
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
    good = _goodness(problem, found.residuals)
    spread, deviations, directions = covariance(found.jacobian, good)
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
        goodness=good,
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
        question={},
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
        model.curve.position - point[1][CONTACT_POINT],
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


def unfinished(
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
        return None if finished is None else judged(problem, finished, scene, settings, warnings)
    except KeyboardInterrupt:
        return None
