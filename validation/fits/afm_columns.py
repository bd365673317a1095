"""Columns in the formats of ``afmformats`` itself, which takes them as they are: SI units, whole rows."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError

STAGE, TIP = "height (measured)", "tip position"
_UNITS = {"time": "s", "force": "N", STAGE: "m", TIP: "m"}
_POINTS = re.compile(r'"point count": (\d+)')


def check_columns(path: Path) -> None:
    """Refuse a file of such a format (.h5, .tab) whose columns are not what they are taken for.

    Raises
    ------
    SceneError
        One line: which column or line.
    """
    if path.suffix == ".h5":
        _check_hdf5(path)
    elif path.suffix == ".tab":
        _check_rows(path)


def _check_hdf5(path: Path) -> None:
    """Columns must hold real numbers, in the unit that they are read in where they state one."""
    package: Any = import_module("h5py")
    if not package.is_hdf5(path):
        return
    with package.File(path, "r") as file:
        curves = [group for group in file.values() if isinstance(group, package.Group)]
        for column, taken_as in ((c[name], si) for c in curves for name, si in _UNITS.items() if name in c):
            key = column.name.lstrip("/")
            if column.dtype.kind not in "iuf":
                raise SceneError(key, f"holds {column.dtype}", "real numbers", str(path))
            unit = column.attrs.get("unit", "")
            unit = (unit.decode() if isinstance(unit, bytes) else str(unit)).strip()
            if unit not in ("", taken_as):
                raise SceneError(key, f"is in {unit}", f"{taken_as}: nothing is converted", str(path))


def _check_rows(path: Path) -> None:
    """Rows must be as long as the header: missing cells are read as 0."""
    header, points, rows = "", 0, 0
    with path.open(encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            if line.startswith("#"):
                header = line if rows == 0 else header
                stated = _POINTS.search(line)
                points = int(stated[1]) if stated else points
            elif line.strip() and header:
                rows += 1
                cells, width = line.strip().count("\t") + 1, header.count("\t") + 1
                if not line.endswith("\n") and rows < points:
                    problem = f"ends within row {rows} of {points}"
                    raise SceneError(f"line {number}", problem, "a file that is not cut off", str(path))
                if cells != width:
                    allowed = f"{width}, separated by tabs, as in the header"
                    raise SceneError(f"line {number}", f"{cells} cells", allowed, str(path))
