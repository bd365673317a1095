"""What lies in a folder that is judged: answers of any code, and what codes decline; hostile input.

An answer is a run as columns under a header, in a file ``trace.csv`` or ``trace-SOMETHING.csv``: lines
``# key: value``, then a line with the names of the columns, then a row for each time. Columns are those of
``contact_scene.COLUMNS``, in the units of the scene; ``time`` and one more are enough. Its scene is named in
the header or by its folder. A code declines scenes by tag in ``code.toml``, or one with a reason in
``declined.txt``. Whatever is wrong with a file is told in a line and stops nothing.
"""

from __future__ import annotations

import json
import math
import os
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from contact_scene import COLUMNS, Counters, Event, Outcome, OutcomeKind, Scene, SceneError, Trace
from contact_scene.checked import Checked, fields_of, from_table
from contact_scene.errors import shown
from contact_scene.files import read_text
from contact_scene.tables import is_number, read_table
from contact_scene.trace import Array
from contact_scene.value_checks import SMALLEST, Range, finite, not_negative
from validation.cases import Case, load
from validation.exam.question import EXAM, POSSIBLE, difference, expanded, listed_cases, tags
from validation.runs.folder import from_json
from validation.scenes import names

MOST_ROWS = 100_000
"""Rows of an answer: a hundred times those of a fine run of ours."""
MOST_FILES = 2000
"""Files that are read: the full suite by fifty codes."""
DEEPEST = 4
"""Folders below the one that is judged that are looked into: code, resolution, suite, scene."""
LOST = 1e-6
"""Contact counts as lost below this fraction of the largest radius: what a root search leaves of zero."""
LONGEST, LONGEST_REASON = 60, 200
"""Characters of a text in the header, which becomes a cell of a table, and of a reason, which is a line."""
TABOR = 1.1570
"""Maugis' parameter over Tabor's, where the Dugdale stress is the largest of a Lennard-Jones law."""
CODE = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._+-]{0,39}")
A_CODE = "a name of at most 40 letters, digits, blanks and . _ + -"
BY_TAG, BY_REASON = "code.toml", "declined.txt"
WANTED = re.compile(rf"trace(-.*)?\.csv|{BY_TAG}|{BY_REASON}", re.DOTALL)
ARCHIVES = (".zip", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".7z")
RANGES = {"time": not_negative, "contact_radius": not_negative}
TEXTS = ("version", "author", "resolution", "scene")

_seconds = Range("a number from 1e-09 to 1e+10", 1e-9, 1e10)  # a few cycles of a processor, 300 years
_transition = Range("a number > 0, at most 1e+06, or inf", SMALLEST, 1e6, also=(math.inf,))
_tabor = Range("a number > 0, at most 1e+06", SMALLEST, 1e6)


@dataclass(frozen=True)
class Header(Checked):
    """What an answer says of itself.

    ``resolution`` is in the code's own terms and tells several answers of one code apart; an empty ``scene``
    is that of the folder; without an ``outcome`` contact is lost if the last radius is zero. ``transition``
    is Maugis' parameter of a code whose attraction has a finite range, infinite without a zone; ``problem``
    the whole scene, as in its ``scene.json``.
    """

    code: str = ""
    version: str = ""
    author: str = ""
    resolution: str = ""
    scene: str = ""
    outcome: Literal["", "completed", "detached"] = ""
    units: Literal["scene"] = "scene"
    seconds: Annotated[float | None, _seconds] = None
    transition: Annotated[float | None, _transition] = None
    tabor: Annotated[float | None, _tabor] = None
    problem: dict | None = None

    def rules(self) -> None:
        if not CODE.fullmatch(self.code):
            problem = f"got {shown(self.code)}" if self.code else "is missing"
            raise SceneError("code", problem, f"# code: {A_CODE}")
        if self.tabor is not None:
            object.__setattr__(self, "transition", TABOR * self.tabor)
        for name in TEXTS:  # printable, and without the signs that a figure or a table would read as markup
            text = re.sub(r"[$\\<>|`*]", "", getattr(self, name))
            object.__setattr__(self, name, "".join(filter(str.isprintable, text))[:LONGEST])

    @property
    def title(self) -> str:
        """Code and resolution."""
        return f"{self.code}{f', resolution {self.resolution}' if self.resolution else ''}"

    def lines(self) -> list[str]:
        """The lines of a file."""
        problem = None if self.problem is None else json.dumps(self.problem)
        stated = self.stated() | {"tabor": None, "problem": problem}
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
        time, depth, force, edge = (float(columns[name][-1]) for name in COLUMNS[:4])
        gone = kind is OutcomeKind.DETACHED and edge == 0.0  # contact that shrinks to nothing is lost
        return Trace(
            self.header.code,
            **columns,
            outcome=Outcome(kind, "as read from its rows", time),
            counters=Counters(),
            events=(Event("pull-off", time, depth, force, edge),) if gone else (),
            wall_seconds=self.header.seconds or 0.0,
        )


def read_answer(path: Path, name: str) -> Answer:
    """Read a file, ``name`` in messages; whatever is wrong with it is part of the answer."""
    folder = path.parent.parent.name  # names the code of a file whose header cannot be read
    header = Header((CODE.search(re.sub(r"[^A-Za-z0-9._+-]", "", folder)) or ["unknown"])[0])
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
        return Answer(_placed(header, path), name, problem=_told(error, path, name))
    if others:
        remarks.append(f"columns that are not judged: {', '.join(map(shown, others[:5]))}")
    return Answer(_placed(header, path), name, columns, remarks=tuple(f"{name}: {one}" for one in remarks))


def _placed(header: Header, path: Path) -> Header:
    """The header with the scene that its folder names, where it names none."""
    return header if header.scene else replace(header, scene=path.parent.name)


def _told(error: SceneError, path: Path, name: str) -> str:
    """An error in a line, with the name of the file within the folder."""
    return str(error.in_file(name)).replace(str(path), name)


def read_header(lines: Sequence[str]) -> tuple[Header, list[str]]:
    """The header of the lines that begin a file, and a remark on what is odd in it, if anything is."""
    fields, found, odd = fields_of(Header), dict[str, Any](), list[str]()
    for line in lines:
        key, colon, value = line.lstrip("# ").partition(":")
        name, value = key.strip().lower(), value.strip()
        if not colon or name not in fields:
            odd.append(shown(key.strip()))
        elif name in found:
            raise SceneError(f"header: {name}", "is given twice", "each key once")
        elif name == "problem":
            try:
                found[name] = from_json(value)
            except ValueError:
                found[name] = value
        else:
            found[name] = float(value) if fields[name].rule and is_number(value) else value
    try:
        header: Header = from_table((Header,), found, Path())
    except SceneError as error:
        raise SceneError(f"header: {error.key}", error.problem, error.allowed) from None
    more = f" and {len(odd) - 1} more are no keys" if len(odd) > 1 else " is no key"
    return header, [f"header: {odd[0]}{more}; allowed: {', '.join(fields)}"] if odd else []


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


Declined = dict[tuple[str, str], str]
"""Why a code (first) does not answer a scene (second)."""


@dataclass(frozen=True)
class CodeFile(Checked):
    """The contents of a ``code.toml``."""

    code: str
    declines: tuple[str, ...] = ()

    def rules(self) -> None:
        if not CODE.fullmatch(self.code):
            raise SceneError("code", f"got {shown(self.code)}", A_CODE)


@dataclass(frozen=True)
class AnswerFolder:
    """The scenes of an exam, answers to them, what is declined, and remarks on what could not be used."""

    cases: tuple[Case, ...]
    answers: tuple[Answer, ...]
    declined: Declined
    remarks: tuple[str, ...]

    @property
    def codes(self) -> tuple[str, ...]:
        """Codes that answer or decline, in alphabetical order."""
        found = {answer.header.code for answer in self.answers} | {code for code, _ in self.declined}
        return tuple(sorted(found, key=lambda name: (name.lower(), name)))


def read_folder(folder: Path) -> AnswerFolder:
    """Everything in a folder, of whose ``exam.json`` or, without, of the built-in scenes that are answered.

    ``SceneError`` if it is no folder, its list of scenes cannot be read, or nothing in it is an answer.
    """
    if not os.path.isdir(folder):
        raise SceneError("DIR", f"{folder} is no folder", "a folder with answers, see docs/how-to/exam.md")
    files, remarks = _files(folder)
    answers = [read_answer(path, name) for path, name in files if path.suffix == ".csv"]
    if (folder / EXAM).exists():
        cases = listed_cases(folder)
    else:
        answered = sorted({one.header.scene for one in answers} & set(names()))
        cases = tuple(replace(load(name), profile_times=()) for name in answered)
    known, kept = {case.name: case for case in cases}, []
    declined: Declined = {}
    for one in answers:
        if one.header.scene in known:
            kept.append(_of_this_exam(one, known[one.header.scene].scene))
        else:
            remarks.append(f"{one.file}: {shown(one.header.scene)} is no scene of this exam")
    for path, name in files:
        read = {BY_TAG: _declined_by_tag, BY_REASON: _declined_by_reason}.get(path.name)
        try:
            declined |= {} if read is None else read(path, name, cases, remarks)
        except SceneError as error:
            remarks.append(_told(error, path, name))
    if not kept and not declined:
        reason = f" ({remarks[-1]})" if remarks else ""
        allowed = "files SCENE/trace.csv, see docs/how-to/exam.md"
        raise SceneError("DIR", f"{folder} holds no answer{reason}", allowed)
    return AnswerFolder(cases, tuple(kept), declined, tuple(remarks))


def _files(folder: Path) -> tuple[list[tuple[Path, str]], list[str]]:
    """Files that are read, each with its name in messages, and a remark on each kind of thing passed over."""
    files, passed_over = list[tuple[Path, str]](), dict[str, str]()
    for where, inner, found in os.walk(folder):
        place = Path(where)
        if len(place.relative_to(folder).parts) >= DEEPEST and inner:
            passed_over.setdefault(f"folders more than {DEEPEST} deep are not looked into", inner[0])
            inner.clear()
        inner[:] = sorted(one for one in inner if not one.startswith("."))
        for name in sorted(found):
            if name.lower().endswith(ARCHIVES):
                passed_over.setdefault("archives are not unpacked", name)
            elif WANTED.fullmatch(name) and (place / name).is_symlink():
                passed_over.setdefault("symbolic links are not followed", name)
            elif WANTED.fullmatch(name):
                shown_name = (place / name).relative_to(folder).as_posix()
                files.append((place / name, "".join(c if c.isprintable() else "?" for c in shown_name)))
    remarks = [f"{shown(name)}: {reason}" for reason, name in passed_over.items()]
    if len(files) > MOST_FILES:
        remarks.append(f"only the first {MOST_FILES} of {len(files)} files are read")
    return files[:MOST_FILES], remarks


def _of_this_exam(answer: Answer, scene: Scene) -> Answer:
    """The answer; without its columns where its header states another scene than is asked."""
    if answer.header.problem is None or answer.problem:
        return answer
    apart = difference(answer.header.problem, expanded(scene))
    problem = f"{answer.file}: answers another scene of this name: {apart}"
    return replace(answer, columns={}, problem=problem) if apart else answer


def _declined_by_tag(path: Path, name: str, cases: Sequence[Case], remarks: list[str]) -> Declined:
    """Scenes that a ``code.toml`` declines, each with the tags for which."""
    try:
        data = tomllib.loads(read_text(path))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise SceneError("", f"not a TOML file: {error}", "code and declines") from None
    stated = {key: value for key, value in data.items() if key in ("code", "declines")}
    code: CodeFile = from_table((CodeFile,), stated, path.parent)
    by_scene = {case.name: tags(case.scene) for case in cases}
    known = POSSIBLE.union(*by_scene.values())
    odd = [tag for tag in code.declines if tag not in known]
    if odd:
        allowed = ", ".join(sorted(known))
        remarks.append(f"{name}: {shown(odd[0])} is no tag of a scene here; allowed: {allowed}")
    common = {scene: [tag for tag in found if tag in code.declines] for scene, found in by_scene.items()}
    return {(code.code, scene): f"by tag: {', '.join(found)}" for scene, found in common.items() if found}


def _declined_by_reason(path: Path, name: str, cases: Sequence[Case], remarks: list[str]) -> Declined:
    """The scene that a ``declined.txt`` declines: ``CODE: reason``."""
    code, colon, reason = read_text(path).partition(":")
    if not colon or not CODE.fullmatch(code.strip()) or path.parent.name not in {one.name for one in cases}:
        raise SceneError("", "declines no scene", "a line CODE: REASON in the folder of a scene")
    return {(code.strip(), path.parent.name): " ".join(reason.split())[:LONGEST_REASON]}
