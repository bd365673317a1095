"""The header of an answer: lines ``# key: value`` above the columns of a ``trace.csv``."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from contact_scene import SceneError
from contact_scene.errors import shown
from validation.execution.files import from_json

LONGEST = 60
"""Characters of a text in the header: it becomes a cell of a table and a label of a figure."""
SHORTEST_SECONDS, LONGEST_SECONDS = 1e-9, 1e10
"""A run time is between a few cycles of a processor and three centuries."""
_CODE = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._+-]{0,39}")
A_CODE = "a name of at most 40 letters, digits, blanks and . _ + -"
KEYS = (
    "code",
    "version",
    "author",
    "resolution",
    "seconds",
    "scene",
    "outcome",
    "transition",
    "tabor",
    "units",
    "problem",
)

TABOR = 1.1570
"""Maugis' parameter over Tabor's, where the Dugdale stress is the largest of a Lennard-Jones law."""
OUTCOMES = ("completed", "detached")


@dataclass(frozen=True)
class Header:
    """What an answer says of itself.

    Parameters
    ----------
    code, version, author : str
        The code that computed it.
    resolution : str
        In the code's own terms; tells several answers of one code apart.
    seconds : float or None
        Run time of the answer.
    scene : str
        Name of the scene; empty: that of the folder.
    outcome : str
        One of ``OUTCOMES``; empty: contact is lost if the last contact radius is zero.
    transition : float or None
        Maugis' transition parameter, of a code whose attraction has a finite range; infinite: no zone at all.
    problem : dict or None
        The whole scene, as of :mod:`validation.exam.scene_json`.
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
        values = {name: getattr(self, name) for name in KEYS if name not in ("tabor", "units", "problem")}
        texts = [f"# {name}: {value}" for name, value in values.items() if value not in ("", None)]
        texts.append("# units: scene")
        if self.problem is not None:
            texts.append(f"# problem: {json.dumps(self.problem)}")
        return texts


def is_code(name: str) -> bool:
    """Whether this can be the name of a code: it becomes a column of a table and a label of a figure."""
    return _CODE.fullmatch(name) is not None


def read_header(lines: Sequence[str], file: str) -> tuple[Header, tuple[str, ...]]:
    """The header of the lines that begin a file, and in a line what is odd in it, if anything is.

    Raises
    ------
    SceneError
        If it names no code, or a value is none that can be used; one line.
    """
    found: dict[str, str] = {}
    odd: list[str] = []
    for line in lines:
        key, colon, value = line.lstrip("# ").partition(":")
        name = key.strip().lower()
        if not colon or name not in KEYS:
            odd.append(shown(key.strip()))
        elif name in found:
            raise SceneError(f"header: {name}", "is given twice", "each key once", file)
        else:
            found[name] = value.strip()
    code = found.get("code", "")
    if not is_code(code):
        problem = f"got {shown(code)}" if code else "is missing"
        raise SceneError("header: code", problem, f"# code: {A_CODE}", file)
    units = found.get("units", "scene")
    if units != "scene":
        raise SceneError("header: units", f"got {shown(units)}", "scene: the units of the scene", file)
    if found.get("outcome", "") not in ("", *OUTCOMES):
        raise SceneError("header: outcome", f"got {shown(found['outcome'])}", " or ".join(OUTCOMES), file)

    def text(key: str) -> str:
        return _text(found.get(key, ""))

    header = Header(
        code,
        text("version"),
        text("author"),
        text("resolution"),
        _seconds(found.get("seconds"), file),
        text("scene"),
        text("outcome"),
        _transition(found, file),
    )
    more = f" and {len(odd) - 1} more are no keys" if len(odd) > 1 else " is no key"
    told = f"{file}: header: {odd[0]}{more}; allowed: {', '.join(KEYS)}" if odd else ""
    return replace(header, problem=_problem(found.get("problem"), file)), (told,) if told else ()


def _text(value: str) -> str:
    """Printable, and without the signs that a figure or a table would read as markup."""
    return "".join(c for c in value if c.isprintable() and c not in "$\\<>|`*")[:LONGEST]


def _positive(value: str | None, key: str, file: str, most: float) -> float | None:
    if value is None:
        return None
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not 0.0 < number <= most:
        raise SceneError(f"header: {key}", f"got {shown(value)}", f"a number > 0, at most {most:g}", file)
    return number


def _seconds(value: str | None, file: str) -> float | None:
    seconds = _positive(value, "seconds", file, LONGEST_SECONDS)
    if seconds is not None and seconds < SHORTEST_SECONDS:
        allowed = f"a number from {SHORTEST_SECONDS:g} to {LONGEST_SECONDS:g}"
        raise SceneError("header: seconds", f"got {shown(value)}", allowed, file)
    return seconds


def _transition(found: dict[str, str], file: str) -> float | None:
    """Maugis' parameter, given as such or as Tabor's."""
    tabor = _positive(found.get("tabor"), "tabor", file, 1e6)
    if tabor is not None:
        return TABOR * tabor
    if found.get("transition") == "inf":
        return math.inf
    return _positive(found.get("transition"), "transition", file, 1e6)


def _problem(value: str | None, file: str) -> dict[str, Any] | None:
    if value is None:
        return None
    try:
        data = from_json(value)
    except ValueError:
        data = None
    if not isinstance(data, dict):
        raise SceneError("header: problem", "is no JSON object", "the scene as in its scene.json", file)
    return data
