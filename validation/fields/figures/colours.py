"""Colours of a field: which map, over which range, and what the colour bar says.

Signed fields get a diverging map with its neutral colour at zero, the others one that rises in lightness
throughout. Both are read alike with any kind of colour vision. Stresses are singular at a sharp contact edge,
so a range covers all but the outermost hundredth of the area in view (thousandth, where it spans decades),
and the bar shows by an arrow that it goes on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.colors import Normalize

Array = NDArray[np.float64]

DECADES = 4.0
"""Decades below the largest value that a logarithmic range covers."""


class ValueKind(Enum):
    """What the values of a field are like, and the colour map that goes with it."""

    SIGNED = "RdBu_r"
    POSITIVE = "viridis"
    DECADES = "cividis"


COVERED = {ValueKind.SIGNED: 0.99, ValueKind.POSITIVE: 0.99, ValueKind.DECADES: 0.999}
"""Share of the area in view whose values lie within the range."""


@dataclass(frozen=True)
class ColourRange:
    """Range of a field and its map; ``above``, ``below``: whether values in view leave the range there."""

    kind: ValueKind
    low: float
    high: float
    above: bool
    below: bool

    @property
    def map(self) -> str:
        """Name of the colour map."""
        return self.kind.value

    @property
    def extend(self) -> str:
        """Arrows of the colour bar."""
        return {(0, 0): "neither", (0, 1): "max", (1, 0): "min", (1, 1): "both"}[self.below, self.above]

    @property
    def norm(self) -> Normalize:
        """From values to the range of the map, zero to one, and beyond."""
        from matplotlib.colors import LogNorm, Normalize

        return (LogNorm if self.kind is ValueKind.DECADES else Normalize)(self.low, self.high)

    def shade(self, values: ArrayLike) -> Array:
        """Values as fractions of the map's range, clipped to 0..1; the same shape."""
        numbers = np.asarray(values, float)
        if self.kind is ValueKind.DECADES:
            numbers = np.maximum(numbers, self.low)
        return np.clip(np.ma.getdata(self.norm(numbers)), 0.0, 1.0)


def colours(kind: ValueKind, values: Sequence[Array], weights: Sequence[Array]) -> ColourRange:
    """One range of colours for several views of a field.

    Parameters
    ----------
    kind : ValueKind
    values, weights : sequence of (n,) arrays
        Values in each view, and the area each stands for.
    """
    in_view = np.concatenate([np.asarray(v, float) for v in values])
    area = np.concatenate([np.asarray(w, float) for w in weights])
    if in_view.size == 0 or not np.isfinite(in_view).all():
        raise ValueError("a field to be drawn needs finite values in view")
    high = covered(np.abs(in_view) if kind is ValueKind.SIGNED else in_view, area, COVERED[kind])
    if high <= 0.0:  # nothing there, or nothing beyond the covered part
        high = float(np.abs(in_view).max()) or 1.0
    low = {ValueKind.SIGNED: -high, ValueKind.POSITIVE: 0.0, ValueKind.DECADES: high * 10.0**-DECADES}[kind]
    return ColourRange(kind, low, high, bool(in_view.max() > high), bool(in_view.min() < low))


def covered(values: Array, weights: Array, share: float) -> float:
    """The value that ``share`` of the weight does not exceed.

    Parameters
    ----------
    values, weights : ndarray, shape (n,)
    share : float
        0 to 1.

    Returns
    -------
    float
    """
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    row = int(np.searchsorted(total, share * total[-1]))
    return float(values[order[min(row, values.size - 1)]])
