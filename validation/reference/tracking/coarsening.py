"""Coarsening: nodes behind the edge that interpolation between their neighbours reproduces are dropped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.rheology import total
from validation.reference.tracking import hermite
from validation.reference.tracking.surface import Surface

_PROTECTED = np.arange(-2, 3)
"""Nodes about a discontinuity of the fields, counted from it, that are never dropped."""
WIDEST = 0.03
"""Widest interval that coarsening may make, relative to the range of the nodes."""

Array = NDArray[np.float64]


def coarsened(surface: Surface, deviation: float) -> Surface:
    """Drop every other node that the remaining ones give within ``deviation`` of the largest value.

    Every branch counts by itself: one that is small now may dominate later.
    """
    inside = _needed(surface.inside, surface.branches, deviation)
    outside = _needed(surface.outside, surface.units, deviation)
    return replace(
        surface,
        inside=surface.inside[inside],
        branches=surface.branches[inside],
        outside=surface.outside[outside],
        units=surface.units[outside],
    )


def _needed(x: Array, y: Array, deviation: float) -> NDArray[np.intp]:
    """Indices of the nodes to keep; the ends always are."""
    count = len(x)
    if count < 8:
        return np.arange(count)
    candidate = np.zeros(count, bool)
    candidate[2:-2:2] = x[3:-1:2] - x[1:-3:2] < WIDEST * (x[-1] - x[0])
    steps = hermite.beside_steps(np.diff(x))
    beside = steps[:, None] + _PROTECTED  # the discontinuity and the slopes beside it
    candidate[np.minimum(np.maximum(beside, 0), count - 1)] = False
    kept = np.flatnonzero(~candidate)
    dropped = np.flatnonzero(candidate)
    guess = hermite.evaluate(x[kept], y[kept], hermite.slopes(x[kept], y[kept]), x[dropped])
    scale = total(np.abs(y)).max()
    candidate[dropped] = total(np.abs(guess - y[dropped])) <= deviation * scale
    return np.flatnonzero(~candidate)
