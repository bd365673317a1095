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
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked
from contact_scene.errors import SceneError
from contact_scene.files import table_text, write_whole
from contact_scene.value_checks import Number, column, true_or_false

Array = NDArray[np.float64]
Values = Annotated[Array, column]
AnyNumber = Annotated[float, Number("a number")]

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
    """How a run can end.

    Examples
    --------
    >>> cc.solve("cycle-v0.02").outcome.kind is cc.OutcomeKind.DETACHED
    True
    """

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
class Outcome(Checked):
    """Why a run ended; ``finished`` separates complete from partial results.

    ``past_extremum`` matters for a contact that has shrunk to its process zone, where the model ends: whether
    the tension had its maximum, the pull-off force, before.

    Examples
    --------
    >>> outcome = cc.solve("cycle-v0.02").outcome
    >>> outcome.finished, outcome.reason
    (True, 'no stable contact is left')
    """

    kind: OutcomeKind
    reason: str
    time: AnyNumber
    past_extremum: Annotated[bool, true_or_false] = False

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
    """A state that a solver has found between its steps.

    ``kind`` is "snap-in" or "pull-off" of an instability, "largest force", "largest tension", "largest
    penetration" or "trigger" of a state that it has located on its dense path. ``uncertainty`` says how far
    time, penetration, force and contact radius, in this order, may be off by how it was located: not by the
    steps of the run, which only another run tells. Empty: it does not say.
    """

    kind: str
    time: float
    penetration: float
    force: float
    contact_radius: float
    uncertainty: tuple[float, ...] = ()


@dataclass(frozen=True)
class SurfaceProfile(Checked):
    """State of the surface at one time.

    ``radius``, ``pressure``, ``displacement`` and ``gap`` have shape (m,), rising radii from 0 to beyond the
    contact edge. ``pressure`` is zero outside; at the edge itself it may be singular and is not sampled.

    Examples
    --------
    >>> profile, = cc.solve("cycle-v0.02", profile_times=[1.0]).trace.profiles
    >>> profile.time, bool((profile.gap >= -1e-12).all())
    (1.0, True)
    """

    time: AnyNumber
    penetration: AnyNumber
    force: AnyNumber
    contact_radius: AnyNumber
    radius: Values
    pressure: Values
    displacement: Values
    gap: Values

    def rules(self) -> None:
        _same_length(vars(self), ("radius", "pressure", "displacement", "gap"))


@dataclass(frozen=True)
class Trace(Checked):
    """Time series of a run, one row per accepted step, the first row the start state.

    The seven arrays of ``COLUMNS`` have shape (n,). ``extra`` holds further columns of that shape (NaN-free).
    ``events`` are instabilities, ``located`` the extrema and triggers that the solver has located, each of
    which is a row too. ``errors`` holds the solver's own relative error estimates by observable, empty where
    none was requested.

    Examples
    --------
    >>> trace = cc.solve("cycle-v0.02").trace
    >>> f"{-trace.force.min():.4e}"
    '1.0185e-02'
    """

    solver: str
    time: Values
    penetration: Values
    force: Values
    contact_radius: Values
    stored_energy: Values
    external_work: Values
    dissipated_energy: Values
    outcome: Outcome
    counters: Counters
    extra: dict[str, Array] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    located: tuple[Event, ...] = ()
    profiles: tuple[SurfaceProfile, ...] = ()
    errors: dict[str, float] = field(default_factory=dict)
    wall_seconds: AnyNumber = 0.0

    def rules(self) -> None:
        extra = {
            f"extra[{name!r}]": column(values, f"extra[{name!r}]") for name, values in self.extra.items()
        }
        _same_length(vars(self) | extra, (*COLUMNS, *extra))
        object.__setattr__(self, "extra", dict(zip(self.extra, extra.values(), strict=True)))

    def __len__(self) -> int:
        return len(self.time)

    @property
    def whole_stored_energy(self) -> Array:
        """Stored energy of the body and, where it is a spring, of the machine."""
        return self.stored_energy + self.extra.get("machine_energy", 0.0)

    def columns(self) -> dict[str, Array]:
        """All columns by name, those of ``COLUMNS`` first."""
        return {name: getattr(self, name) for name in COLUMNS} | self.extra


def _same_length(rows: Mapping[str, Any], names: Sequence[str]) -> None:
    """Refuse columns with more or fewer rows than the first of them."""
    first = rows[names[0]].shape
    for name in names:
        if rows[name].shape != first:
            allowed = f"shape {first}, as the other columns"
            raise SceneError(name, f"has shape {rows[name].shape}", allowed)


def write_trace(trace: Trace, path: str | os.PathLike[str]) -> None:
    """Write ``trace.csv``: a header and one row per step, numbers with all their digits.

    The file appears whole or not at all, and :func:`read_columns` gives the same bits back.
    """
    write_whole(path, table_text(trace.columns()))


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
