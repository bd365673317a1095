"""Roots of a function of one variable: in a bracket, or near a good guess."""

from __future__ import annotations

from collections.abc import Callable

Function = Callable[[float], float]


def bracketed(
    function: Function, low: float, at_low: float, high: float, at_high: float, small: float, narrow: float
) -> float:
    """Regula falsi with Anderson and Bjorck's weights.

    Returns a point with ``|f| <= small``, or the better end of a sign change narrower than ``narrow``.
    ``at_low`` and ``at_high`` are the values at the ends and differ in sign; ``low > high`` is fine.

    Parameters
    ----------
    function : callable
    low : float
        One end.
    at_low : float
        Value there.
    high : float
        The other end; may be below ``low``.
    at_high : float
        Value there, of the other sign.
    small : float
        Value that counts as zero.
    narrow : float
        Width of a bracket that counts as a point.

    Returns
    -------
    float
        Argument.
    """
    for count in range(200):
        if abs(at_high) <= small or abs(high - low) <= narrow or at_low == at_high:
            break
        x = high - at_high * (high - low) / (at_high - at_low)
        if count % 12 == 11 or not min(low, high) < x < max(low, high):
            x = 0.5 * (low + high)
        value = function(x)
        if (value > 0.0) != (at_high > 0.0):
            low, at_low = high, at_high
        else:
            weight = 1.0 - value / at_high
            at_low *= weight if weight > 0.0 else 0.5
        high, at_high = x, value
    return low if abs(at_low) < abs(at_high) else high


def rising_root(
    function: Function,
    first: float,
    offset: float,
    steepness: float,
    limits: tuple[float, float],
    small: float,
) -> tuple[float, float] | None:
    """A root near ``first`` at which the function rises, and its steepness, by a few secant steps.

    The second point is ``offset`` away, or where ``steepness`` (if positive) points. The error of a secant
    step is of the order of the product of the last two values (in units in which function, slope and
    curvature are of order one): where that is small the last point is not looked at. ``None`` if the steps
    leave the limits, the function does not rise, or they do not get there soon.

    Parameters
    ----------
    function : callable
    first : float
        First point.
    offset : float
        Distance of the second.
    steepness : float
        Expected slope, 0 if unknown.
    limits : tuple of float
        Interval that is not left.
    small : float
        Value that counts as zero.

    Returns
    -------
    tuple of float or None
        Argument and steepness.
    """
    one = function(first)
    if steepness > 0.0:
        offset = -one / steepness
        if abs(one) <= small:
            return (first + offset if limits[0] < first + offset < limits[1] else first), steepness
    for _ in range(5):
        second = first + offset
        if not limits[0] < second < limits[1] or second == first:
            return None
        two = function(second)
        steepness = (two - one) / (second - first)
        if steepness <= 0.0:
            return None
        last = second - two / steepness
        if abs(one * two) <= small and abs(last - second) <= abs(offset) and limits[0] < last < limits[1]:
            return last, steepness
        first, one, offset = second, two, last - second
    return None
