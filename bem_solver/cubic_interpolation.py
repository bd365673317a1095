"""Cubic interpolation among equidistant samples, which stand at whole or half numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def even_cubic(values: Array, position: Array) -> Array:
    """Cubic Lagrange interpolation of samples at half-integers, even about both ends."""
    padded = np.concatenate((values[1::-1], values, values[:-3:-1]))
    return interpolated(divided_differences(padded), position + 1.5)


def cubic_weights(z: Array) -> Array:
    """Lagrange's weights (4, m) at ``z`` (m,) of the cubic through samples at 0, 1, 2 and 3."""
    one, two, three = z - 1.0, z - 2.0, z - 3.0
    return np.array(
        (-one * two * three / 6.0, z * two * three / 2.0, -z * one * three / 2.0, z * one * two / 6.0)
    )


def divided_differences(samples: Array) -> Array:
    """Of the cubics through four neighbouring samples each, in Newton's form."""
    first = samples[1:] - samples[:-1]
    second = 0.5 * (first[1:] - first[:-1])
    third = (second[1:] - second[:-1]) / 3.0
    return np.array((samples[:-3], first[:-2], second[:-1], third))


def interpolated(table: Array, position: Array) -> Array:
    """The cubics of :func:`divided_differences` at positions among the samples, which stand at 0, 1, ..."""
    first = position.astype(np.intp)
    first -= 1
    np.minimum(np.maximum(first, 0, out=first), table.shape[1] - 1, out=first)
    z = position - first
    # clipped: all indices are in range, and to check them takes three times as long
    value, slope, second, third = table.take(first, axis=1, mode="clip")
    third *= z - 2.0  # in place: half of the time of so short arrays goes into making new ones
    third += second
    third *= z - 1.0
    third += slope
    third *= z
    third += value
    return third
