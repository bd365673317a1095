"""Root of a rising function of the edge: secant steps, safeguarded by a bracket once there is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, Protocol, TypeVar


class HasResidual(Protocol):
    """Anything with a residual."""

    @property
    def residual(self) -> float: ...


_ITERATIONS = 200
"""Evaluations before the search is given up; bisection alone would need about 60."""
_ROUNDING = 4e-16
"""Relative width of a bracket that holds no further floating-point number."""

T = TypeVar("T", bound=HasResidual)


@dataclass(frozen=True)
class RootSearchResult(Generic[T]):
    """Last trial at ``x``, and the position of the root: there, below ``low``, or above ``high``.

    ``slope`` is the derivative as measured in the search; zero if it was not.
    """

    position: Literal["converged", "below", "above"]
    x: float
    trial: T
    slope: float


def rising_root(
    evaluate: Callable[[float], T],
    guess: float,
    slope: float,
    low: float,
    high: float,
    accuracy: float,
    residual: float = math.inf,
) -> RootSearchResult[T]:
    """Root of ``evaluate(x).residual`` in [low, high], where the residual rises through zero.

    Parameters
    ----------
    evaluate : callable
        TrialContact at a contact radius, with its ``residual``.
    guess : float
        Where the search starts.
    slope : float
        Estimate of the derivative; <= 0: unknown.
    low, high : float
        Interval searched.
    accuracy, residual : float
        Tolerances in the radius and in the residual, both met at the root, or rounding.

    Returns
    -------
    RootSearchResult

    Raises
    ------
    FloatingPointError
        If a residual is not finite or the search does not converge.

    Notes
    -----
    Beyond an edge at rest the residual rises as a root of the distance, with a vertical tangent there: a
    slope measured over less than ``accuracy`` tells nothing about where the root lies within it. The
    tolerance in the radius is therefore judged by the smaller of the last secant and the last one over at
    least ``accuracy``, the one that is returned, or by a change of sign.
    """
    negative: float | None = None  # largest x known with residual < 0
    positive: float | None = None  # smallest x known with residual > 0
    wide, measured = slope, 0.0  # over at least the accuracy
    x = min(max(guess, low), high)
    trial = evaluate(x)
    for iteration in range(_ITERATIONS):
        r = trial.residual
        if not math.isfinite(r):
            raise FloatingPointError(f"the closure is not finite at contact radius {x:.6g}")
        if r < 0.0:
            if x >= high:
                return RootSearchResult("above", x, trial, measured)
            negative = x if negative is None else max(negative, x)
        elif r > 0.0:
            if x <= low:
                return RootSearchResult("below", x, trial, measured)
            positive = x if positive is None else min(positive, x)
        if r == 0.0 or (iteration > 0 and abs(r) <= min(slope * accuracy, wide * accuracy, residual)):
            return RootSearchResult("converged", x, trial, measured)
        left = low if negative is None else negative
        right = high if positive is None else positive
        near = abs(r) <= residual or right - left <= _ROUNDING * abs(x)
        if near and right - left <= accuracy:
            return RootSearchResult("converged", x, trial, measured)
        new = min(max(x - r / slope, left), right) if slope > 0.0 else (right if r < 0.0 else left)
        bracketed = negative is not None and positive is not None
        if not bracketed and (iteration > 0 or new == x) and abs(new - x) < accuracy:
            new = min(max(x - math.copysign(accuracy, r), left), right)
        if bracketed and (not left < new < right or iteration % 6 == 5):
            new = 0.5 * (left + right)
        if new == x:
            return RootSearchResult("converged", x, trial, measured)
        new_trial = evaluate(new)
        secant = (new_trial.residual - r) / (new - x)
        slope = max(secant, 0.0)
        if abs(new - x) >= accuracy:
            wide = measured = slope
        x, trial = new, new_trial
    raise FloatingPointError("the search for the edge did not converge")
