"""Root of a rising function of the edge: secant steps, kept in a bracket once there is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, Protocol, TypeVar


class HasResidual(Protocol):
    """Anything with a residual."""

    @property
    def residual(self) -> float: ...


_MOST = 200
_ROUNDING = 4e-16

T = TypeVar("T", bound=HasResidual)


@dataclass(frozen=True)
class Found(Generic[T]):
    """Last trial and where the root is: here, below ``low``, or above ``high``."""

    where: Literal["here", "below", "above"]
    at: float
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
) -> Found[T]:
    """Root of ``evaluate(x).residual`` in [low, high], where the residual rises through zero.

    ``slope`` is an estimate of the derivative (<= 0: unknown). The result is accurate to ``accuracy`` in x
    and to ``residual`` in the residual, or to rounding.
    """
    negative: float | None = None  # largest x known with residual < 0
    positive: float | None = None  # smallest x known with residual > 0
    x = min(max(guess, low), high)
    trial = evaluate(x)
    for iteration in range(_MOST):
        r = trial.residual
        if not math.isfinite(r):
            raise FloatingPointError(f"the closure is not finite at contact radius {x:.6g}")
        if r < 0.0:
            if x >= high:
                return Found("above", x, trial, slope)
            negative = x if negative is None else max(negative, x)
        elif r > 0.0:
            if x <= low:
                return Found("below", x, trial, slope)
            positive = x if positive is None else min(positive, x)
        if r == 0.0 or (iteration > 0 and slope > 0.0 and abs(r) <= min(slope * accuracy, residual)):
            return Found("here", x, trial, slope)
        left = low if negative is None else negative
        right = high if positive is None else positive
        near = abs(r) <= residual or right - left <= _ROUNDING * abs(x)
        if near and right - left <= accuracy:
            return Found("here", x, trial, slope)
        new = min(max(x - r / slope, left), right) if slope > 0.0 else (right if r < 0.0 else left)
        bracketed = negative is not None and positive is not None
        if bracketed and (not left < new < right or iteration % 6 == 5):
            new = 0.5 * (left + right)
        if new == x:
            return Found("here", x, trial, slope)
        new_trial = evaluate(new)
        secant = (new_trial.residual - r) / (new - x)
        slope = secant if secant > 0.0 else 0.0
        x, trial = new, new_trial
    raise FloatingPointError("the search for the edge did not converge")
