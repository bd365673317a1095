"""Whether the model of a fit explains the data at all.

Residuals are in units of the noise. If the model is right, their sum of squares is chi-squared with as many
degrees of freedom as there are residuals beyond the parameters, and their signs follow each other at random.
The noise itself is known from a baseline of so many rows only: the ratio of the two variances has Fisher's
distribution.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from validation.fits.record import Array

UNLIKELY = 1e-3
"""Probability below which a misfit, or the order of its signs, is not taken for chance."""


@dataclass(frozen=True)
class RunsTest:
    """Wald and Wolfowitz' test of the signs of one curve's residuals (Ann. Math. Stat. 11, 147, 1940).

    Parameters
    ----------
    curve : str
    runs, expected : float
        Stretches of one sign, and their number by chance.
    probability : float
        Of so few, by chance.
    """

    curve: str
    runs: int
    expected: float
    probability: float


@dataclass(frozen=True)
class Goodness:
    """Whether what is left looks like noise.

    Parameters
    ----------
    chi_squared : float
        Sum of squares of the residuals.
    degrees : int
        Of freedom.
    noise_degrees : float
        Of freedom from which the noise is known.
    probability : float
        Of a sum as large by chance.
    runs : tuple of RunsTest
        One for each curve.
    """

    chi_squared: float
    degrees: int
    noise_degrees: float
    probability: float
    runs: tuple[RunsTest, ...]

    @property
    def reduced(self) -> float:
        """Sum of squares over degrees of freedom."""
        return self.chi_squared / self.degrees

    @property
    def variance(self) -> float:
        """Of a residual, from residuals and baseline where they agree, else from the residuals."""
        if self.probability < UNLIKELY:
            return max(self.reduced, 1.0)
        if not np.isfinite(self.noise_degrees):
            return 1.0
        return (self.chi_squared + self.noise_degrees) / (self.degrees + self.noise_degrees)

    @property
    def explained(self) -> bool:
        """Whether the model explains the data within their noise.

        Where residuals are less than noise can be, as of a record without any, their signs tell nothing.
        """
        below = self.probability > 1.0 - UNLIKELY
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
    return RunsTest(curve, runs, expected, float(stats.norm.cdf(z)))


def goodness(
    residuals: Array, parameters: int, curves: Sequence[tuple[str, Array]], noise_degrees: float
) -> Goodness:
    """Judge the residuals of a fit.

    Parameters
    ----------
    residuals : ndarray, shape (R,)
        All, in units of the noise.
    parameters : int
        How many were fitted.
    curves : sequence of (str, ndarray)
        Names, and the residuals of the force in the order of time.
    noise_degrees : float
        Of freedom from which the noise is known, infinite if it is stated.

    Returns
    -------
    Goodness
    """
    degrees = max(residuals.size - parameters, 1)
    total = float(residuals @ residuals)
    runs = tuple(runs_test(name, own) for name, own in curves)
    if np.isfinite(noise_degrees):
        chance = float(stats.f.sf(total / degrees, degrees, noise_degrees))
    else:
        chance = float(stats.chi2.sf(total, degrees))
    return Goodness(total, degrees, noise_degrees, chance, runs)
