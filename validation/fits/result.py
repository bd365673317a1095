"""From where a search ended to what a fit states: values, errors, goodness, the fitted curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from contact_scene import Scene
from contact_scene.scene import with_values
from validation.fits.errors import (
    UNLIKELY,
    Combination,
    Estimate,
    Goodness,
    combinations,
    confused,
    correlation,
    correlation_length,
    covariance,
    estimate,
    misfitting_stretch,
    runs_test,
)
from validation.fits.parameters import CONTACT_POINT, FitSettings, Unknown
from validation.fits.problem import FitProblem, Point
from validation.fits.record import Array, MeasuredCurve


@dataclass(frozen=True)
class FittedCurve:
    """One curve beside what the fit makes of it: the fitted force with its background, residuals (measured
    minus fitted, over the noise), the rows that took part, positions from the fitted contact point, over how
    many rows residuals are correlated, and the stretch that the model misses most."""

    curve: MeasuredCurve
    force: Array
    residuals: Array
    compared: NDArray[np.bool_]
    position: Array
    noise: float
    noise_source: str
    correlated: float
    stretch: slice
    failure: str = ""

    @property
    def misfit(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(np.mean(self.residuals[self.compared] ** 2)))

    @property
    def share(self) -> float:
        """The same over the range of the force."""
        return self.misfit * self.noise / float(np.ptp(self.curve.force))


@dataclass(frozen=True)
class LikelihoodProfile:
    """Increase of the least sum of squares, over the variance of a residual, as a parameter takes some
    values; ``low`` and ``high`` end its 95 % interval, ``None`` where it does not grow enough."""

    name: str
    values: Array
    increases: Array
    low: float | None
    high: float | None


@dataclass(frozen=True)
class SolverDifference:
    """Force of one curve by two solvers: their difference at the compared rows over the noise (root mean
    square, largest) and over the force, or why the second gave no curve."""

    curve: str
    root_mean_square: float
    largest: float
    relative: float
    failure: str = ""


@dataclass(frozen=True)
class SecondSolver:
    """What a second solver says of a fit, and by how many of its deviations it would move each parameter, to
    first order; no ``shifts`` if a run failed."""

    solver: str
    resolution: int | None
    differences: tuple[SolverDifference, ...]
    shifts: dict[str, float]


@dataclass(frozen=True)
class FitResult:
    """What a fit found, with its errors, as ``fit.json`` has them; ``scene`` has the fitted numbers
    that all curves share."""

    scene: Scene
    settings: FitSettings
    curves: tuple[FittedCurve, ...]
    estimates: tuple[Estimate, ...]
    correlations: Array
    combinations: tuple[Combination, ...]
    confused: list[tuple[str, str, float]]
    goodness: Goodness
    warnings: tuple[str, ...]
    ended: str
    converged: bool
    starts: tuple[float, ...]
    tolerance: float | None
    runs: int
    profiles: tuple[LikelihoodProfile, ...] = ()
    check: SecondSolver | None = None
    error_share: float | None = None
    seconds: float = 0.0
    question: dict[str, str] | None = None


class InterruptedFit(KeyboardInterrupt):
    """Ctrl-C during a fit; ``result`` holds the best so far, or ``None`` before the first point."""

    def __init__(self, result: FitResult | None) -> None:
        super().__init__()
        self.result = result


def goodness(problem: FitProblem, point: Point) -> Goodness:
    """Whether a point explains the data."""
    of_force = [point.residuals[rows][point.compared[rows]] for rows in problem.force_rows]
    over_noise = point.residuals.copy()
    runs, shares = [], []
    for model, rows, own in zip(problem.models, problem.force_rows, of_force, strict=True):
        over_noise[rows] *= model.allowed / model.moments.noise
        runs.append(runs_test(model.curve.name, own))
        shares.append(np.sqrt(np.mean(own**2)) * model.allowed / np.ptp(model.curve.force))
    noise_degrees = float(sum(model.moments.noise_degrees for model in problem.models))
    free = len(problem.unknowns) + point.background.size
    degrees = max(int(point.compared.sum()) - free, 1)
    total, within = float(over_noise @ over_noise), problem.settings.within
    own_variance = float(point.residuals @ point.residuals) / degrees
    if np.isfinite(noise_degrees):
        chance = float(stats.f.sf(total / degrees, degrees, noise_degrees))
        pooled = (total + noise_degrees) / (degrees + noise_degrees)
    else:
        chance, pooled = float(stats.chi2.sf(total, degrees)), 1.0
    variance = max(own_variance, 1.0) if chance < UNLIKELY else pooled
    return Goodness(
        total,
        degrees,
        noise_degrees,
        chance,
        tuple(runs),
        float(max(shares)),
        within,
        own_variance if within else variance,
    )


def independent(problem: FitProblem, point: Point, rows_of: Array) -> Array:
    """Rows of a Jacobian, or residuals, over the root of the length over which those of a curve correlate."""
    found = rows_of.copy()
    for rows in problem.force_rows:
        found[rows] /= np.sqrt(correlation_length(point.residuals[rows]))
    return found


def judged(
    problem: FitProblem,
    x: Array,
    scene: Scene,
    warnings: Sequence[str],
    ended: str,
    converged: bool,
    starts: Sequence[float],
) -> FitResult:
    """Errors and goodness of the point at which a search ended."""
    point, slopes = problem.at(x), problem.derivatives(x)
    good = goodness(problem, point)
    unknowns = [*problem.unknowns.found, *_background(problem)]
    scale = np.array([one.scale for one in unknowns[len(x) :]])
    whole = independent(problem, point, np.column_stack([slopes, point.columns * scale]))
    spread, deviations, directions = covariance(whole, good.variance)
    found = [*x.tolist(), *(point.background / scale).tolist()]
    names = [one.name for one in unknowns]
    correlations = correlation(spread)
    if np.isfinite(spread).all():  # products of the positive parameters, all others being free
        own = [at for at, one in enumerate(unknowns) if one.logarithmic]
        variances, vectors = np.linalg.eigh(spread[np.ix_(own, own)])
        names_of, deviations = [names[at] for at in own], np.sqrt(np.maximum(variances, 0.0))[::-1]
        products = combinations(names_of, deviations, vectors.T[::-1])
    else:
        products = combinations(names, deviations, directions)
    failures = [
        f"{model.curve.name}: the run of the best point did not reach its end: {one.failure}"
        for model, one in zip(problem.models, point.predictions, strict=True)
        if one.failure
    ]
    return FitResult(
        scene=with_values(scene, problem.unknowns.values(x)),
        settings=problem.settings,
        curves=tuple(_fitted(problem, index, x, point) for index in range(len(problem.models))),
        estimates=tuple(map(estimate, unknowns, found, np.diag(spread).tolist())),
        correlations=correlations,
        combinations=products,
        confused=confused(names, correlations),
        goodness=good,
        warnings=(*warnings, *failures),
        ended=ended,
        converged=converged,
        starts=tuple(starts),
        tolerance=problem.tolerance,
        runs=problem.runs,
    )


def _background(problem: FitProblem) -> list[Unknown]:
    """The parts of the background, which start from nothing and have no bounds."""
    made = []
    for at, (curve, part) in enumerate(problem.parts):
        model = problem.models[curve]
        scale = 1.0 / float(np.abs(problem.columns[:, at]).max())
        name = f"{part}@{model.curve.name}"
        made.append(Unknown(name, 0.0, -np.inf, np.inf, False, scale, curve))
    return made


def _fitted(problem: FitProblem, index: int, x: Array, point: Point) -> FittedCurve:
    model = problem.models[index]
    curve, seen = model.curve, model.moments
    force = problem.fitted_force(index, point)
    kept = problem.compared[index].copy()
    kept[kept] = point.compared[problem.force_rows[index]]
    left = curve.force - force
    return FittedCurve(
        curve,
        force,
        left / seen.noise,
        kept,
        curve.position - problem.unknowns.values(x, index).get(CONTACT_POINT, 0.0),
        seen.noise,
        seen.noise_source,
        correlation_length(left[kept]),
        misfitting_stretch(np.where(kept, left / model.allowed, 0.0)),
        point.predictions[index].failure,
    )
