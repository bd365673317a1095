"""Root of a function of one variable in a bracket: regula falsi with Anderson and Bjorck's weights."""

from __future__ import annotations

from collections.abc import Callable


def bracketed(
    function: Callable[[float], float],
    low: float,
    at_low: float,
    high: float,
    at_high: float,
    small: float,
    narrow: float,
) -> float:
    """A point with ``|f| <= small``, or the better end of a sign change narrower than ``narrow``.

    ``at_low`` and ``at_high`` are the values at the ends and differ in sign. ``low > high`` is fine.
    """
    for count in range(200):
        if abs(high - low) <= narrow or at_low == at_high:
            break
        x = high - at_high * (high - low) / (at_high - at_low)
        if count % 12 == 11 or not min(low, high) < x < max(low, high):
            x = 0.5 * (low + high)
        value = function(x)
        if abs(value) <= small:
            return x
        if (value > 0.0) != (at_high > 0.0):
            low, at_low = high, at_high
        else:
            weight = 1.0 - value / at_high
            at_low *= weight if weight > 0.0 else 0.5
        high, at_high = x, value
    return low if abs(at_low) < abs(at_high) else high
