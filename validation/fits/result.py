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
from validation.fits.contact import Array, least_squares
from validation.fits.model import FittedCurve, Residuals, rms
from validation.fits.parameters import FitSettings, Unknown

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
class Goodness:
    """Whether what is left looks like noise: ``probability``: of a sum of squares as large by chance;
    ``rms_over_range``: of a curve, the largest, over the range of its force; ``within``: the share of it that
    was allowed; ``variance``: of a residual as it is weighted; and the runs test of each curve."""

    sum_of_squares: float
    degrees: int
    noise_degrees: float
    probability: float
    runs_tests: tuple[dict[str, Any], ...]
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
        at_random = all(one["probability"] >= UNLIKELY for one in self.runs_tests)
        return self.probability >= UNLIKELY and (below or at_random)


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
    """What a fit found, with its errors, by the names that ``fit.json`` has; ``scene`` has the fitted numbers
    that all curves share.

    Of each of the ``profiles``: values of a parameter, increases of the least sum of squares there over the
    variance of a residual, ``low`` and ``high``, the ends of its 95 % interval, ``None`` where it grows too
    little. Of the ``second_solver``: for each curve the difference of its force at the compared rows
    over the noise and over the force, or its ``failure``; and by how many of its deviations it would move
    each parameter, to first order.
    """

    scene: Scene
    settings: FitSettings
    curves: tuple[FittedCurve, ...]
    estimates: tuple[Estimate, ...]
    correlations: Array
    combinations: tuple[Combination, ...]
    hardly_told_apart: list[tuple[str, str, float]]
    goodness: Goodness
    warnings: tuple[str, ...]
    step_tolerance: float | None
    ended: str = "interrupted"
    converged: bool = False
    starts: tuple[float, ...] = ()
    runs: int = 0
    profiles: tuple[dict[str, Any], ...] = ()
    second_solver: dict[str, Any] | None = None
    posterior: Posterior | None = None
    solver_error_over_noise: float | None = None
    seconds: float = 0.0
    question: dict[str, str] | None = None

    @property
    def explained(self) -> bool:
        """Whether the model explains the data."""
        return self.goodness.explained


class InterruptedFit(KeyboardInterrupt):
    """Ctrl-C during a fit; ``result`` holds the best so far, or ``None`` before the first point."""

    def __init__(self, result: FitResult | None) -> None:
        super().__init__()
        self.result = result


def goodness(
    curves: Sequence[FittedCurve], residuals: Array, settings: FitSettings, parameters: int
) -> Goodness:
    """Whether a point explains the data."""
    from scipy import special  # takes longer to load than all else that a curve needs

    squares = float(residuals @ residuals)
    known, unknown = 0.0, parameters - residuals.size
    total = squares
    for one in curves:
        known += one.model.moments.noise_degrees
        unknown += one.background.size + int((~one.hold).sum())
        total += one.own.size * ((one.missed / one.model.moments.noise) ** 2 - rms(one.own) ** 2)
    degrees, within = max(-unknown, 1), settings.within
    if np.isfinite(known):
        chance = float(special.fdtrc(degrees, known, total / degrees))
        pooled = (total + known) / (degrees + known)
    else:
        chance, pooled = float(special.chdtrc(degrees, total)), 1.0
    variance = squares / degrees
    if not within:
        variance = max(variance, 1.0) if chance < UNLIKELY else pooled
    tests = tuple(runs_test(one.curve.name, one.own) for one in curves)
    misfit = math.sqrt(total / degrees)
    share = max(one.missed / float(np.ptp(one.curve.force)) for one in curves)
    return Goodness(total, degrees, known, chance, tests, misfit, share, within, variance)


def runs_test(curve: str, residuals: Array) -> dict[str, Any]:
    """Wald and Wolfowitz' test of the signs of one curve's residuals (Ann. Math. Stat. 11, 147, 1940): runs
    of one sign, their number by chance, and the probability of so few, which miss the shape of the curve."""
    signs = residuals[residuals != 0.0] > 0.0
    both, above = signs.size, int(signs.sum())
    runs = expected = 1 + int((signs[1:] != signs[:-1]).sum()) if both else 0
    chance = 1.0 if both < 10 else 0.0
    if 0 < above < both:
        expected = 1.0 + 2.0 * above * (both - above) / both
        variance = (expected - 1.0) * (expected - 2.0) / max(both - 1.0, 1.0)
        z = (runs + 0.5 - expected) / math.sqrt(variance) if variance > 0.0 else 0.0
        chance = 0.5 * math.erfc(-z / math.sqrt(2.0))
    return {"curve": curve, "runs": runs, "expected": float(expected), "probability": chance}


def independent(point: Sequence[Residuals]) -> Array:
    """Weights with which the residuals of a point count as many as those of them that are independent."""
    return np.concatenate([one.independent for one in point])


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
