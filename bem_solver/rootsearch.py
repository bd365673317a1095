"""Root of a rising function of the edge: secant steps, kept in a bracket once there is one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, Protocol, TypeVar


class HasResidual(Protocol):
    """Anything with a residual."""

    @property
    def residual(self) -> float: ...


T = TypeVar("T", bound=HasResidual)


@dataclass(frozen=True)
class Found(Generic[T]):
    """Last trial and where the root is: here, below ``low``, or above ``high``."""

    where: Literal["here", "below", "above"]
    at: float
    trial: T
    slope: float


def rising_root(
    evaluate: Callable[[float], T], guess: float, slope: float, low: float, high: float, accuracy: float
) -> Found[T]:
    """Root of ``evaluate(x).residual`` in [low, high], where the residual rises through zero.

    ``slope`` is an estimate of the derivative (<= 0: unknown). The result is accurate to ``accuracy`` in x.
    """
    negative: float | None = None  # largest x known with residual < 0
    positive: float | None = None
    x = min(max(guess, low), high)
    trial = evaluate(x)
    for iteration in range(80):
        r = trial.residual
        if r == 0.0:
            break
        if r < 0.0:
            if x >= high:
                return Found("above", x, trial, slope)
            negative = x if negative is None else max(negative, x)
        else:
            if x <= low:
                return Found("below", x, trial, slope)
            positive = x if positive is None else min(positive, x)
        if slope > 0.0 and abs(r) <= slope * accuracy and iteration > 0:
            break
        bracketed = negative is not None and positive is not None and negative < positive
        left, right = (negative, positive) if bracketed else (low, high)
        assert left is not None and right is not None
        if bracketed and right - left <= accuracy:
            break
        if slope > 0.0:
            new = x - r / slope
        else:
            new = x + (0.05 if r < 0.0 else -0.05) * (high - low)
        if bracketed and not left < new < right or iteration > 8 and bracketed and iteration % 2:
            new = 0.5 * (left + right)
        new = min(max(new, left), right)
        if abs(new - x) <= 1e-3 * accuracy:
            break
        new_trial = evaluate(new)
        secant = (new_trial.residual - r) / (new - x)
        if secant > 0.0:
            slope = secant
        elif not bracketed:
            slope = 0.0
        x, trial = new, new_trial
    return Found("here", x, trial, slope)
