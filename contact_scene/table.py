"""Penetration, position of the stage, or force against time as a table: planned, or recorded.

By straight lines every row is a kink of the load, which a solver steps onto; a record with rows by the
hundred thousand is read as a smooth curve instead, ``interpolation = "cubic"``: the piecewise cubic of
F.N. Fritsch and R.E. Carlson, SIAM J. Numer. Anal. 17, 238 (1980), which has no extremum between the rows.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from contact_scene.errors import SceneError
from contact_scene.segment import Segment, Step
from contact_scene.value_checks import A_COLUMN, LARGEST, a_string, as_tuple, finite, one_of

QUANTITIES = ("penetration", "force")
INTERPOLATIONS = ("linear", "cubic")


@dataclass(frozen=True)
class Table(Step):
    """``quantity`` by straight lines, or piecewise cubics, through ``(times, values)``.

    Times count from the first row. If the first value differs from the current one, the load jumps to it.
    A table of penetrations drives the stage where the machine is a spring.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]
    file: str = field(default="", compare=False)
    quantity: Literal["penetration", "force"] = "penetration"
    interpolation: Literal["linear", "cubic"] = "linear"
    kind: ClassVar[str] = "table"

    def __post_init__(self) -> None:
        name = one_of(self.quantity, "quantity", QUANTITIES)
        one_of(self.interpolation, "interpolation", INTERPOLATIONS)
        a_string(self.file, "file")
        times, values = _column(self.times, "time"), _column(self.values, name)
        if len(times) != len(values):
            raise SceneError(name, f"{len(times)} times but {len(values)} {name}s", "one for each")
        if len(times) < 2:
            raise SceneError("time", f"got {len(times)} rows", f"at least 2 rows of time, {name}")
        if not (np.diff(times) > 0.0).all():
            row, (before, after) = next(
                (row, pair) for row, pair in enumerate(pairwise(times), 2) if pair[1] <= pair[0]
            )
            raise SceneError(
                f"time, row {row}", f"does not advance ({before:g} -> {after:g})", "strictly rising times"
            )
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The rows, the first at the start of the step.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        # Rows that round to the same time after a late start are one row, the last of them.
        rows = dict(zip((time + (t - self.times[0]) for t in self.times), self.values, strict=True))
        at, values = list(rows), list(rows.values())
        if self.interpolation == "cubic" and len(at) > 2 and math.isfinite(time):
            return Segment(self.quantity, time, at[-1], *_cubic(at, values), linear=False)

        def interval(now: float) -> int:
            return min(max(bisect_right(at, now) - 1, 0), len(at) - 2)

        def value(now: float) -> float:
            if len(at) == 1 or now >= at[-1]:
                return values[-1]
            i = interval(now)
            return values[i] + (values[i + 1] - values[i]) * ((now - at[i]) / (at[i + 1] - at[i]))

        def rate(now: float) -> float:
            if len(at) == 1:
                return 0.0
            i = interval(now)
            return (values[i + 1] - values[i]) / (at[i + 1] - at[i])

        return Segment(self.quantity, time, at[-1], value, rate, kinks=tuple(at[1:-1]))


def _column(values: Any, name: str) -> tuple[float, ...]:
    """Checked numbers; long columns of plain floats at once."""
    entries = values.tolist() if isinstance(values, np.ndarray) else as_tuple(values, name, A_COLUMN)
    if all(type(entry) is float for entry in entries):
        numbers = np.array(entries)
        if (np.abs(numbers) <= LARGEST).all():  # not a number compares as false
            return tuple(entries)
    return tuple(finite(entry, f"{name}, row {row}") for row, entry in enumerate(entries, 1))


def _cubic(at: list[float], values: list[float]) -> tuple[Callable[[float], float], Callable[[float], float]]:
    """Value and rate of the piecewise cubic without extrema between the rows."""
    with np.errstate(over="ignore"):  # between rows that all but agree: the mean of slopes is then zero
        pieces: list[list[float]] = PchipInterpolator(at, values).c.T.tolist()  # highest power first

    def value(now: float) -> float:
        if now >= at[-1]:
            return values[-1]
        i = min(max(bisect_right(at, now) - 1, 0), len(pieces) - 1)
        (a, b, c, d), t = pieces[i], now - at[i]
        return d + t * (c + t * (b + t * a))

    def rate(now: float) -> float:
        i = min(max(bisect_right(at, now) - 1, 0), len(pieces) - 1)
        (a, b, c, _), t = pieces[i], now - at[i]
        return c + t * (2.0 * b + 3.0 * t * a)

    return value, rate
