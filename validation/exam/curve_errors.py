"""Errors of the curves of an answer, over the time in which both it and the reference are in contact.

A difference is relative to the root mean square of the reference in that time, so that a column that is wrong
by a factor is wrong by that factor. Beyond the loss of contact nothing is compared: when contact is lost is a
number of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS, OutcomeKind, Trace
from validation.measure.row_interpolation import WEIGHTS, RowCurve
from validation.measure.scaling import LEAST_SHARE

Array = NDArray[np.float64]

ENERGIES = ("stored_energy", "external_work", "dissipated_energy")
PLAIN_FACTOR = 0.1
"""Largest part of a difference that a constant factor may leave over to be told as such."""
NOTHING = 1e-9
"""Factor below which a column counts as zero."""
LEAST_FACTOR = 1e-2
"""Least departure of a factor from 1 that is told: the least accuracy that passes."""


@dataclass(frozen=True)
class CurveError:
    """One column of an answer against the reference.

    Parameters
    ----------
    error : float
        Root mean square of the difference over that of the reference.
    factor : float or None
        The number that turns the reference into the answer, if there is one other than 1.
    amplitude : float
        Largest magnitude of the reference over its root mean square.
    """

    error: float
    factor: float | None
    amplitude: float


def in_contact(trace: Trace) -> Trace:
    """The rows up to the last one in contact, of a run that lost it."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if trace.outcome.kind is not OutcomeKind.DETACHED or not touching.size:
        return trace
    end = int(touching[-1]) + 1
    columns = {name: getattr(trace, name)[:end] for name in COLUMNS}
    return Trace(trace.solver, **columns, outcome=trace.outcome, counters=trace.counters)


def curve_error(answer: Trace, base: Trace, column: str) -> CurveError | None:
    """Error of a column; ``None`` without a common interval of time.

    Parameters
    ----------
    answer, base : Trace
        Results of :func:`in_contact`.
    column : str
        Name.

    Returns
    -------
    CurveError or None
    """
    begin, end = max(answer.time[0], base.time[0]), min(answer.time[-1], base.time[-1])
    grid = np.unique(np.concatenate((answer.time, base.time)))
    grid = grid[(grid >= begin) & (grid <= end)]
    if grid.size < 2 or len(answer) < 2 or len(base) < 2:
        return None
    second = RowCurve(base.time, getattr(base, column)).within(grid)
    first = RowCurve(answer.time, getattr(answer, column)).within(grid)
    steps: Array = np.diff(grid)

    def mean(values: Array) -> float:
        return float((steps * (WEIGHTS @ values)).sum() / (grid[-1] - grid[0]))

    size = np.sqrt(mean(second**2))
    least = size
    if column in ENERGIES:  # what an energy balance leaves may be next to nothing
        most = max(float(np.abs(getattr(base, name)).max()) for name in ENERGIES)
        least = max(size, LEAST_SHARE * most)
    apart = np.sqrt(mean((first - second) ** 2))
    if least == 0.0:
        return CurveError(0.0 if apart == 0.0 else np.inf, None, 1.0)
    amplitude = float(np.abs(second).max()) / least
    return CurveError(float(apart / least), _factor(first, second, mean), amplitude)


def _factor(first: Array, second: Array, mean: Callable[[Array], float]) -> float | None:
    """The factor between two curves, if it explains their difference; ``mean`` is that over time."""
    square = mean(second**2)
    if square == 0.0:
        return None
    factor = mean(first * second) / square
    left = np.sqrt(max(mean((first - factor * second) ** 2), 0.0) / square)
    away = abs(factor - 1.0)
    return float(factor) if away > LEAST_FACTOR and left < PLAIN_FACTOR * away else None


def factor_in_words(column: str, factor: float) -> str:
    """What a constant factor suggests, in words."""
    name = column.replace("_", " ")
    if abs(factor) < NOTHING:
        return f"{name} is zero throughout"
    if abs(factor + 1.0) < PLAIN_FACTOR:
        sign = {
            "force": "compression is positive",
            "penetration": "downwards is positive",
            "external_work": "work done on the half-space is positive",
        }.get(column, "it is positive here")
        return f"{name} has the other sign: {sign}"
    hint = ", a diameter?" if column == "contact_radius" and abs(factor - 2.0) < PLAIN_FACTOR else ""
    other = ", another unit or sign?" if not 0.1 < factor < 10.0 else hint
    return f"{name} is {factor:.4g} times the reference throughout{other}"
