"""How well a fit determines its parameters.

The covariance of the parameters is ``s^2 (J^T J)^-1`` with the variance ``s^2`` of baseline and residuals
together; where the residuals are too large to be noise, with that of the residuals alone (Birge, Phys. Rev.
40, 207, 1932), which makes intervals honest about size and not about bias.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from validation.fits.goodness import Goodness
from validation.fits.parameters import FitParameter
from validation.fits.record import Array

CONFIDENCE = 0.95
VAGUE = 0.5
"""Standard deviation of a logarithm from which a parameter, or a product of powers, counts as unknown: its
95 % interval spans a factor of seven. Below, a parameter is known to its order of magnitude at least."""
ALIKE = 0.98
"""Correlation from which two parameters are named as hardly told apart: each alone is known five times worse
than with the other given."""
TAKES_PART = 0.2
"""Power of a parameter in a normalised product of powers from which it is named."""
AT_BOUND = 1e-3
"""Distance from a bound, in numbers of the search, below which a parameter counts as held by it."""
NEGLIGIBLE = 1e-12
"""Eigenvalue over the largest below which a direction is not determined at all: round-off of derivatives."""


@dataclass(frozen=True)
class Estimate:
    """A parameter with its error.

    Parameters
    ----------
    name : str
    value : float
    deviation : float
        Standard deviation: of the logarithm, a share of ``value``, where ``logarithmic``; else in the unit of
        ``value``.
    logarithmic : bool
        Whether the logarithm was searched.
    low, high : float
        95 % interval, in the unit of ``value``.
    start : float
    note : str
        What is wrong with it, if anything.
    """

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
    """A product of powers (sum of multiples, of parameters without logarithm) and how well it is known.

    Parameters
    ----------
    powers : mapping of str to float
        By name, the largest 1.
    deviation : float
        Standard deviation of its logarithm.
    """

    powers: dict[str, float]
    deviation: float

    @property
    def text(self) -> str:
        """In words."""
        return " · ".join(
            name if power == 1.0 else f"({name})^{power:.2g}" for name, power in self.powers.items()
        )


def covariance(jacobian: Array, found: Goodness) -> tuple[Array, Array, Array]:
    """Covariance of the numbers of the search, and its directions.

    Parameters
    ----------
    jacobian : ndarray, shape (R, P)
    found : Goodness

    Returns
    -------
    covariance : ndarray, shape (P, P)
        Infinite in directions that the data do not see.
    deviations : ndarray, shape (P,)
        Along the directions, falling.
    directions : ndarray, shape (P, P)
        Rows of unit length.
    """
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
    scale = np.sqrt(found.variance)
    seen = singular**2 > NEGLIGIBLE * singular[0] ** 2 if singular.size and singular[0] > 0 else singular > 0
    deviations = np.where(seen, scale / np.where(seen, singular, 1.0), np.inf)
    finite = np.where(seen, deviations, 0.0)
    result = (directions.T * finite**2) @ directions
    blind = (np.abs(directions[~seen]) > np.sqrt(NEGLIGIBLE)).any(axis=0)
    result[blind, blind] = np.inf
    return result, deviations[::-1], directions[::-1]


def estimates(
    parameters: Sequence[FitParameter], x: Array, spread: Array, notes: Sequence[str]
) -> tuple[Estimate, ...]:
    """Values with standard deviations and 95 % intervals.

    Parameters
    ----------
    parameters : sequence of FitParameter
    x : ndarray, shape (P,)
        Where the search ended.
    spread : ndarray, shape (P, P)
        Covariance.
    notes : sequence of str
        One for each.

    Returns
    -------
    tuple of Estimate
    """
    factor = float(stats.norm.ppf(0.5 + 0.5 * CONFIDENCE))
    found = []
    for one, at, variance, note in zip(parameters, x, np.diag(spread), notes, strict=True):
        deviation = float(np.sqrt(variance))
        ends = []
        for sign, bound in ((-1.0, one.low), (1.0, one.high)):
            end = one.plain(bound) if not np.isfinite(deviation) else float(at) + sign * factor * deviation
            limit = one.plain(bound)
            ends.append(one.value(max(end, limit) if sign < 0.0 else min(end, limit)))
        size = deviation if one.logarithmic else deviation * one.scale
        found.append(
            Estimate(one.name, one.value(float(at)), size, one.logarithmic, ends[0], ends[1], one.start, note)
        )
    return tuple(found)


def correlation(spread: Array) -> Array:
    """Correlations of the parameters, shape (P, P); 0 where a variance is infinite."""
    deviation = np.sqrt(np.diag(spread))
    usable = np.isfinite(deviation) & (deviation > 0.0)
    divisor = np.where(usable, deviation, 1.0)
    result = np.where(np.outer(usable, usable), spread / np.outer(divisor, divisor), 0.0)
    np.fill_diagonal(result, 1.0)
    return result


def bound_notes(parameters: Sequence[FitParameter], x: Array, spread: Array) -> list[str]:
    """For each parameter: whether a bound holds it, or the data do not determine it.

    Parameters
    ----------
    parameters : sequence of FitParameter
    x : ndarray, shape (P,)
        Their values, as the search has them.
    spread : ndarray, shape (P, P)
        Covariance.

    Returns
    -------
    list of str
        Empty where neither is so.
    """
    notes = []
    for one, at, variance in zip(parameters, x, np.diag(spread), strict=True):
        deviation = float(np.sqrt(variance))
        if min(at - one.plain(one.low), one.plain(one.high) - at) < AT_BOUND:
            notes.append("held by its bound")
        elif one.logarithmic and not deviation < VAGUE:
            notes.append("not determined by these data")
        else:
            notes.append("")
    return notes


def combinations(names: Sequence[str], deviations: Array, directions: Array) -> tuple[Combination, ...]:
    """Products of powers of the parameters, independent of each other, the least known first.

    Parameters
    ----------
    names : sequence of str
    deviations : ndarray, shape (P,)
    directions : ndarray, shape (P, P)
        Rows of unit length.

    Returns
    -------
    tuple of Combination
    """
    made = []
    for deviation, direction in zip(deviations, directions, strict=True):
        largest = direction[np.argmax(np.abs(direction))]
        powers = {
            name: float(power / largest)
            for name, power in zip(names, direction, strict=True)
            if abs(power / largest) >= TAKES_PART
        }
        made.append(Combination(powers, float(deviation / abs(largest))))
    return tuple(made)


def confused(names: Sequence[str], correlations: NDArray[np.float64]) -> list[tuple[str, str, float]]:
    """Pairs of parameters that the data hardly tell apart, with their correlation."""
    return [
        (names[i], names[j], float(correlations[i, j]))
        for i in range(len(names))
        for j in range(i)
        if abs(correlations[i, j]) >= ALIKE
    ]
