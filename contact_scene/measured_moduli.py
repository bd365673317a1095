"""Measured moduli of a material: relaxation over time, storage and loss over angular frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import LARGEST, SMALLEST, as_tuple, column, positive, true_or_false

Array = NDArray[np.float64]
_TWO_UNITS = "two strings: units of time and of stress"


class MeasuredModuli:
    """What both kinds have in common: columns of numbers > 0, the first of them ascending."""

    columns: ClassVar[tuple[str, ...]]
    over: ClassVar[str]
    shear: bool
    units: tuple[str, str]

    def __post_init__(self) -> None:
        true_or_false(self.shear, "shear")
        units = as_tuple(self.units, "units", _TWO_UNITS)
        if len(units) != 2 or not all(isinstance(unit, str) for unit in units):
            raise SceneError("units", f"got {shown(self.units)}", _TWO_UNITS)
        object.__setattr__(self, "units", units)
        for name in self.columns:
            values = column(getattr(self, name), name, "numbers > 0")
            if values.size == 0 or values.shape != np.shape(self.points):
                raise SceneError(name, f"shape {values.shape}", "as many numbers as in the other columns")
            if not ((values >= SMALLEST) & (values <= LARGEST)).all():
                index = int(np.argmin((values >= SMALLEST) & (values <= LARGEST)))
                positive(float(values[index]), f"{name}[{index}]")
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        if np.any(np.diff(self.points) < 0.0):
            raise SceneError(self.columns[0], "decreases", "ascending values")

    @property
    def points(self) -> Array:
        """Times or angular frequencies of the rows, shape (n,)."""
        points: Array = getattr(self, self.columns[0])
        return points

    @property
    def measured(self) -> Array:
        """All moduli, one column after the other."""
        return np.concatenate([getattr(self, name) for name in self.columns[1:]])

    def window(self) -> tuple[float, float]:
        """Shortest and longest time that the rows tell of."""
        raise NotImplementedError

    def relaxed_response(self) -> Array:
        """What was measured of a relaxed modulus of 1."""
        raise NotImplementedError

    def responses(self, times: Array) -> tuple[Array, Array]:
        """What was measured of branches of modulus 1, a column each, and its derivative by the log time."""
        raise NotImplementedError


@dataclass(frozen=True)
class RelaxationData(MeasuredModuli):
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

    columns = ("times", "moduli")
    over = "times"
    times: Array
    moduli: Array
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def window(self) -> tuple[float, float]:
        return float(self.times[0]), float(self.times[-1])

    def relaxed_response(self) -> Array:
        return np.ones(self.times.size)

    def responses(self, times: Array) -> tuple[Array, Array]:
        ratio = np.minimum(self.times[:, None] / times, 700.0)
        values = np.exp(-ratio)
        return values, ratio * values


@dataclass(frozen=True)
class DynamicData(MeasuredModuli):
    """Measured storage and loss modulus.

    Parameters
    ----------
    angular_frequencies : ndarray, shape (n,)
        > 0, ascending, radians per unit time.
    storage, loss : ndarray, shape (n,)
        > 0.
    shear, units
        As of :class:`RelaxationData`.
    """

    columns = ("angular_frequencies", "storage", "loss")
    over = "frequencies"
    angular_frequencies: Array
    storage: Array
    loss: Array
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def window(self) -> tuple[float, float]:
        return 1.0 / float(self.angular_frequencies[-1]), 1.0 / float(self.angular_frequencies[0])

    def relaxed_response(self) -> Array:
        return np.repeat([1.0, 0.0], self.storage.size)

    def responses(self, times: Array) -> tuple[Array, Array]:
        phase = self.angular_frequencies[:, None] * times
        length = np.hypot(1.0, phase)
        cosine, sine = 1.0 / length, phase / length
        slopes = [2.0 * (sine * cosine) ** 2, sine * cosine * (cosine**2 - sine**2)]
        return np.concatenate([sine**2, sine * cosine]), np.concatenate(slopes)
