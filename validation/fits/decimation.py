"""Long records as means of neighbouring rows, which is all that a fit can use of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from validation.fits.measured_curve import COLUMNS, Array, MeasuredCurve

MOST_ROWS = 20_000
"""Rows of a curve that are fitted: they resolve a thousandth of the record with twenty rows, and the mean of
more loses nothing that the motion's straight lines and a smooth force hold."""


def decimated(curve: MeasuredCurve) -> tuple[MeasuredCurve, int]:
    """The curve with at most ``MOST_ROWS`` rows, and how many of its rows each one is the mean of.

    The noise of the rows is taken to be independent: a stated one falls with the root of their number. Rows
    at the end that fill no mean are left out.
    """
    together = -(-curve.time.size // MOST_ROWS)
    if together == 1:
        return curve, 1
    columns = {name: getattr(curve, name) for name in COLUMNS}
    means: dict[str, Any] = {
        name: _means(values, together) for name, values in columns.items() if values is not None
    }
    means["noise"] = None if curve.noise is None else curve.noise / float(np.sqrt(together))
    return replace(curve, **means), together


def _means(values: Array, together: int) -> Array:
    whole = values.size // together * together
    return np.asarray(values[:whole].reshape(-1, together).mean(axis=1), float)
