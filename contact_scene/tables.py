"""Tables as text: columns by name, with units and numbers; each error with its file and line.

Cells are parted by semicolons, commas, tabs or blanks, and numbers have decimal points. Decimal commas are
refused, not converted: ``1,5`` may be one number or two. ``#`` (``%``, ``!``, ``//``, ``**``) starts a
comment. Lines without a number before the first row are the head; one of them, a comment too, names the
columns, and ``columns:`` before the names says so. Units stand in brackets behind the names, or in the line
below. A unit is a label of the scene's own units and nothing is converted; one that contradicts its column,
or another unit of that kind, is refused. No more of a file is quoted in an error than a number is long: a
scene may name any file.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import read_text
from contact_scene.value_checks import Range, finite

Array = NDArray[np.float64]

QUANTITIES = {
    "time": ("time", ("t", "time")),
    "relaxation time": ("time", ("tau", "tau_i", "relaxation_time")),
    "frequency": ("frequency", ("f", "freq", "frequency")),
    "angular frequency": ("frequency", ("w", "omega", "ω", "angular_frequency")),
    "temperature": ("temperature", ("T", "temperature")),
    "modulus": ("stress", ("E", "E_i", "E_t", "Et", "E_relax", "modulus", "relaxation_modulus")),
    "storage modulus": ("stress", ("E'", "E_stor", "E_storage", "storage", "storage_modulus")),
    "loss modulus": ("stress", ("E''", 'E"', "E_loss", "loss", "loss_modulus")),
    "instantaneous modulus": ("stress", ("E_0",)),
    "stress": ("stress", ("sxy",)),
    "mode": ("number", ("i",)),
    "fraction": ("number", ("alpha_i",)),
    "shift factor": ("number", ("at", "a_t", "shift_factor")),
    "log shift factor": ("number", ("log_at", "log_a_t", "log10_at", "log10_a_t")),
    "work": ("energy per area", ("work",)),
}
_OWN_NAMES = {
    "length": ("contact_radius", "radius"),
    "speed": ("speed",),
    "energy": ("stored_energy", "external_work", "dissipated_energy"),
}
QUANTITIES |= {name: (kind, (name,)) for kind, names in _OWN_NAMES.items() for name in names}
QUANTITIES |= {
    "force": ("force", ("force", "load", "F", "normal_force")),
    "penetration": ("length", ("penetration", "indentation", "indentation_depth", "depth")),
    "stage": ("length", ("stage", "stage_position", "z", "Z", "z_position", "zsnsr", "z_sensor")),
    "piezo": ("length", ("piezo", "piezo_position", "piezo_displacement", "z_piezo", "zpiezo")),
    "height": ("length", ("height",)),  # away from the sample
    "deflection": (
        "deflection",
        ("deflection", "defl", "cantilever", "cantilever_deflection", "mems_displ."),
    ),
}
"""What a column may hold: the kind of its unit, and its names as :func:`kind_of` compares them."""

_ABSCISSAS = ("time", "frequency", "temperature")
"""Kinds of units of what other columns are given over."""

PREFIXES = {"f": -15, "p": -12, "n": -9, "u": -6, "m": -3, "c": -2, "d": -1, "": 0}
PREFIXES |= {"da": 1, "h": 2, "k": 3, "M": 6, "G": 9, "T": 12}
"""Powers of ten of the SI by their signs."""
_PREFIX = f"({'|'.join(PREFIXES)})"
_UNITS = {
    "length": f"{_PREFIX}m|in|inch|ft|Å|[aA]ngstrom|microns?",
    "time": f"{_PREFIX}s|sec|min|hr",
    "force": f"{_PREFIX}N|dyn|lbf|k?gf",
    "stress": f"{_PREFIX}Pa|psi|m?bar",
    "frequency": f"{_PREFIX}Hz|rad/s|1/s|s\\^?-1",
    "temperature": "m?K|(°|deg ?)[CF]",
    "voltage": f"{_PREFIX}V",
}
"""Plain units by kind. Single letters that stand for a quantity as often (h, F, T) are in none."""

_ANY_SIGN = "points in numbers; semicolons, commas or blanks between cells"
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(\.\d{3})*,\d+([eE][+-]?\d+)?")
_COMMENT = re.compile(r"\s*(#|%|!|//|\*\*)[#%!/*]*")
_COLUMNS = re.compile(r"\s*columns?\s*:\s*", re.IGNORECASE)
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")
_NAME_AND_UNIT = re.compile(r"[^\s\[(]+(?: *[\[(][^\[\]()]*[\])])*|\S+")


@dataclass(frozen=True)
class _Line:
    """A line of the head: text without the mark of a comment, cells, and what columns so named hold.

    ``declared``: the line itself says that it names the columns.
    """

    number: int
    content: str
    comment: bool
    declared: bool
    cells: list[str]
    kinds: tuple[str, ...]

    @property
    def has_abscissa(self) -> bool:
        """Whether a column is known over which others are given."""
        return any(kind and QUANTITIES[kind][0] in _ABSCISSAS for kind in self.kinds)

    def rank(self, sign: str) -> int:
        """How sure it is that the line names columns parted by ``sign``, 3 most; 0: it does not."""
        if self.declared or (all if self.comment else any)(self.kinds):
            return 3
        if not self.comment:
            return 0 if "=" in self.content else 2
        if not all(re.fullmatch(r"[^\W\d_][^=:]*", cell) and not is_number(cell) for cell in self.cells):
            return 0  # a value is stated
        listed = self.has_abscissa or _sign(self.content) in (",", ";", sign)
        words = (_BRACKETS.sub("", cell).partition("/")[0].split() for cell in self.cells)
        return int(listed and (any(self.kinds) or all(len(name) <= 2 for name in words)))

    def check_width(self, width: int, file: str) -> None:
        """Refuse names of columns, as far as they are no prose, that are more or fewer than ``width``."""
        listed = all(self.kinds) or (not self.comment and re.search("[;,\t]", self.content))
        several = len({QUANTITIES[kind][0] for kind in self.kinds if kind}) > 1
        if self.declared or (listed and self.has_abscissa and several):
            problem = f"{len(self.cells)} names, {cell_shown(','.join(self.cells))}, over {width} columns"
            allowed = "a name for each column, points in numbers"
            raise SceneError(f"line {self.number}", problem, allowed, file)


@dataclass(frozen=True)
class TextTable:
    """A table whose rows begin in line ``first``.

    Names, units and what the columns hold (of ``QUANTITIES``) are "" where the head does not tell.
    """

    file: str
    wanted: str
    head: list[_Line]
    first: int
    body: str
    named_in: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    kinds: tuple[str, ...]

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.names)

    def places(self, *alternatives: Sequence[str]) -> dict[str, int]:
        """Places of all known columns, among them those of one of the alternatives."""
        known = [kind for kind in self.kinds if kind]
        for kind in known:
            if known.count(kind) > 1:
                raise SceneError("columns", f"{kind} stands twice", self.wanted, self.file)
        if not any(set(wanted) <= set(known) for wanted in alternatives):
            raise self.unknown()
        check_units(zip(self.kinds, self.units, strict=True), self.file)
        return {kind: self.kinds.index(kind) for kind in known}

    def unknown(self) -> SceneError:
        """The error of columns that are not those wanted."""
        found = cell_shown(",".join(self.names)) if any(self.names) else f"{self.width} columns without names"
        return SceneError("columns", f"got {found}", self.wanted, self.file)

    def column(self, at: int, check: Range = finite, name: str = "") -> Array:
        """The numbers of a column, each in a range; ``name`` is told where the head has no known one."""
        if self._numbers is not None and check.holds(self._numbers[:, at]).all():
            return np.ascontiguousarray(self._numbers[:, at])
        told = self.names[at] if self.kinds[at] else name
        return np.array([number_in(cells[at], told, line, self.file, check) for line, cells in self.rows])

    def stated(self, key: str, check: Range) -> float | None:
        """The number of the last ``key = number`` (or ``key: number``) above the rows."""
        pattern = re.compile(rf"(?:^|[;,]|=[^=\s]*)\s*{key}\s*[=:]\s*([^;\s]*)")
        found = [(match[1], one.number) for one in self.head if (match := pattern.search(one.content))]
        return number_in(found[-1][0], key, found[-1][1], self.file, check) if found else None

    @cached_property
    def rows(self) -> list[tuple[int, list[str]]]:
        """Numbers of the lines of the rows, and their cells."""
        rows = []
        for line, content in enumerate(io.StringIO(self.body), self.first):
            cells = [] if _COMMENT.match(content) else _cells(_without_remark(content), line, self.file)
            if cells and len(cells) != self.width:
                allowed = f"{self.width}, as in line {self.first}"
                raise SceneError(f"line {line}", f"{len(cells)} cells", allowed, self.file)
            rows += [(line, cells)] if cells else []
        return rows

    @cached_property
    def _numbers(self) -> Array | None:
        """All rows read at once; ``None`` where something else than numbers stands in any."""
        sign = _sign(self.body.partition("\n")[0])
        with suppress(ValueError):
            numbers = np.loadtxt(io.StringIO(self.body), delimiter=sign.strip() or None, ndmin=2)
            return numbers if numbers.shape[1] == self.width else None
        return None


def read_table(text: str, file: str, kinds: Sequence[str], wanted: str) -> TextTable:
    """The table in a text; ``kinds`` of ``QUANTITIES`` are known in it; ``wanted``: its columns in words."""
    stream = io.StringIO(text, newline=None)  # any ends of lines
    head: list[_Line] = []
    for number, content in enumerate(stream, 1):
        mark = _COMMENT.match(content)
        rest = content[mark.end() :] if mark else content
        told = _COLUMNS.match(rest)
        rest = rest[told.end() :] if told else rest
        cells = _cells(rest if mark else _without_remark(rest), number, file, strict=not mark)
        if not mark and any(map(is_number, cells)):
            break
        if cells:
            held = tuple(kind_of(_name(cell), kinds) for cell in cells)
            head.append(_Line(number, rest.strip(), bool(mark), bool(told), cells, held))
    else:
        reason = "no rows of numbers" if head else "the file is empty"
        raise SceneError("", reason, f"a table of numbers ({_ANY_SIGN}): {wanted}", file)
    width, sign, rows = len(cells), _sign(content), (head, number, content + stream.read())
    fitting = [one for one in head if len(one.cells) == width]
    named = max(fitting, key=lambda one: one.rank(sign), default=None)
    if not named or not named.rank(sign) or any(one.declared and one not in fitting for one in head):
        for one in head:
            one.check_width(width, file)
        return TextTable(file, wanted, *rows, 0, *3 * (("",) * width,))
    names, units = tuple(map(_name, named.cells)), tuple(map(bracketed, named.cells))
    below = next((one for one in fitting if one.number > named.number), named)
    if not any(units) and below is not named and below.comment == named.comment:
        units = tuple(below.cells)
    return TextTable(file, wanted, *rows, named.number, names, units, named.kinds)


def read_pairs(
    file: Path, names: tuple[str, str], rules: Sequence[Any], others: Sequence[str] = ()
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two columns of numbers, in the order of ``names``, each of what a rule allows.

    The head may say anything but that the columns stand the other way round, that one is what ``others``
    name, or units that contradict the columns or each other.
    """
    wanted = f"rows of two finite numbers: {names[0]}, {names[1]}"
    table = read_table(read_text(file), str(file), (*names, *others), wanted)
    if table.width != 2:
        raise SceneError(f"line {table.first}", f"{table.width} cells", wanted, str(file))
    words = [(re.findall(r"[^\W\d_]+", name) or [""])[0].lower() for name in table.names]
    swapped = words[0] == names[1] or (words[0] != names[0] and names[0] in words)
    if swapped or not set(words).isdisjoint(others):
        found = f"got {cell_shown(','.join(table.names))}"
        raise SceneError(f"line {table.named_in}", found, f"the columns {', '.join(names)}", str(file))
    check_units(zip(names, table.units, strict=True), str(file))
    first, second = (table.column(at, rule, names[at]).tolist() for at, rule in enumerate(rules))
    return tuple(first), tuple(second)


def number_in(cell: str, name: str, line: int, file: str, check: Range = finite) -> float:
    """The number in a cell, which is in a range."""
    key = f"{name}, line {line}"
    if not is_number(cell):
        raise SceneError(key, f"got {cell_shown(cell)}", "a number, with a decimal point", file)
    try:
        return check(float(cell), key)
    except SceneError as error:
        raise error.in_file(file) from None


# Names and units


def kind_of(name: str, kinds: Iterable[str]) -> str:
    """Which of ``kinds`` a column of this name holds, or "". E stands for G; t is a time, T a temperature."""
    plain = name.lower() if len(name) > 1 else name
    if modulus_letter(name):
        plain = "E" + name[1:].lower()
    return next((kind for kind in kinds if plain in QUANTITIES[kind][1]), "")


def modulus_letter(name: str) -> str:
    """E or G, where the name of a column is that of a modulus."""
    return name[0] if re.fullmatch(r"[EG]('|\"|''|t|_\w+)?", name) else ""


def is_number(cell: str) -> bool:
    """Whether a cell of a table holds a number as other programs write it, without underscores."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def bracketed(cell: str) -> str:
    """The unit in brackets behind a name, ``force [nN]`` or ``E(t) (MPa)``; "" where there is none."""
    found = [text.strip() for text in _BRACKETS.findall(cell)]
    unit = next(filter(kind_of_unit, found), found[-1] if found else "")
    return "" if unit in ("t", "w", "f", "omega", "ω") else unit  # arguments


def kind_of_unit(unit: str) -> str:
    """Kind of a plain unit; "" of any other text, compound units such as N/m included."""
    return next((kind for kind, form in _UNITS.items() if re.fullmatch(form, spelt(unit))), "")


def check_units(columns: Iterable[tuple[str, str]], file: str) -> None:
    """Refuse units that contradict what their columns hold, of ``QUANTITIES``, or each other."""
    stated: dict[str, tuple[str, str]] = {}
    for held, unit in columns:
        kind = kind_of_unit(unit)
        if not kind or held not in QUANTITIES:
            continue
        if kind != (own := QUANTITIES[held][0]):
            allowed = "no unit" if own == "number" else f"a unit of {own}, or none"
            raise SceneError("columns", f"{held} in {unit}", allowed, file)
        other, first = stated.setdefault(kind, (held, unit))
        if spelt(first) != spelt(unit):
            problem = f"{held} in {unit}, but {other} in {first}"
            raise SceneError("columns", problem, f"one unit of {kind} in a file, that of the scene", file)


def spelt(unit: str) -> str:
    """One spelling of the micro sign, and of the second."""
    micro = unit.strip().replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    return "s" if micro == "sec" else micro


def _name(cell: str) -> str:
    """The name of a column, before any unit."""
    return re.split(r"[\[(]", cell)[0].strip().replace(" ", "_")


# Cells


def _sign(content: str) -> str:
    """What parts the cells of a line: of semicolon and comma that which leaves more numbers, else blanks."""

    def numbers(sign: str) -> int:
        return sum(is_number(cell.strip(' "')) for cell in content.split(sign))

    return max((sign for sign in ";," if sign in content), key=numbers, default=" ")


def _cells(content: str, line: int, file: str, strict: bool = True) -> list[str]:
    """Cells of a line; names parted by tabs may hold blanks, and a unit in brackets belongs to its name.

    Of a row (``strict``) decimal commas and quotation marks out of place are errors.
    """
    content = content.strip()
    if strict and "," in content:
        _check_decimal_commas(content, line, file)
    sign = _sign(content)
    if sign != " ":
        whole = content.rstrip(";") if sign == ";" else content
        reader = csv.reader([whole], delimiter=sign, strict=strict, skipinitialspace=True)
        try:
            return [cell.strip() for cell in next(reader, [])]
        except csv.Error as error:
            allowed = "cells, quoted whole or not"
            raise SceneError(f"line {line}", f"not CSV: {error}", allowed, file) from None
    words = content.split()
    if any(map(is_number, words)):
        return words
    if "\t" in content:
        return [cell.strip() for cell in content.split("\t") if cell.strip()]
    return _NAME_AND_UNIT.findall(content)


def _without_remark(row: str) -> str:
    """A row without ``# ...`` behind its last cell."""
    front, mark, behind = row.partition("#")
    return front if mark and front[-1:].isspace() and not set(behind) & set(",;") else row


def _check_decimal_commas(content: str, line: int, file: str) -> None:
    """Refuse a row of numbers with decimal commas: cells parted by another sign, or quoted."""
    cells = [cell for cell in re.split(r'[;\t ]+|","', content.strip('"; ')) if cell]
    commas = [bool(_DECIMAL_COMMA.fullmatch(cell)) for cell in cells]
    numbers = [comma or is_number(cell) for comma, cell in zip(commas, cells, strict=True)]
    if len(cells) > 1 and any(commas) and all(numbers):
        raise SceneError(f"line {line}", "numbers have decimal commas", _ANY_SIGN, file)
