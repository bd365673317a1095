"""An answer: a run that somebody's code computed, as columns of a trace under a header; hostile input.

``trace.csv`` begins with lines ``# key: value``, the header; then a line with the names of the columns and a
row for each time. Columns are those of ``contact_scene.COLUMNS``, in the units of the scene; ``time`` and one
more are enough. Two rows of equal time are a jump.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene import COLUMNS, Counters, Event, Outcome, OutcomeKind, SceneError, Trace
from contact_scene.errors import shown
from contact_scene.files import read_text
from contact_scene.tables import is_number, read_table
from contact_scene.trace import Array
from contact_scene.value_checks import SMALLEST, Range, finite, not_negative
from validation.runs.files import from_json

MOST_ROWS = 100_000
"""Rows of an answer: a hundred times those of a fine run of ours."""
LOST = 1e-6
"""Contact counts as lost below this fraction of the largest radius: what a root search leaves of zero."""
LONGEST = 60
"""Characters of a text in the header: it becomes a cell of a table and a label of a figure."""
TABOR = 1.1570
"""Maugis' parameter over Tabor's, where the Dugdale stress is the largest of a Lennard-Jones law."""
CODE = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._+-]{0,39}")
A_CODE = "a name of at most 40 letters, digits, blanks and . _ + -"
TEXTS = ("version", "author", "resolution", "scene")
WORDS = {"outcome": ("completed", "detached"), "units": ("scene",)}
NUMBERS = {
    "seconds": Range("a number from 1e-09 to 1e+10", 1e-9, 1e10),  # a few cycles of a processor, 300 years
    "transition": Range("a number > 0, at most 1e+06, or inf", SMALLEST, 1e6, also=(math.inf,)),
    "tabor": Range("a number > 0, at most 1e+06", SMALLEST, 1e6),
}
KEYS = ("code", *TEXTS, *WORDS, *NUMBERS, "problem")
RANGES = {"time": not_negative, "contact_radius": not_negative}


@dataclass(frozen=True)
class Header:
    """What an answer says of itself.

    ``resolution`` is in the code's own terms and tells several answers of one code apart; an empty ``scene``
    is that of the folder; without an ``outcome`` contact is lost if the last radius is zero. ``transition``
    is Maugis' parameter of a code whose attraction has a finite range, infinite without a zone; ``problem``
    the whole scene, as of :mod:`validation.exam.scene_json`.
    """

    code: str
    version: str = ""
    author: str = ""
    resolution: str = ""
    seconds: float | None = None
    scene: str = ""
    outcome: str = ""
    transition: float | None = None
    problem: dict[str, Any] | None = None

    @property
    def label(self) -> str:
        """Code and version in one."""
        return f"{self.code} {self.version}".strip()

    def lines(self) -> list[str]:
        """The lines of a file."""
        stated = vars(self) | {"units": "scene"}
        stated["problem"] = None if stated.pop("problem") is None else json.dumps(self.problem)
        return [f"# {name}: {value}" for name, value in stated.items() if value not in ("", None)]


@dataclass(frozen=True)
class Answer:
    """What was found in a file: columns, or the ``problem`` for which they cannot be used, in one line."""

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
        end = len(self.columns["time"])
        columns: dict[str, Any] = {name: self.columns.get(name, np.zeros(end)) for name in COLUMNS}
        radius = columns["contact_radius"]
        last = int(np.flatnonzero(radius > LOST * radius.max())[-1]) if radius.any() else end
        lost = last + 1 < end
        if lost:
            columns["contact_radius"] = np.where(np.arange(end) > last, 0.0, radius)
            end = last + 2
        kind = OutcomeKind.DETACHED if lost or self.header.outcome == "detached" else OutcomeKind.COMPLETED
        columns = {name: column[:end] for name, column in columns.items()}
        state = [float(columns[name][-1]) for name in COLUMNS[:4]]
        gone = kind is OutcomeKind.DETACHED and state[-1] == 0.0  # contact that shrinks to nothing is lost
        outcome = Outcome(kind, "as read from its rows", state[0])
        seconds = self.header.seconds or 0.0
        return Trace(
            self.header.code,
            **columns,
            outcome=outcome,
            counters=Counters(),
            events=(Event("pull-off", *state),) if gone else (),
            wall_seconds=seconds,
        )


def read_answer(path: Path, name: str) -> Answer:
    """Read a file, ``name`` in messages; whatever is wrong with it is part of the answer."""
    folder = path.parent.parent.name  # names the code of a file whose header cannot be read
    header = Header((CODE.search(re.sub(r"[^A-Za-z0-9._+-]", "", folder)) or ["?"])[0])
    try:
        text = read_text(path)
        if "\x00" in text:
            raise SceneError("", "holds zero bytes, as UTF-16 does", "UTF-8 text")
        if "\r" in text:
            raise SceneError("", "has lines that end in a carriage return alone", "line feeds")
        lines = text.split("\n")
        count = next((i for i, line in enumerate(lines) if not line.lstrip().startswith("#")), len(lines))
        header, remarks = read_header([line.strip() for line in lines[:count]])
        columns, others = _columns(text, name)
    except SceneError as error:
        return Answer(header, name, problem=str(error.in_file(name)).replace(str(path), name))
    if others:
        remarks.append(f"columns that are not judged: {', '.join(map(shown, others[:5]))}")
    return Answer(header, name, columns, remarks=tuple(f"{name}: {one}" for one in remarks))


def read_header(lines: Sequence[str]) -> tuple[Header, list[str]]:
    """The header of the lines that begin a file, and in a line what is odd in it, if anything is.

    Raises
    ------
    SceneError
        If it names no code, or a value is none that can be used.
    """
    found: dict[str, str] = {}
    odd: list[str] = []
    for line in lines:
        key, colon, value = line.lstrip("# ").partition(":")
        name = key.strip().lower()
        if not colon or name not in KEYS:
            odd.append(shown(key.strip()))
        elif name in found:
            raise SceneError(f"header: {name}", "is given twice", "each key once")
        else:
            found[name] = value.strip()
    code = found.get("code", "")
    if not CODE.fullmatch(code):
        raise SceneError("header: code", f"got {shown(code)}" if code else "is missing", f"# code: {A_CODE}")
    for name, words in WORDS.items():
        if name in found and found[name] not in ("", *words):
            raise SceneError(f"header: {name}", f"got {shown(found[name])}", " or ".join(words))
    stated: dict[str, Any] = {
        name: allowed(_value(found[name]), f"header: {name}")
        for name, allowed in NUMBERS.items()
        if name in found
    }
    if "tabor" in stated:
        stated["transition"] = TABOR * stated.pop("tabor")
    for name in TEXTS:  # printable, and without the signs that a figure or a table would read as markup
        text = re.sub(r"[$\\<>|`*]", "", found.get(name, ""))
        stated[name] = "".join(filter(str.isprintable, text))[:LONGEST]
    more = f" and {len(odd) - 1} more are no keys" if len(odd) > 1 else " is no key"
    told = [f"header: {odd[0]}{more}; allowed: {', '.join(KEYS)}"] if odd else []
    problem, outcome = _problem(found.get("problem")), found.get("outcome", "")
    return Header(code, **stated, outcome=outcome, problem=problem), told


def _value(text: str) -> Any:
    """The number that a text states, or the text."""
    return float(text) if is_number(text) else text


def _problem(text: str | None) -> dict[str, Any] | None:
    try:
        data = None if text is None else from_json(text)
    except ValueError:
        data = ()
    if data is not None and not isinstance(data, dict):
        raise SceneError("header: problem", "is no JSON object", "the scene as in its scene.json")
    return data


def _columns(text: str, file: str) -> tuple[dict[str, Array], list[str]]:
    """Columns by name, and the names of those that are none of a trace."""
    table = read_table(text, file, COLUMNS, f"time and at least one of {', '.join(COLUMNS[1:])}")
    for name, unit in zip(table.names, table.units, strict=True):
        if unit or "/" in name:
            allowed = "columns in the units of the scene, without a unit in their names"
            raise SceneError(f"line {table.named_in}", f"column {shown(name)} states a unit", allowed)
    places = table.places(*(("time", other) for other in COLUMNS[1:]))
    values = [
        table.column(at, RANGES.get(kind, finite), f"column {at + 1}") for at, kind in enumerate(table.kinds)
    ]
    columns = {name: values[at] for name, at in places.items()}
    if (rows := columns["time"].size) > MOST_ROWS:
        raise SceneError("", f"has {rows} rows", f"1 to {MOST_ROWS} rows below the columns")
    back = np.flatnonzero(np.diff(columns["time"]) < 0.0)
    if back.size:
        before, after = columns["time"][back[0] : back[0] + 2]
        key = f"time, line {table.rows[back[0] + 1][0]}"
        raise SceneError(key, f"runs backwards ({before:g} -> {after:g})", "times that never fall")
    return columns, [name for name, kind in zip(table.names, table.kinds, strict=True) if not kind]
