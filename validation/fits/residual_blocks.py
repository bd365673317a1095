"""Where the residuals of one curve and kind stand, and the noise of those that are no forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.fits.baseline import noise_of_differences
from validation.fits.curve_model import CurveModel
from validation.fits.record import Array

LEAST_RADIUS_NOISE = 1e-4
"""Noise of a measured contact radius over its range, at least."""


@dataclass(frozen=True)
class RowBlock:
    """Where one curve's residuals of one kind stand.

    Parameters
    ----------
    curve : int
    kind : str
        ``force``, ``contact_radius``, ``jump`` or ``regularisation``.
    rows : slice
        Of the whole vector.
    times : ndarray
        Of these residuals.
    """

    curve: int
    kind: str
    rows: slice
    times: Array


def radius_noise(model: CurveModel) -> float:
    """Standard deviation of the measured contact radius, 0 if it was not measured."""
    radius = model.curve.contact_radius
    if radius is None:
        return 0.0
    kept: NDArray[np.bool_] = np.zeros(radius.size, bool)
    kept[model.features.first : model.features.last] = True
    inside = radius[kept] if kept.sum() > 4 else radius
    return max(noise_of_differences(inside), LEAST_RADIUS_NOISE * float(np.ptp(radius)))
