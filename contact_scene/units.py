"""Units that the header of a table states beside the names of its columns.

A file holds numbers in the units of the scene, any consistent system: a unit is a label and nothing is
converted. What can be told from labels alone is refused: a unit of another kind than the column's, and two
units in columns of one kind, whose numbers cannot both be the scene's.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from contact_scene.errors import SceneError

_PREFIX = "(da|[fpnumcdhkMGT])?"
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

COLUMNS = {
    "time": "time",
    "penetration": "length",
    "stage": "length",
    "contact_radius": "length",
    "radius": "length",
    "height": "length",
    "force": "force",
    "speed": "speed",
    "work": "energy per area",
    "relaxation time": "time",
    "frequency": "frequency",
    "angular frequency": "frequency",
    "modulus": "stress",
    "storage modulus": "stress",
    "loss modulus": "stress",
    "temperature": "temperature",
    "shift factor": "number",
    "log shift factor": "number",
}
"""Kind of the unit of a column, by what the column holds."""


def bracketed(cell: str) -> str:
    """The unit in brackets behind a name, ``force [nN]`` or ``E(t) (MPa)``; "" where there is none."""
    found = [text.strip() for text in re.findall(r"[\[(]([^\])]*)[\])]", cell)]
    return next(filter(kind_of_unit, found), found[-1] if found else "")


def without_unit(cell: str) -> str:
    """What stands in the head of a column (or of several) beside the units in brackets."""
    return re.sub(r"[\[(][^\])]*[\])]", "", cell).strip()


def kind_of_unit(unit: str) -> str:
    """Kind of a plain unit; "" of any other text, compound units such as N/m included."""
    return next((kind for kind, form in _UNITS.items() if re.fullmatch(form, _spelt(unit))), "")


def check_units(columns: Iterable[tuple[str, str]], key: str, file: str) -> None:
    """Refuse units that contradict their columns or each other.

    Parameters
    ----------
    columns : iterable of (str, str)
        What each column holds, one of ``COLUMNS`` (others are passed over), and the unit stated for it.
    key : str
        Where they are stated, for the error.
    file : str

    Raises
    ------
    SceneError
        One line: which unit, and what is allowed.
    """
    stated: dict[str, tuple[str, str]] = {}
    for name, unit in columns:
        kind = kind_of_unit(unit)
        if not kind or name not in COLUMNS:
            continue
        if kind != COLUMNS[name]:
            allowed = "no unit" if COLUMNS[name] == "number" else f"a unit of {COLUMNS[name]}, or none"
            raise SceneError(key, f"{name} in {unit}", allowed, file)
        other, first = stated.setdefault(kind, (name, unit))
        if _spelt(first) != _spelt(unit):
            problem = f"{name} in {unit}, but {other} in {first}"
            raise SceneError(key, problem, f"one unit of {kind} in a file, that of the scene", file)


def _spelt(unit: str) -> str:
    """One spelling of the micro sign, and of the second."""
    micro = unit.strip().replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    return "s" if micro == "sec" else micro
