"""Result of a run: time series, surface profiles, the reason for its end, and the work it took.

Signs: penetration positive downwards, force positive in compression, pressure positive in compression,
surface displacement positive *downwards* (``gap = f(r) - D + displacement``). Units are the scene's.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from contact_scene.files import write_whole
from contact_scene.value_checks import a_number, a_string, as_tuple, column, of_class, true_or_false

Array = NDArray[np.float64]

COLUMNS = (
    "time",
    "penetration",
    "force",
    "contact_radius",
    "stored_energy",
    "external_work",
    "dissipated_energy",
)


class OutcomeKind(StrEnum):
    """How a run can end."""

    COMPLETED = "completed"
    DETACHED = "detached"
    NO_EQUILIBRIUM = "no equilibrium at the start"
    STEP_UNDERFLOW = "step underflow"
    STEP_BUDGET = "step budget exhausted"
    NOT_FINITE = "not finite"
    OUT_OF_RANGE = "out of range"
    BELOW_ZONE = "out of the model's range"
    INTERRUPTED = "interrupted"
    TRIGGER_NOT_REACHED = "trigger not reached"
    BREAKDOWN = "breakdown"


@dataclass(frozen=True)
class Outcome:
    """Why a run ended; ``finished`` separates complete from partial results.

    ``past_extremum`` matters for a contact that has shrunk to its process zone, where the model ends: whether
    the tension had its maximum, the pull-off force, before.
    """

    kind: OutcomeKind
    reason: str
    time: float
    past_extremum: bool = False

    def __post_init__(self) -> None:
        of_class(self.kind, "kind", OutcomeKind, "an OutcomeKind")
        a_string(self.reason, "reason")
        a_number(self.time, "time")
        true_or_false(self.past_extremum, "past_extremum")

    @property
    def finished(self) -> bool:
        """Whether the result is complete (detachment is a result, not a failure)."""
        below_zone = self.kind is OutcomeKind.BELOW_ZONE and self.past_extremum
        return below_zone or self.kind in (OutcomeKind.COMPLETED, OutcomeKind.DETACHED)


@dataclass
class Counters:
    """Work done by a solver; compared between runs, so it must not depend on the machine."""

    steps: int = 0
    rejected_steps: int = 0
    closure_evaluations: int = 0
    linear_solves: int = 0
    factorisations: int = 0
    history_updates: int = 0
    volume_solves: int = 0


@dataclass(frozen=True)
class Event:
    """An instability: ``kind`` is "snap-in" or "pull-off"."""

    kind: str
    time: float
    penetration: float
    force: float
    contact_radius: float


@dataclass(frozen=True)
class SurfaceProfile:
    """State of the surface at one time.

    ``radius``, ``pressure``, ``displacement`` and ``gap`` have shape (m,), rising radii from 0 to beyond the
    contact edge. ``pressure`` is zero outside; at the edge itself it may be singular and is not sampled.
    """

    time: float
    penetration: float
    force: float
    contact_radius: float
    radius: Array
    pressure: Array
    displacement: Array
    gap: Array

    def __post_init__(self) -> None:
        for name in ("time", "penetration", "force", "contact_radius"):
            a_number(getattr(self, name), name)
        _set_columns(self, ("radius", "pressure", "displacement", "gap"))


@dataclass(frozen=True)
class Trace:
    """Time series of a run, one row per accepted step, the first row the start state.

    The seven arrays of ``COLUMNS`` have shape (n,). ``extra`` holds further columns of that shape (NaN-free).
    ``errors`` holds the solver's own relative error estimates by observable, empty where none was requested.
    """

    solver: str
    time: Array
    penetration: Array
    force: Array
    contact_radius: Array
    stored_energy: Array
    external_work: Array
    dissipated_energy: Array
    outcome: Outcome
    counters: Counters
    extra: dict[str, Array] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    profiles: tuple[SurfaceProfile, ...] = ()
    errors: dict[str, float] = field(default_factory=dict)
    wall_seconds: float = 0.0

    def __post_init__(self) -> None:
        a_string(self.solver, "solver")
        _set_columns(self, COLUMNS)
        of_class(self.outcome, "outcome", Outcome, "an Outcome")
        of_class(self.counters, "counters", Counters, "Counters")
        of_class(self.extra, "extra", Mapping, "columns by name")
        of_class(self.errors, "errors", Mapping, "relative errors by observable")
        a_number(self.wall_seconds, "wall_seconds")
        extra = {
            name: _same_length(values, f"extra[{name!r}]", self.time) for name, values in self.extra.items()
        }
        object.__setattr__(self, "extra", extra)
        for key, kind in (("events", Event), ("profiles", SurfaceProfile)):
            for index, entry in enumerate(as_tuple(getattr(self, key), key, f"a tuple of {kind.__name__}")):
                of_class(entry, f"{key}[{index}]", kind, f"a {kind.__name__}")

    def __len__(self) -> int:
        return len(self.time)

    @property
    def whole_stored_energy(self) -> Array:
        """Stored energy of the half-space and, where it is a spring, of the machine."""
        return self.stored_energy + self.extra.get("machine_energy", 0.0)

    def columns(self) -> dict[str, Array]:
        """All columns by name, those of ``COLUMNS`` first."""
        return {name: getattr(self, name) for name in COLUMNS} | self.extra


def _set_columns(rows: Trace | SurfaceProfile, names: Sequence[str]) -> None:
    """Columns of numbers as arrays, as many in each as in the first."""
    first = column(getattr(rows, names[0]), names[0])
    for name in names:
        object.__setattr__(rows, name, _same_length(getattr(rows, name), name, first))


def _same_length(values: Any, name: str, first: Array) -> Array:
    checked = column(values, name)
    if checked.shape != first.shape:
        raise SceneError(name, f"has shape {checked.shape}", f"shape {first.shape}, as the other columns")
    return checked


def write_trace(trace: Trace, path: str | os.PathLike[str]) -> None:
    """Write ``trace.csv``: a header and one row per step, numbers with all their digits.

    The file appears whole or not at all, and :func:`read_columns` gives the same bits back.
    """
    columns = trace.columns()
    rows = zip(*(np.asarray(column, float).tolist() for column in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    write_whole(path, "\n".join(lines) + "\n")


def read_columns(path: str | os.PathLike[str]) -> dict[str, Array]:
    """Read the columns of a ``trace.csv`` back; a ValueError if it is none."""
    with Path(path).open(newline="", encoding="utf-8") as stream:
        header, *rows = list(csv.reader(stream)) or [[]]
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise ValueError(f"{path}: no column {', '.join(missing)}")
    for line, row in enumerate(rows, 2):
        if len(row) != len(header):
            raise ValueError(f"{path}: line {line} has {len(row)} cells, the header {len(header)}")
    table = np.array([[float(cell) for cell in row] for row in rows]).reshape(len(rows), len(header))
    return {name: table[:, index] for index, name in enumerate(header)}
