"""From where a search ended to what a fit states: values, errors, goodness, the fitted curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from contact_scene import Scene
from contact_scene.scene import with_values
from validation.fits.contact import Array
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
from validation.fits.record import MeasuredCurve


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

    @property
    def missed(self) -> tuple[float, float] | None:
        """First and last time of the stretch, if any is missed."""
        begin, end = self.stretch.start, self.stretch.stop - 1
        return (float(self.curve.time[begin]), float(self.curve.time[end])) if end >= begin else None


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
    tolerance: float | None
    ended: str = "interrupted"
    converged: bool = False
    starts: tuple[float, ...] = ()
    runs: int = 0
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
    over_noise = point.residuals.copy()
    runs, shares, known = [], [], 0.0
    for model, rows in zip(problem.models, problem.force_rows, strict=True):
        own = point.residuals[rows][point.compared[rows]]
        over_noise[rows] *= model.allowed / model.moments.noise
        runs.append(runs_test(model.curve.name, own))
        shares.append(float(np.sqrt(np.mean(own**2)) * model.allowed / np.ptp(model.curve.force)))
        known += model.moments.noise_degrees
    free = len(problem.unknowns) + point.background.size
    degrees = max(int(point.compared.sum()) - free, 1)
    total, within = float(over_noise @ over_noise), problem.settings.within
    own_variance = float(point.residuals @ point.residuals) / degrees
    if np.isfinite(known):
        chance = float(special.fdtrc(degrees, known, total / degrees))
        pooled = (total + known) / (degrees + known)
    else:
        chance, pooled = float(special.chdtrc(degrees, total)), 1.0
    variance = max(own_variance, 1.0) if chance < UNLIKELY else pooled
    variance = own_variance if within else variance
    return Goodness(total, degrees, float(known), chance, tuple(runs), max(shares), within, variance)


def independent(problem: FitProblem, point: Point, rows_of: Array) -> Array:
    """Rows of a Jacobian, or residuals, over the root of the length over which those of a curve correlate."""
    found = rows_of.copy()
    for rows in problem.force_rows:
        found[rows] /= np.sqrt(correlation_length(point.residuals[rows]))
    return found


def judged(problem: FitProblem, x: Array, scene: Scene) -> FitResult:
    """Errors and goodness of the point at which a search ended."""
    point, slopes = problem.at(x), problem.derivatives(x)
    good = goodness(problem, point)
    unknowns = [*problem.unknowns.found, *_background(problem)]
    scale = np.array([one.scale for one in unknowns[len(x) :]])
    whole = independent(problem, point, np.column_stack([slopes, point.columns * scale]))
    spread, deviations, directions = covariance(whole, good.variance)
    found, names = [*x.tolist(), *(point.background / scale).tolist()], [one.name for one in unknowns]
    if np.isfinite(spread).all():  # products of the positive parameters, all others being free
        own = [at for at, one in enumerate(unknowns) if one.logarithmic]
        variances, vectors = np.linalg.eigh(spread[np.ix_(own, own)])
        deviations, directions = np.sqrt(np.maximum(variances, 0.0))[::-1], vectors.T[::-1]
        products = combinations([names[at] for at in own], deviations, directions)
    else:
        products = combinations(names, deviations, directions)
    curves = tuple(_fitted(problem, index, x, point) for index in range(len(problem.models)))
    told = "the run of the best point did not reach its end"
    return FitResult(
        scene=with_values(scene, problem.unknowns.values(x)),
        settings=problem.settings,
        curves=curves,
        estimates=tuple(map(estimate, unknowns, found, np.diag(spread).tolist())),
        correlations=correlation(spread),
        combinations=products,
        confused=confused(names, correlation(spread)),
        goodness=good,
        warnings=tuple(f"{one.curve.name}: {told}: {one.failure}" for one in curves if one.failure),
        tolerance=problem.tolerance,
    )


def _background(problem: FitProblem) -> list[Unknown]:
    """The parts of the background, which start from nothing and have no bounds."""
    scales = 1.0 / np.abs(problem.columns).max(axis=0, initial=0.0)
    return [
        Unknown(f"{part}@{problem.models[at].curve.name}", 0.0, -np.inf, np.inf, False, scale, at)
        for (at, part), scale in zip(problem.parts, scales.tolist(), strict=True)
    ]


def _fitted(problem: FitProblem, index: int, x: Array, point: Point) -> FittedCurve:
    """A curve beside the fitted force."""
    model = problem.models[index]
    curve, seen = model.curve, model.moments
    force, kept = problem.fitted_force(index, point), model.kept.copy()
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
