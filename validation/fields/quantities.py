"""The fields of a state as a table: name, words, unit, how its values are coloured, and how it is read.

Units are the scene's. Components are cylindrical and positive in tension, also left of the axis. Signed
fields get a diverging map with its neutral colour at zero, the others one that rises in lightness throughout;
both are read alike with any kind of colour vision. Stresses are singular at a sharp contact edge, so a range
of colours covers all but the outermost hundredth of the area in view (thousandth, where it spans decades),
and the bar shows by an arrow that values go on.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.colors import Normalize

    from fem_solver import FieldState

Array = NDArray[np.float64]

STRESS, DENSITY, RATE, LENGTH = "force/length^2", "energy/length^3", "energy/(length^3 time)", "length"
SPANNED = 4.0
"""Decades below the largest value that a logarithmic range covers."""


class ValueKind(Enum):
    """What the values of a field are like, and the colour map that goes with it."""

    SIGNED = "RdBu_r"
    POSITIVE = "viridis"
    DECADES = "cividis"


@dataclass(frozen=True)
class Quantity:
    """A field; ``name`` is that of the command line, of files and of their arrays, ``text`` for colour bars.

    ``values`` are at the nodes, shape (n,).
    """

    name: str
    text: str
    unit: str
    kind: ValueKind
    values: Callable[[FieldState], Array]

    @property
    def label(self) -> str:
        """For colour bars, with the unit."""
        return f"{self.text} ({self.unit.replace('^2', '²').replace('^3', '³')})"

    @property
    def array(self) -> str:
        """The name of its array in a file, with the unit."""
        return f"{self.name} [{self.unit}]"

    @property
    def plain(self) -> str:
        """The label without mathematical type, for windows that have none."""
        text = self.label
        for name, letter in (("sigma", "σ"), ("varepsilon", "ε"), ("theta", "θ")):
            text = text.replace(f"\\{name}", letter)
        return re.sub(r"[$_{}]", "", text)


def _row(of: str, row: int, state: FieldState) -> Array:
    return np.asarray(getattr(state, of)[row])


_COMPONENTS = {"rr": "rr", "zz": "zz", "tt": r"\theta\theta", "rz": "rz"}
_SIGNED, _POSITIVE, _DECADES = ValueKind
_TABLE = (
    Quantity("von_mises", "von Mises stress", STRESS, _POSITIVE, lambda s: s.von_mises),
    Quantity("max_shear", "largest shear stress", STRESS, _POSITIVE, lambda s: s.max_shear),
    Quantity("hydrostatic", "mean stress", STRESS, _SIGNED, lambda s: s.hydrostatic),
    *(
        Quantity(
            f"principal_{k}", f"principal stress {k}", STRESS, _SIGNED, partial(_row, "principal", k - 1)
        )
        for k in (1, 2, 3)
    ),
    *(
        Quantity(f"{of}_{name}", rf"{of} ${symbol}_{{{part}}}$", unit, _SIGNED, partial(_row, of, k))
        for of, symbol, unit in (("stress", r"\sigma", STRESS), ("strain", r"\varepsilon", "1"))
        for k, (name, part) in enumerate(_COMPONENTS.items())
    ),
    Quantity("displacement_r", "displacement $u_r$", LENGTH, _SIGNED, lambda s: s.displacement[:, 0]),
    Quantity("displacement_z", "displacement $u_z$", LENGTH, _SIGNED, lambda s: s.displacement[:, 1]),
    Quantity("stored_energy", "stored energy", DENSITY, _DECADES, lambda s: s.stored_energy_density),
    Quantity(
        "dissipation_rate", "dissipation rate", RATE, _DECADES, lambda s: s.dissipation_rate.sum(axis=0)
    ),
    Quantity(
        "dissipated_energy",
        "energy dissipated",
        DENSITY,
        _DECADES,
        lambda s: s.dissipated.sum(axis=0),
    ),
)
QUANTITIES = {one.name: one for one in _TABLE}
"""All fields by name: what can be drawn, and what the files hold, the displacement there as a vector."""


@dataclass(frozen=True)
class ColourRange:
    """Range of a field and its map; ``above``, ``below``: whether values in view leave the range there."""

    kind: ValueKind
    low: float
    high: float
    above: bool
    below: bool

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


def colours(kind: ValueKind, values: Sequence[Array], areas: Sequence[Array]) -> ColourRange:
    """One range of colours for several views of a field: its values in each, and the area each stands for."""
    in_view = np.concatenate([np.asarray(v, float) for v in values])
    if in_view.size == 0 or not np.isfinite(in_view).all():
        raise ValueError("a field to be drawn needs finite values in view")
    sizes = np.abs(in_view) if kind is ValueKind.SIGNED else in_view
    order = np.argsort(sizes)
    area = np.cumsum(np.concatenate(areas)[order])
    covered = 0.999 if kind is ValueKind.DECADES else 0.99  # share of the area whose values are within
    high = float(sizes[order[min(int(np.searchsorted(area, covered * area[-1])), order.size - 1)]])
    if high <= 0.0:  # nothing there, or nothing beyond the covered part
        high = float(np.abs(in_view).max()) or 1.0
    low = {ValueKind.SIGNED: -high, ValueKind.POSITIVE: 0.0, ValueKind.DECADES: high * 10.0**-SPANNED}[kind]
    return ColourRange(kind, low, high, bool(in_view.max() > high), bool(in_view.min() < low))
