"""Where the residual vanishes as a function of the edge: the root it rises through, and the stable one ahead.

The root is found by secant steps, safeguarded by a bracket once there is one; the way of an unstable edge is
looked over in equal ratios of the radius.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
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

    Beyond an edge at rest the residual rises as a root of the distance: a slope over less than ``accuracy``
    tells nothing there, so that of the last secant over more judges the radius, or a change of sign.
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


def first_stable(
    trial: Callable[[float], HasResidual],
    edge: float,
    end: float,
    ratio: float,
    stride: int,
    rounding: float = 0.0,
    places: Sequence[float] = (),
) -> tuple[float, float] | None:
    """Two radii between which the contact becomes stable first on the way of an unstable edge."""
    way = 1.0 if end > edge else -1.0
    count = math.ceil(abs(math.log(end / edge)) / math.log(ratio))
    radii = [edge * ratio ** (way * n) for n in range(count)] + [end]
    known: dict[int, float] = {}

    def excess(n: int) -> float:
        """How strongly the edge is driven on; negative where it is stable."""
        if n not in known:
            known[n] = -way * trial(radii[n]).residual
        return known[n]

    def stable_within(first: int, last: int) -> tuple[float, float] | None:
        for n in range(first + 1, last + 1):
            if excess(n) < -rounding:
                return radii[n - 1], radii[n]
        return None

    for first in range(0, count, stride):
        last, before = min(first + stride, count), max(first - stride, 0)
        one, two, three = (first, last, min(last + stride, count)) if first == 0 else (before, first, last)
        # where it bends by as much as is left, it may fall to zero between
        least = min(excess(one), excess(two), excess(three))
        bent = three == two or abs(excess(one) - 2.0 * excess(two) + excess(three)) >= least
        low, high = sorted((radii[before], radii[last]))
        if bent or any(low <= place <= high for place in places):
            found = stable_within(before, last)
            if found is not None:
                return found
    return None
