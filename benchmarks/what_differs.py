"""What differs between two folders of results: verdicts, checks and values, in every JSON and CSV file.

    python -m benchmarks.what_differs BEFORE AFTER [--beyond 1e-9]

A value differs if it has moved by more than ``--beyond`` of its magnitude; a number of a CSV column, of the
largest magnitude in that column. A verdict, a check or a file that only one folder has is always said. Times,
memory and versions belong to the machine and are left out. Exit code 1 if anything differs.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

MACHINE = ("seconds", "memory", "environment", "program", "processor", "version", "commit", "repeats")
"""Parts of keys whose values belong to the machine or to the state of the program."""
IDENTITY = ("scene", "name", "solver", "quantity", "source", "axis", "label", "scheme", "kind")
"""Keys that name an entry of a list, so that an entry which has come or gone moves no other."""


def named(entries: list[Any]) -> dict[str, Any]:
    """A list by what names its entries, or by their numbers."""
    seen: Counter[str] = Counter()
    found = {}
    for entry in entries:
        keys = IDENTITY if isinstance(entry, Mapping) else ()
        name = " ".join(str(entry[key]) for key in keys if entry.get(key))
        seen[name] += 1
        found[f"[{name}]" if name and seen[name] == 1 else f"[{name}#{seen[name]}]"] = entry
    return found


def columns(text: str) -> dict[str, list[Any]]:
    """The columns of a table with one row of names; numbers as such."""
    names, *rows = list(csv.reader(text.splitlines())) or [[]]
    found = {}
    for name, column in zip(names, zip(*rows, strict=True), strict=False):
        try:
            found[name] = list(map(float, column))
        except ValueError:
            found[name] = list(column)
    return found


def apart(one: Any, two: Any, size: float | None = None) -> float:
    """Difference over the larger magnitude (or ``size``); infinite for what are not two numbers."""
    if one == two:
        return 0.0
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in (one, two)):
        return math.inf
    size = max(abs(one), abs(two)) if size is None else size
    return abs(one - two) / size if size > 0.0 else 0.0


def of_data(old: Any, new: Any, beyond: float, path: str = "") -> Iterator[str]:
    """One line a value that differs, and one a value or entry that has come or gone."""
    if isinstance(old, list) and isinstance(new, list):
        old, new = named(old), named(new)
    if not isinstance(old, Mapping) or not isinstance(new, Mapping):
        if (difference := apart(old, new)) > beyond:
            yield f"{path}: {old!r} -> {new!r}" + f" ({difference:.1e})" * math.isfinite(difference)
        return
    for key in {**old, **new}:
        if key in old and key in new and not any(part in key.split("[")[0] for part in MACHINE):
            yield from of_data(old[key], new[key], beyond, f"{path}/{key}")
        elif key not in old or key not in new:
            yield f"{path}/{key}: {'gone' if key in old else 'new'}"


def of_columns(old: Mapping[str, list[Any]], new: Mapping[str, list[Any]], beyond: float) -> Iterator[str]:
    """One line a column that differs, with its worst row."""
    for name in {**old, **new}:
        if name not in new or name not in old:
            yield f"column {name}: {'gone' if name in old else 'new'}"
        elif len(old[name]) != len(new[name]):
            yield f"column {name}: {len(old[name])} -> {len(new[name])} rows"
        elif old[name]:
            size = max((abs(v) for v in old[name] if isinstance(v, float) and math.isfinite(v)), default=0.0)
            found = [apart(one, two, size) for one, two in zip(old[name], new[name], strict=True)]
            if (worst := max(found)) > beyond:
                yield f"column {name}: row {found.index(worst) + 1} by {worst:.1e} of the largest"


def differences(before: Path, after: Path, beyond: float) -> Iterator[str]:
    """Every difference of two folders, file by file."""
    kinds: dict[str, tuple[Callable[..., Any], Callable[..., Iterator[str]]]]
    kinds = {".json": (json.loads, of_data), ".csv": (columns, of_columns)}
    files = [
        {p.relative_to(f): p for p in sorted(f.rglob("*")) if p.suffix in kinds} for f in (before, after)
    ]
    for name in {**files[0], **files[1]}:
        if name not in files[0] or name not in files[1]:
            yield f"{name}: {'gone' if name in files[0] else 'new'}"
            continue
        read, compare = kinds[name.suffix]
        for line in compare(*(read(found[name].read_text("utf-8")) for found in files), beyond):
            yield f"{name}: {line}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--beyond", type=float, default=1e-9, help="of a value (default 1e-9)")
    options = parser.parse_args()
    lines = list(differences(options.before, options.after, options.beyond))
    verdicts = [line for line in lines if "/passed:" in line or "/verdict:" in line or "/outcome:" in line]
    print("\n".join([*verdicts, *(line for line in lines if line not in verdicts)]))
    print(f"{len(lines)} differences, {len(verdicts)} of verdicts")
    sys.exit(1 if lines else 0)
