"""The coordinates of a sweep: keys of a scene, the values they take together, a name and a unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_scene.errors import SceneError, shown
from contact_scene.run_control.options import whole_number
from contact_scene.value_checks import finite, one_of, positive

KEYS = (
    "name", "label", "unit", "key", "keys", "factors", "values", "linspace", "geomspace", "range", "scale"
)  # fmt: skip
_VALUES = ("values", "linspace", "geomspace", "range")
RESERVED = ("run", "outcome", "reason", "warnings")
"""Names that a data set of runs has of itself."""
MOST_RUNS = 10_000_000
"""Runs of a plan, and values of a coordinate: their fingerprints alone take a gigabyte and an hour."""


@dataclass(frozen=True)
class Coordinate:
    """What a sweep varies.

    Parameters
    ----------
    name : str
    keys : tuple of str
        Dotted paths into the scene.
    rows : tuple of tuple
        Values of the keys, one tuple for each value of the coordinate, whose value is the first; empty where
        they are sampled.
    ends : pair of float, or None
        Interval from which values are sampled.
    logarithmic : bool
        Whether it is sampled, and drawn, in the logarithm.
    factors : tuple of float
        By which each key multiplies a sampled value.
    label, unit : str
        In words; empty: by the key.
    """

    name: str
    keys: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...] = ()
    ends: tuple[float, float] | None = None
    logarithmic: bool = False
    factors: tuple[float, ...] = (1.0,)
    label: str = ""
    unit: str = ""

    @property
    def values(self) -> list[Any]:
        """One for each row."""
        return [row[0] for row in self.rows]

    def sampled(self, share: float) -> tuple[Any, ...]:
        """The row at a share of the interval, 0 to 1."""
        assert self.ends is not None
        low, high = self.ends
        if self.logarithmic:
            return _times(self.factors, math.exp(math.log(low) + share * math.log(high / low)))
        return _times(self.factors, low + share * (high - low))


def _times(factors: Sequence[float], value: Any) -> tuple[Any, ...]:
    return tuple(value if factor == 1.0 else factor * value for factor in factors)


def read_coordinate(entry: Any, sampled: bool) -> Coordinate:
    """A coordinate of a plan.

    Parameters
    ----------
    entry : dict
        A table ``[[coordinates]]``.
    sampled : bool
        Whether the plan samples: then the coordinate has a ``range``, otherwise values.

    Returns
    -------
    Coordinate

    Raises
    ------
    SceneError
    """
    if not isinstance(entry, Mapping):
        raise SceneError("", f"got {shown(entry)}", "a table with a key and values")
    for key in entry:
        if key not in KEYS:
            raise SceneError(str(key), "unknown key", ", ".join(KEYS))
    keys = _keys(entry)
    name = _text(entry, "name", keys[0])
    if not name or name in RESERVED or "/" in name or not name.isprintable():
        allowed = f"printable, without /, any other than {', '.join(RESERVED)}"
        raise SceneError("name", f"got {shown(name)}", allowed)
    stated = [key for key in _VALUES if key in entry]
    wanted = ("range",) if sampled else _VALUES[:-1]
    if len(stated) != 1 or stated[0] not in wanted:
        problem = f"got {' and '.join(stated)}" if stated else "no values"
        design = "a sample" if sampled else "a grid or a list of points"
        raise SceneError("", problem, f"for {design} one of {', '.join(wanted)}")
    common = {"label": _text(entry, "label", ""), "unit": _text(entry, "unit", "")}
    factors = _factors(entry, len(keys))
    if sampled:
        ends, logarithmic = _ends(entry)
        return Coordinate(name, keys, (), ends, logarithmic, factors, **common)
    if "scale" in entry:
        raise SceneError("scale", "given without range", "scale and range together")
    if "values" in entry:
        rows = _rows(entry["values"], keys, factors, "factors" in entry)
    else:
        rows = tuple(_times(factors, value) for value in _spaced(entry, stated[0]))
    return Coordinate(name, keys, rows, None, stated[0] == "geomspace", factors, **common)


def _keys(entry: Mapping[str, Any]) -> tuple[str, ...]:
    if ("key" in entry) == ("keys" in entry):
        raise SceneError("key", "is missing" if "key" not in entry else "given beside keys", "key or keys")
    keys = [entry["key"]] if "key" in entry else entry["keys"]
    several = isinstance(keys, (list, tuple)) and len(keys) > 0
    if not several or not all(isinstance(key, str) and key for key in keys):
        raise SceneError(
            "keys" if "keys" in entry else "key", f"got {shown(keys)}", "dotted paths of the scene"
        )
    return tuple(keys)


def _text(entry: Mapping[str, Any], key: str, default: str) -> str:
    value = entry.get(key, default)
    if not isinstance(value, str):
        raise SceneError(key, f"got {shown(value)}", "a string")
    return value


def _factors(entry: Mapping[str, Any], count: int) -> tuple[float, ...]:
    factors = entry.get("factors", [1.0] * count)
    if not isinstance(factors, (list, tuple)) or len(factors) != count:
        raise SceneError("factors", f"got {shown(factors)}", f"one number a key: {count}")
    return tuple(finite(factor, f"factors[{index}]") for index, factor in enumerate(factors))


def _rows(
    values: Any, keys: Sequence[str], factors: Sequence[float], scaled: bool
) -> tuple[tuple[Any, ...], ...]:
    """The rows of stated values; an entry for several keys may state a value for each."""
    entries = values.tolist() if isinstance(values, np.ndarray) else values
    if not isinstance(entries, (list, tuple)) or len(entries) == 0:
        raise SceneError("values", f"got {shown(entries)}", "a list of at least one value")
    entries = [entry.item() if isinstance(entry, np.generic) else entry for entry in entries]
    if all(isinstance(entry, (list, tuple)) for entry in entries):
        if scaled or any(len(entry) != len(keys) for entry in entries):
            raise SceneError("values", f"got {shown(entries)}", f"lists of {len(keys)}, a value a key")
        rows = tuple(tuple(entry) for entry in entries)
    else:
        numeric = all(isinstance(e, (int, float)) and not isinstance(e, bool) for e in entries)
        if not numeric and (scaled or not all(isinstance(entry, str) for entry in entries)):
            raise SceneError(
                "values", f"got {shown(entries)}", "numbers, or strings, or lists for several keys"
            )
        rows = tuple(_times(factors, entry) for entry in entries)
    first = [row[0] for row in rows]
    if not (all(isinstance(v, str) for v in first) or all(isinstance(v, (int, float)) for v in first)):
        raise SceneError("values", f"got {shown(first)}", "all numbers or all strings")
    return rows


def _spaced(entry: Mapping[str, Any], kind: str) -> list[float]:
    """Equal distances or equal ratios: ``[first, last, count]``."""
    asked = entry[kind]
    if not isinstance(asked, (list, tuple)) or len(asked) != 3:
        raise SceneError(kind, f"got {shown(asked)}", "[first, last, count]")
    read = positive if kind == "geomspace" else finite
    first, last = read(asked[0], f"{kind}[0]"), read(asked[1], f"{kind}[1]")
    count = whole_number(asked[2], f"{kind}[2]", 1)
    if count > MOST_RUNS:
        raise SceneError(f"{kind}[2]", f"got {count} values", f"at most {MOST_RUNS}")
    if first == last and count > 1:
        raise SceneError(
            kind, f"an empty range, {count} values from {first:g} to {last:g}", "two different ends"
        )
    spaced = np.geomspace(first, last, count) if kind == "geomspace" else np.linspace(first, last, count)
    return [float(value) for value in spaced]


def _ends(entry: Mapping[str, Any]) -> tuple[tuple[float, float], bool]:
    """The interval of a sample."""
    scale, asked = one_of(entry.get("scale", "linear"), "scale", ("linear", "log")), entry["range"]
    if not isinstance(asked, (list, tuple)) or len(asked) != 2:
        raise SceneError("range", f"got {shown(asked)}", "[lowest, highest]")
    read = positive if scale == "log" else finite
    low, high = read(asked[0], "range[0]"), read(asked[1], "range[1]")
    if not low < high:
        raise SceneError("range", f"an empty range, from {low:g} to {high:g}", "lowest < highest")
    return (low, high), scale == "log"
