"""Arrest of an unstable edge: the next radius at which it is stable, at fixed time."""

from __future__ import annotations

import numpy as np

from validation.reference.tracking.root import bracketed
from validation.reference.tracking.trial import NARROW, Trial

SEARCH_GROWTH = 1.1
"""Ratio of successive search intervals."""
SEARCH_OFFSETS = np.linspace(-1.0, 1.0, 9)
"""Distances, in process zones, at which an arrest is looked for around features of the fields."""
SEARCH_CELL = 0.15
"""Least distance of the radii at which an arrest is looked for, in process zones."""


def arrest_radius(trial: Trial, begin: float, stride: float, outward: bool, limit: float) -> float | None:
    """The next stable radius at fixed time for an unstable edge.

    Searched in intervals, outward in growing ones: there the residual is positive in the end on any profile.
    Where zones are short the intervals grow inwards, too, up to a part of the radius, but pass over no place
    where the fields have features of the length of a zone.

    Parameters
    ----------
    trial : Trial
        Trial step, whose duration will be zero.
    begin : float
        Radius at which the edge is unstable.
    stride : float
        First search interval, a length.
    outward : bool
        Whether the edge runs outward.
    limit : float
        Radius up to which to search.

    Returns
    -------
    float or None
        ``None`` if the edge is not arrested within ``limit``.
    """
    tolerance = trial.condition.tolerance
    longest_inwards = max(trial.spacing, stride)
    radius = begin
    value = -tolerance if outward else tolerance
    features = _feature_radii(trial, begin, limit) if trial.over_zones and not outward else []
    growing = outward or trial.over_zones
    while radius != limit:
        before, at_before = radius, value
        radius = min(radius + stride, limit) if outward else max(radius - stride, limit)
        while features and features[-1] >= before:
            features.pop()
        if features and features[-1] > radius:
            radius = features.pop()
        value = trial.residual(0.0, radius, outward)
        if value > tolerance if outward else value < -tolerance:
            return bracketed(
                lambda a: trial.residual(0.0, a, outward),
                before,
                at_before,
                radius,
                value,
                tolerance,
                NARROW * radius,
            )
        stride *= SEARCH_GROWTH if growing else 1.0
        if not outward:
            stride = min(stride, longest_inwards)
    return limit if outward and limit >= trial.largest_radius else None


def _feature_radii(trial: Trial, begin: float, limit: float) -> list[float]:
    """Radii between ``limit`` and ``begin``, rising, around nodes closer to each other than a zone."""
    nodes, zone = trial.surface.inside, trial.condition.zone_length
    close = np.diff(nodes) < zone
    features = nodes[:-1][close] + 0.5 * np.diff(nodes)[close]
    around = (features[:, None] + zone * SEARCH_OFFSETS).ravel()
    around = np.sort(around[(around > limit) & (around < begin)])
    if not len(around):
        return []
    cells = np.floor(around / (SEARCH_CELL * zone))
    return list(around[np.concatenate(([True], np.diff(cells) > 0.0))])
