"""An answer: a trace somebody's code computed, read as hostile input.

``trace.csv`` begins with the lines of :mod:`validation.exam.header`; then a line with the names of the
columns and a row for each time. Columns are those of ``contact_scene.COLUMNS``, in the units of the scene;
``time`` and one more are enough. Two rows of equal time are a jump.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS, Counters, Event, Outcome, OutcomeKind, SceneError, Trace
from contact_scene.errors import shown
from contact_scene.files import read_rows, read_text
from contact_scene.separators import check_head
from contact_scene.value_checks import LARGEST
from validation.exam.header import Header, read_header

Array = NDArray[np.float64]
MOST_ROWS = 100_000
"""Rows of an answer: a hundred times those of a fine run of ours."""
LOST = 1e-6
"""Contact counts as lost below this fraction of the largest radius: what a root search leaves of zero."""
NOT_NEGATIVE = ("time", "contact_radius")


@dataclass(frozen=True)
class Answer:
    """What was found in one file.

    Parameters
    ----------
    header : Header
    file : str
        Name of the file, relative to the folder that is judged.
    columns : mapping of str to ndarray, shape (n,)
        Those it has; empty if the file cannot be used.
    problem : str
        Why it cannot be used, in one line; empty if it can.
    remarks : tuple of str
        What is odd, one line each.
    """

    header: Header
    file: str
    columns: dict[str, Array] = field(default_factory=dict)
    problem: str = ""
    remarks: tuple[str, ...] = ()

    def trace(self) -> Trace:
        """As a trace, columns that are missing as zeros.

        Contact is lost if the last radius is zero (``LOST``) or the header says so; rows after that are left
        out, but for the first.
        """
        columns = {name: self.columns.get(name) for name in COLUMNS}
        rows = len(self.columns["time"])
        whole = {name: np.zeros(rows) if column is None else column for name, column in columns.items()}
        kind, end = OutcomeKind.COMPLETED, rows
        radius = self.columns.get("contact_radius", np.zeros(0))
        touching = np.flatnonzero(radius > LOST * radius.max(initial=0.0))
        if touching.size and touching[-1] + 1 < radius.size:
            kind, end = OutcomeKind.DETACHED, int(touching[-1]) + 2
            whole["contact_radius"] = np.where(np.arange(rows) > touching[-1], 0.0, radius)
        elif self.header.outcome == OutcomeKind.DETACHED:
            kind = OutcomeKind.DETACHED
        kept: dict[str, Any] = {name: column[:end] for name, column in whole.items()}
        outcome = Outcome(kind, "as read from its rows", float(kept["time"][-1]))
        seconds = self.header.seconds or 0.0
        events: tuple[Event, ...] = ()
        if kind is OutcomeKind.DETACHED and kept["contact_radius"][-1] == 0.0:
            last = (float(kept[name][-1]) for name in ("time", "penetration", "force", "contact_radius"))
            events = (Event("pull-off", *last),)  # where contact shrinks to nothing, it is lost there
        return Trace(
            self.header.code,
            outcome=outcome,
            counters=Counters(),
            events=events,
            wall_seconds=seconds,
            **kept,
        )


def read_answer(path: Path, name: str) -> Answer:
    """Read a file; whatever is wrong with it is part of the answer.

    Parameters
    ----------
    path : Path
    name : str
        Of the file, in messages.
    """
    header = Header(_nameable(path.parent.parent.name))
    try:
        text = read_text(path)
        _check_signs(text, name)
        lines = text.split("\n")
        count = next((i for i, line in enumerate(lines) if not line.lstrip().startswith("#")), len(lines))
        header, remarks = read_header([line.strip() for line in lines[:count]], name)
        columns, odd = _columns(text, name)
    except SceneError as error:
        return Answer(header, name, problem=str(error.in_file(name)).replace(str(path), name))
    return Answer(header, name, columns, remarks=(*remarks, *odd))


def _nameable(name: str) -> str:
    """A name for the code of a file whose header cannot be read."""
    return "".join(c for c in name if c.isascii() and (c.isalnum() or c in "._+-"))[:40].lstrip("._+-") or "?"


def _check_signs(text: str, file: str) -> None:
    """What spreadsheets and other systems write that is no comma-separated UTF-8."""
    if "\x00" in text:
        raise SceneError("", "holds zero bytes, as UTF-16 does", "UTF-8 text", file)
    if "\r" in text:
        raise SceneError("", "has lines that end in a carriage return alone", "line feeds", file)


def _columns(text: str, file: str) -> tuple[dict[str, Array], tuple[str, ...]]:
    rows = read_rows(text, file)
    (line, names), body = rows[0], rows[1:]
    check_head(line, names, COLUMNS, file)
    for name in names:
        if any(sign in name for sign in "[(/"):
            allowed = "columns in the units of the scene, without a unit in their names"
            raise SceneError(f"line {line}", f"column {shown(name)} states a unit", allowed, file)
    repeated = [name for name in COLUMNS if names.count(name) > 1]
    if repeated:
        raise SceneError(f"line {line}", f"two columns {repeated[0]}", "each column once", file)
    known = [name for name in names if name in COLUMNS]
    if "time" not in known or len(known) < 2:
        allowed = f"time and at least one of {', '.join(COLUMNS[1:])}"
        raise SceneError(f"line {line}", f"columns {shown(','.join(names))}", allowed, file)
    if not 1 <= len(body) <= MOST_ROWS:
        raise SceneError("", f"has {len(body)} rows", f"1 to {MOST_ROWS} rows below the columns", file)
    table = np.empty((len(body), len(names)))
    for index, (line, cells) in enumerate(body):
        if len(cells) != len(names):
            raise SceneError(f"line {line}", f"has {len(cells)} cells", f"{len(names)}, as the head", file)
        for place, cell in enumerate(cells):
            table[index, place] = _number(cell, f"line {line}, {names[place]}", file)
    columns = {name: table[:, names.index(name)] for name in known}
    _check_values(columns, [line for line, _ in body], file)
    odd = [name for name in names if name not in COLUMNS]
    told = f"{file}: columns that are not judged: {', '.join(shown(name) for name in odd[:5])}"
    return columns, (told,) if odd else ()


def _number(cell: str, key: str, file: str) -> float:
    try:
        value = float(cell) if "_" not in cell else np.nan
    except ValueError:
        value = np.nan
    if not abs(value) <= LARGEST:
        raise SceneError(key, f"got {shown(cell)}", f"a finite number, at most {LARGEST:g}", file)
    return value


def _check_values(columns: dict[str, Array], lines: list[int], file: str) -> None:
    for name in NOT_NEGATIVE:
        low = np.flatnonzero(columns.get(name, np.zeros(1)) < 0.0)
        if low.size:
            found = f"got {columns[name][low[0]]:g}"
            raise SceneError(f"line {lines[low[0]]}, {name}", found, "a number >= 0", file)
    back = np.flatnonzero(np.diff(columns["time"]) < 0.0)
    if back.size:
        row = int(back[0]) + 1
        times = f"{columns['time'][row - 1]:g} -> {columns['time'][row]:g}"
        raise SceneError(
            f"line {lines[row]}, time", f"runs backwards ({times})", "times that never fall", file
        )
