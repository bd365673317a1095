"""From where a search ended to what a fit states: values, how well they are known, what explains the data.

Residuals are in units of the noise. If the model is right their sum of squares is chi-squared, their signs
follow each other at random, and the covariance is ``s^2 (J^T J)^-1``, with the variance ``s^2`` of baseline
and residuals together. Where residuals are too large to be noise ``s^2`` is theirs alone (Birge, Phys. Rev.
40, 207, 1932); where they are correlated, n rows count as n/L independent ones. Both make intervals honest
about size and not about bias. Numbers bear the names that they have in ``fit.json``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from contact_scene.scene import with_values
from validation.fits.contact import Array
from validation.fits.problem import CONTACT_POINT, FitProblem, FitSettings, Point, Unknown, least_squares
from validation.fits.record import MeasuredCurve

QUANTILE, CHI_SQUARED = 1.959963984540054, 3.841458820694124
"""Ends of the 95 % interval of a standard normal number, and its square: chi-squared of one degree."""
UNLIKELY = 1e-3
"""Probability below which a misfit, or the order of its signs, is not taken for chance."""
VAGUE = 0.5
"""Standard deviation of a logarithm from which a parameter, or a product of powers, counts as unknown: its
95 % interval spans a factor of seven."""
ALIKE, TAKES_PART = 0.97, 0.2
"""Correlation from which two parameters are hardly told apart, each alone known four times worse than with
the other given; and power of a parameter in a normalised product from which it is named."""
AT_BOUND, NEGLIGIBLE = 1e-3, 1e-12
"""Distance from a bound, in numbers of the search, below which a parameter is held by it; and eigenvalue over
the largest below which a direction is not determined at all: round-off of derivatives."""


@dataclass(frozen=True)
class Estimate:
    """A parameter with its error: the standard ``deviation`` is that of the logarithm, a share of ``value``,
    where ``logarithmic``, else in its unit; ``low`` and ``high`` are the ends of its 95 % interval, ``start``
    is the first guess, and ``note`` says what is wrong with it, if anything."""

    name: str
    value: float
    deviation: float
    logarithmic: bool
    low: float
    high: float
    start: float
    note: str = ""

    @classmethod
    def of(cls, one: Unknown, at: float, variance: float) -> Estimate:
        """A number of the search with its variance."""
        deviation, low, high = math.sqrt(variance), one.plain(one.low), one.plain(one.high)
        note = ""
        if min(at - low, high - at) < AT_BOUND:
            note = "held by its bound"
        elif not deviation < (VAGUE if one.logarithmic else math.inf):
            note = "not determined by these data"
        reach = QUANTILE * deviation
        ends = one.value(max(at - reach, low)), one.value(min(at + reach, high))
        size = deviation if one.logarithmic else deviation * one.scale
        return cls(one.name, one.value(at), size, one.logarithmic, *ends, one.start, note)


@dataclass(frozen=True)
class Combination:
    """A product of powers of parameters, the largest power 1, and the deviation of its logarithm."""

    powers: dict[str, float]
    deviation: float

    @property
    def text(self) -> str:
        """In words."""
        parts = (name if power == 1.0 else f"({name})^{power:.2g}" for name, power in self.powers.items())
        return " · ".join(parts)


@dataclass(frozen=True)
class RunsTest:
    """Wald and Wolfowitz' test of the signs of one curve's residuals (Ann. Math. Stat. 11, 147, 1940): runs
    of one sign, their number by chance, and the probability of so few, which miss the shape of the curve."""

    curve: str
    runs: int
    expected: float
    probability: float

    @classmethod
    def of(cls, curve: str, residuals: Array) -> RunsTest:
        """Count stretches of one sign."""
        signs = residuals[residuals != 0.0] > 0.0
        both, above = signs.size, int(signs.sum())
        runs = 1 + int((signs[1:] != signs[:-1]).sum()) if both else 0
        if above in (0, both):
            return cls(curve, runs, float(runs), 1.0 if both < 10 else 0.0)
        expected = 1.0 + 2.0 * above * (both - above) / both
        variance = (expected - 1.0) * (expected - 2.0) / max(both - 1.0, 1.0)
        z = (runs + 0.5 - expected) / math.sqrt(variance) if variance > 0.0 else 0.0
        return cls(curve, runs, expected, 0.5 * math.erfc(-z / math.sqrt(2.0)))


@dataclass(frozen=True)
class Goodness:
    """Whether what is left looks like noise: ``probability``: of a sum of squares as large by chance;
    ``rms_over_range``: of a curve, the largest, over the range of its force; ``within``: the share of it that
    was allowed; ``variance``: of a residual as it is weighted."""

    sum_of_squares: float
    degrees: int
    noise_degrees: float
    probability: float
    runs_tests: tuple[RunsTest, ...]
    misfit_over_noise: float
    rms_over_range: float
    within: float | None
    variance: float

    @property
    def explained(self) -> bool:
        """Whether the model explains the data within the share that was asked for, or else their noise."""
        if self.within is not None:
            return self.rms_over_range <= self.within
        below = self.probability > 1.0 - UNLIKELY  # less than noise can be: then signs tell nothing
        at_random = all(one.probability >= UNLIKELY for one in self.runs_tests)
        return self.probability >= UNLIKELY and (below or at_random)


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
    rows_correlated: float
    stretch: slice
    failure: str = ""

    @property
    def misfit_over_noise(self) -> float:
        """Root mean square of the residuals."""
        return rms(self.residuals[self.compared])

    @property
    def rms_over_range(self) -> float:
        """The same over the range of the force."""
        return self.misfit_over_noise * self.noise / float(np.ptp(self.curve.force))

    @property
    def worst_stretch(self) -> tuple[float, float] | None:
        """First and last time of the stretch, if any is missed."""
        times = self.curve.time[self.stretch]
        return (float(times[0]), float(times[-1])) if times.size else None


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
class SecondSolver:
    """What a second solver says of a fit: for each curve the difference of its force at the compared rows
    over the noise (root mean square, largest) and over the force, or its ``failure``; and by how many of its
    deviations it would move each parameter, to first order; no ``shifts`` if a run failed."""

    solver: str
    differences: tuple[dict[str, Any], ...]
    shifts: dict[str, float]


@dataclass(frozen=True)
class Posterior:
    """What walkers found: ``median``, ``low`` and ``high`` of the 95 % interval of each parameter; how many
    ``steps`` they made, ``discarded`` at first, of how long an ``autocorrelation``, by which ``solver``; and
    all ``samples`` behind, shape (N, P)."""

    solver: str
    walkers: int
    steps: int
    discarded: int
    autocorrelation: float
    acceptance: float
    intervals: dict[str, dict[str, float]]
    samples: Array


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
    posterior: Posterior | None = None
    error_share: float | None = None
    seconds: float = 0.0
    question: dict[str, str] | None = None


class InterruptedFit(KeyboardInterrupt):
    """Ctrl-C during a fit; ``result`` holds the best so far, or ``None`` before the first point."""

    def __init__(self, result: FitResult | None) -> None:
        super().__init__()
        self.result = result


def judged(problem: FitProblem, x: Array, scene: Scene, warnings: Sequence[str], **how: Any) -> FitResult:
    """Errors and goodness of the point at which a search ended; ``how`` it was carried out."""
    point, good = problem.at(x), goodness(problem, problem.at(x))
    free = [  # parts of the background, which start from nothing and have no bounds
        Unknown(f"{part}@{problem.models[at].curve.name}", 0.0, -np.inf, np.inf, False, scale, at)
        for (at, part), scale in zip(
            problem.parts, (1.0 / np.abs(problem.columns).max(axis=0, initial=0.0)).tolist(), strict=True
        )
    ]
    unknowns, scale = [*problem.unknowns, *free], np.array([one.scale for one in free])
    whole = independent(problem, point, np.column_stack([problem.derivatives(x), point.columns * scale]))
    spread = covariance(whole, good.variance)[0]
    found, names = [*x.tolist(), *(point.background / scale).tolist()], [one.name for one in unknowns]
    positive = np.array([one.logarithmic for one in unknowns])
    curves = tuple(_fitted(problem, index, x, point) for index in range(len(problem.models)))
    told = "the run of the best point did not reach its end"
    return FitResult(
        scene=with_values(scene, problem.values(x)),
        settings=problem.settings,
        curves=curves,
        estimates=tuple(map(Estimate.of, unknowns, found, np.diag(spread).tolist())),
        correlations=(together := correlation(spread)),
        combinations=combinations(names, whole, positive, good.variance),
        confused=confused(names, together),
        goodness=good,
        warnings=(*warnings, *(f"{one.curve.name}: {told}: {one.failure}" for one in curves if one.failure)),
        tolerance=problem.tolerance,
        **how,
    )


def goodness(problem: FitProblem, point: Point) -> Goodness:
    """Whether a point explains the data."""
    from scipy import special  # takes longer to load than all else that a curve needs

    over_noise = point.residuals.copy()
    tests, shares, known = [], [], 0.0
    for model, rows in zip(problem.models, problem.force_rows, strict=True):
        own = point.residuals[rows][point.hold[rows]]
        over_noise[rows] *= model.allowed / model.moments.noise
        tests.append(RunsTest.of(model.curve.name, own))
        shares.append(rms(own) * model.allowed / float(np.ptp(model.curve.force)))
        known += model.moments.noise_degrees
    degrees = max(int(point.hold.sum()) - len(problem.unknowns) - point.background.size, 1)
    total, within = float(over_noise @ over_noise), problem.settings.within
    if np.isfinite(known):
        chance = float(special.fdtrc(degrees, known, total / degrees))
        pooled = (total + known) / (degrees + known)
    else:
        chance, pooled = float(special.chdtrc(degrees, total)), 1.0
    own_variance = float(point.residuals @ point.residuals) / degrees
    variance = max(own_variance, 1.0) if chance < UNLIKELY else pooled
    misfit, variance = math.sqrt(total / degrees), own_variance if within else variance
    return Goodness(total, degrees, known, chance, tuple(tests), misfit, max(shares), within, variance)


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def independent(problem: FitProblem, point: Point, rows_of: Array) -> Array:
    """Rows of a Jacobian, or residuals, over the root of the length over which those of a curve correlate."""
    found = rows_of.copy()
    for rows in problem.force_rows:
        found[rows] /= np.sqrt(correlation_length(point.residuals[rows][point.hold[rows]]))
    return found


def _fitted(problem: FitProblem, index: int, x: Array, point: Point) -> FittedCurve:
    """A curve beside the fitted force."""
    model, rows, predicted = problem.models[index], problem.force_rows[index], point.predictions[index]
    curve, kept = model.curve, point.hold[rows]
    force = predicted.force + model.allowed * (problem.columns[rows] @ point.background)
    left = curve.force - force
    return FittedCurve(
        curve,
        force,
        left / model.moments.noise,
        kept,
        curve.position - problem.values(x, index).get(CONTACT_POINT, 0.0),
        model.moments.noise,
        model.moments.noise_source,
        correlation_length(left[kept]),
        misfitting_stretch(np.where(kept, left / model.allowed, 0.0)),
        predicted.failure,
    )


def correlation_length(residuals: Array) -> float:
    """Rows that tell as much as one: twice the sum of the autocorrelation, up to what white noise has."""
    rows = residuals.size
    product = np.fft.irfft(np.abs(np.fft.rfft(residuals, 2 * rows)) ** 2)[:rows]
    if rows < 2 or product[0] <= 0.0:
        return 1.0
    correlations = product[1:] / product[0]
    below = correlations < 2.0 / np.sqrt(rows)
    last = int(np.argmax(below)) if below.any() else rows - 1
    return float(1.0 + 2.0 * correlations[:last].sum())


def misfitting_stretch(residuals: Array) -> slice:
    """The rows whose squares exceed twice the variance of residuals by most in all (Bentley, Commun. ACM 27,
    865, 1984); none if no row does."""
    total = np.concatenate([[0.0], np.cumsum(residuals**2 - 2.0)])
    end = int(np.argmax(total - np.minimum.accumulate(total)))
    return slice(int(np.argmin(total[: end + 1])), end)


def covariance(jacobian: Array, variance: float) -> tuple[Array, Array, Array]:
    """Covariance of the numbers of the search, infinite where the data do not see them; deviations along its
    directions, falling; and the directions, rows of unit length."""
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
    seen = singular**2 > NEGLIGIBLE * singular.max(initial=0.0) ** 2
    deviations = np.where(seen, np.sqrt(variance) / np.where(seen, singular, 1.0), np.inf)
    result = (directions.T * np.where(seen, deviations, 0.0) ** 2) @ directions
    blind = (np.abs(directions[~seen]) > np.sqrt(NEGLIGIBLE)).any(axis=0)
    result[blind, blind] = np.inf
    return result, deviations[::-1], directions[::-1]


def correlation(spread: Array) -> Array:
    """Correlations of the parameters, shape (P, P); 0 where a variance is infinite."""
    variance = np.diag(spread)
    scale = 1.0 / np.sqrt(np.where(variance > 0.0, variance, np.inf))
    result = np.where(np.isfinite(spread), spread, 0.0) * np.outer(scale, scale)
    np.fill_diagonal(result, 1.0)
    return result


def combinations(
    names: Sequence[str], jacobian: Array, positive: NDArray[np.bool_], variance: float
) -> tuple[Combination, ...]:
    """Products of powers of the positive parameters with independent errors, the least known first, all other
    parameters following: the directions of what their derivatives do not share with those."""
    own, others = jacobian[:, positive], jacobian[:, ~positive]
    _, deviations, directions = covariance(own - others @ least_squares(others, own), variance)
    named, made = [name for name, one in zip(names, positive, strict=True) if one], []
    for deviation, direction in zip(deviations, directions, strict=True):
        largest = direction[np.argmax(np.abs(direction))]
        shares = zip(named, (direction / largest).tolist(), strict=True)
        powers = {name: power for name, power in shares if abs(power) >= TAKES_PART}
        made.append(Combination(powers, float(deviation / abs(largest))))
    return tuple(made)


def confused(names: Sequence[str], correlations: Array) -> list[tuple[str, str, float]]:
    """Pairs of parameters that the data hardly tell apart, with their correlation."""
    pairs = np.argwhere(np.tril(np.abs(correlations) >= ALIKE, -1)).tolist()
    return [(names[i], names[j], float(correlations[i, j])) for i, j in pairs]
