"""What a file may leave open and its user states, and how raw columns become a curve in SI units.

Positions grow into the sample. A file without times has rows at a sampling rate, or at a speed of the stage.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked, Positive
from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import LARGEST, Rule, finite
from validation.fits.contact import Array
from validation.fits.record import COLUMNS, MeasuredCurve, moved_segments

INSTRUMENTS = ("deflection", "height", "piezo")
"""Columns that only instruments write: their units are what they measured in."""
KINDS = (*COLUMNS, *INSTRUMENTS)
MOST_DROPPED = 0.05
"""Share of rows without numbers, or at whose time one has been recorded before, above which there is no
record: a clock that is read twice between two ticks doubles a few."""


class ColumnsByHand(Rule):
    """Columns of a table by what they hold: name or number (from 1) of the column, and a factor, stated as
    ``"time=3,stage=1:1e-6"``, or as a mapping to columns or (column, factor)."""

    def __call__(self, value: Any, key: str) -> dict[str, tuple[str | int, float]]:
        if isinstance(value, str):
            parts = (part.partition("=") for part in value.split(","))
            value = {holds.strip(): tuple(at.strip().rsplit(":", 1)) for holds, _, at in parts}
        if not isinstance(value, Mapping):
            raise self.refused(key, f"got {shown(value)}")
        found: dict[str, tuple[str | int, float]] = {}
        for holds, stated in value.items():
            column, factor = (*stated, 1.0)[:2] if isinstance(stated, tuple) else (stated, 1.0)
            is_column = isinstance(column, (int, str)) and not isinstance(column, bool) and column != ""
            if holds not in KINDS or not is_column:
                raise self.refused(key, f"got {shown(holds)}: {shown(stated)}")
            column = int(column) if isinstance(column, str) and column.isdigit() else column
            try:
                found[holds] = column, finite(float(factor), key)
            except (TypeError, ValueError):
                raise SceneError(key, f"got the factor {shown(factor)}", "a number") from None
        return found


BY_HAND = ColumnsByHand(
    f"HOLDS=COLUMN[:FACTOR], ...: COLUMN by name or by number from 1, HOLDS one of {', '.join(KINDS)}"
)


@dataclass(frozen=True)
class Given(Checked):
    """Stated by the user, in SI units: it goes before what the file says."""

    spring_constant: Positive | None = None
    sensitivity: Positive | None = None
    sampling_rate: Positive | None = None
    speed: Positive | None = None
    columns: Annotated[Any, BY_HAND] | None = None

    def overrides(self) -> dict[str, float]:
        """The first two as ``afmformats`` takes them."""
        stated = {"spring constant": self.spring_constant, "sensitivity": self.sensitivity}
        return {key: value for key, value in stated.items() if value is not None}

    def spring(self, stated: Any, file: Path) -> float:
        """The spring constant, given or stated."""
        value = stated if self.spring_constant is None else self.spring_constant
        if value is None or not 0.0 < float(value) < LARGEST:
            raise missing(["spring constant"], file)
        return float(value)

    def times(self, position: Array, rate: float | None, file: Path) -> Array:
        """Times of rows that have none: at the rate given, at the speed given, or at the rate stated."""
        rate = self.sampling_rate or (None if self.speed else rate)
        if rate:
            return np.asarray(np.arange(position.size) / rate)
        if self.speed is None:
            raise SceneError("", "states no times", "--sampling-rate or --speed with it", str(file))
        steps = np.abs(np.diff(position)) / self.speed
        return np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-9 * steps.max(initial=0.0)))])

    def curve(
        self,
        file: Path,
        name: str,
        columns: Mapping[str, Array],
        stiffness: float | None,
        numbers: NDArray[Any] | None = None,
        rate: float | None = None,
        kinds: Sequence[str] = (),
        **more: Any,
    ) -> MeasuredCurve:
        """A curve of columns as recorded, with the number of the segment of each row and what the drive does
        there, and rows a second, if stated; left out are rows without numbers or of a time told before."""
        kept = {key: np.asarray(column, float) for key, column in columns.items()}
        driven = "stage" if "stage" in kept else "penetration"
        if "time" not in kept:
            kept["time"] = self.times(kept[driven], rate, file)
        good = np.all([np.abs(column) <= LARGEST for column in kept.values()], axis=0)
        latest = np.maximum.accumulate(np.where(good, kept["time"], -np.inf))
        good[1:] &= latest[1:] > latest[:-1]
        if good.size and good.mean() < 1.0 - MOST_DROPPED:
            problem = f"{int((~good).sum())} of {good.size} rows hold no numbers, or times that do not rise"
            raise SceneError("", problem, "a record row by row; are two columns swapped?", str(file))
        kept = {key: column[good] for key, column in kept.items()}
        if numbers is not None and good.any():
            told = [kind for kind, left in zip(kinds, good, strict=True) if left] if kinds else ()
            more["segments"] = moved_segments(kept[driven], numbers[good], told)
        try:
            return MeasuredCurve(**(more | kept), stiffness=stiffness, name=name)
        except SceneError as error:
            raise SceneError(error.key, error.problem, error.allowed, str(file)) from None


def missing(keys: list[str], file: Path) -> SceneError:
    """The error of a file that does not state something, with the options that do."""
    options = ", ".join(f"--{key.replace(' ', '-')}" for key in keys)
    return SceneError("", f"states no {' and no '.join(keys)}", f"{options} with it", str(file))
