"""How well a fit determines its parameters, and whether its model explains the data at all.

Residuals are in units of the noise. If the model is right their sum of squares is chi-squared, their signs
follow each other at random, and the covariance is ``s^2 (J^T J)^-1``, with the variance ``s^2`` of baseline
and residuals together. Where residuals are too large to be noise ``s^2`` is theirs alone (Birge, Phys. Rev.
40, 207, 1932); where they are correlated, n rows count as n/L independent ones. Both make intervals honest
about size and not about bias.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from validation.fits.contact import Array
from validation.fits.parameters import Unknown

CONFIDENCE = 0.95
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
    of one sign, their number by chance, and the probability of so few."""

    curve: str
    runs: int
    expected: float
    probability: float


@dataclass(frozen=True)
class Goodness:
    """Whether what is left looks like noise: ``probability``: of a sum of squares as large by chance;
    ``share``: the largest root mean square of a curve over the range of its force; ``variance``: of a
    residual as it is weighted."""

    chi_squared: float
    degrees: int
    noise_degrees: float
    probability: float
    runs: tuple[RunsTest, ...]
    share: float
    within: float | None
    variance: float

    @property
    def reduced(self) -> float:
        """Sum of squares over degrees of freedom."""
        return self.chi_squared / self.degrees

    @property
    def misfit(self) -> float:
        """Root mean square of what is left, over the noise."""
        return float(np.sqrt(self.reduced))

    @property
    def explained(self) -> bool:
        """Whether the model explains the data within the share that was asked for, or else their noise."""
        if self.within is not None:
            return self.share <= self.within
        below = self.probability > 1.0 - UNLIKELY  # less than noise can be: then signs tell nothing
        at_random = all(one.probability >= UNLIKELY for one in self.runs)
        return self.probability >= UNLIKELY and (below or at_random)


def runs_test(curve: str, residuals: Array) -> RunsTest:
    """Count stretches of one sign; few of them mean that the model misses the shape of the curve."""
    signs = residuals[residuals != 0.0] > 0.0
    above = int(signs.sum())
    below = signs.size - above
    runs = 1 + int((signs[1:] != signs[:-1]).sum()) if signs.size else 0
    if min(above, below) == 0:
        return RunsTest(curve, runs, float(runs), 1.0 if signs.size < 10 else 0.0)
    both = above + below
    expected = 1.0 + 2.0 * above * below / both
    variance = (expected - 1.0) * (expected - 2.0) / max(both - 1.0, 1.0)
    z = (runs + 0.5 - expected) / np.sqrt(variance) if variance > 0.0 else 0.0
    return RunsTest(curve, runs, expected, float(special.ndtr(z)))


def correlation_length(residuals: Array) -> float:
    """Rows that tell as much as one: twice the sum of the autocorrelation, up to what white noise has."""
    rows = residuals.size
    power = np.abs(np.fft.rfft(residuals, 2 * rows)) ** 2
    product = np.fft.irfft(power)[:rows]
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
    lowest = np.minimum.accumulate(total)
    end = int(np.argmax(total - lowest))
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


def estimate(one: Unknown, at: float, variance: float) -> Estimate:
    """A number with its standard deviation and 95 % interval, within its bounds."""
    deviation = float(np.sqrt(variance))
    low, high = one.plain(one.low), one.plain(one.high)
    reach = float(special.ndtri(0.5 + 0.5 * CONFIDENCE)) * deviation
    note = ""
    if min(at - low, high - at) < AT_BOUND:
        note = "held by its bound"
    elif not deviation < (VAGUE if one.logarithmic else np.inf):
        note = "not determined by these data"
    size = deviation if one.logarithmic else deviation * one.scale
    ends = one.value(max(at - reach, low)), one.value(min(at + reach, high))
    return Estimate(one.name, one.value(at), size, one.logarithmic, *ends, one.start, note)


def correlation(spread: Array) -> Array:
    """Correlations of the parameters, shape (P, P); 0 where a variance is infinite."""
    deviation = np.sqrt(np.diag(spread))
    usable = np.isfinite(deviation) & (deviation > 0.0)
    divisor = np.where(usable, deviation, 1.0)
    result = np.where(np.outer(usable, usable), spread / np.outer(divisor, divisor), 0.0)
    np.fill_diagonal(result, 1.0)
    return result


def combinations(names: Sequence[str], deviations: Array, directions: Array) -> tuple[Combination, ...]:
    """Products of powers of the parameters along given directions, independent of each other."""
    made = []
    for deviation, direction in zip(deviations, directions, strict=True):
        largest = direction[np.argmax(np.abs(direction))]
        shares = zip(names, (direction / largest).tolist(), strict=True)
        powers = {name: power for name, power in shares if abs(power) >= TAKES_PART}
        made.append(Combination(powers, float(deviation / abs(largest))))
    return tuple(made)


def confused(names: Sequence[str], correlations: Array) -> list[tuple[str, str, float]]:
    """Pairs of parameters that the data hardly tell apart, with their correlation."""
    pairs = np.argwhere(np.tril(np.abs(correlations) >= ALIKE, -1)).tolist()
    return [(names[i], names[j], float(correlations[i, j])) for i, j in pairs]
