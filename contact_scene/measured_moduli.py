"""Measured moduli of a material: relaxation over time, storage and loss over angular frequency."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import LARGEST, SMALLEST, as_tuple, column, positive, true_or_false

_TWO_UNITS = "two strings: units of time and of stress"


@dataclass(frozen=True)
class RelaxationData:
    """Measured relaxation modulus.

    Parameters
    ----------
    times : ndarray, shape (n,)
        > 0, ascending; the moment of the strain step is 0.
    moduli : ndarray, shape (n,)
        Relaxation modulus at these, > 0.
    shear : bool
        Whether they are shear moduli.
    units : pair of str
        Of time and stress, for labels; "" where the file names none.
    """

    times: NDArray[np.float64]
    moduli: NDArray[np.float64]
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        _set_columns(self, ("times", "moduli"))


@dataclass(frozen=True)
class DynamicData:
    """Measured storage and loss modulus.

    Parameters
    ----------
    angular_frequencies : ndarray, shape (n,)
        > 0, ascending, radians per unit time.
    storage, loss : ndarray, shape (n,)
        > 0.
    shear : bool
        Whether they are shear moduli.
    units : pair of str
        Of time and stress, for labels; "" where the file names none.
    """

    angular_frequencies: NDArray[np.float64]
    storage: NDArray[np.float64]
    loss: NDArray[np.float64]
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        _set_columns(self, ("angular_frequencies", "storage", "loss"))


def _set_columns(data: RelaxationData | DynamicData, names: Sequence[str]) -> None:
    """Check measured data: numbers > 0, as many in each column, ascending in the first; labels."""
    true_or_false(data.shear, "shear")
    units = as_tuple(data.units, "units", _TWO_UNITS)
    if len(units) != 2 or not all(isinstance(unit, str) for unit in units):
        raise SceneError("units", f"got {shown(data.units)}", _TWO_UNITS)
    object.__setattr__(data, "units", units)
    for name in names:
        values = column(getattr(data, name), name, "numbers > 0")
        if values.size == 0 or values.shape != np.shape(getattr(data, names[0])):
            raise SceneError(name, f"shape {values.shape}", "as many numbers as in the other columns")
        if not ((values >= SMALLEST) & (values <= LARGEST)).all():
            index = int(np.argmin((values >= SMALLEST) & (values <= LARGEST)))
            positive(float(values[index]), f"{name}[{index}]")
        values.flags.writeable = False
        object.__setattr__(data, name, values)
    if np.any(np.diff(getattr(data, names[0])) < 0.0):
        raise SceneError(names[0], "decreases", "ascending values")
