"""Files of curves: tables of text, formats of microscopes, archives of either; which curve, which segment."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import Whole, a_string, finite, positive
from validation.fits.curve_tables import KINDS, LARGEST_FILE, read_table_curve
from validation.fits.instruments import KNOWN, UnknownFormat, is_nanoscope, read_instrument
from validation.fits.reading import Given
from validation.fits.record import KINDS as MOTIONS
from validation.fits.record import MeasuredCurve

WORKSHOP = b"Force-Distance Curve"
"""Begins a .csv of AFM Workshop."""
_COLUMNS = "HOLDS=COLUMN[:FACTOR], ...: COLUMN by name or by number from 1, HOLDS one of " + ", ".join(KINDS)
_SEGMENT = f"{', '.join(MOTIONS)}, or I:J, segments I to J - 1, counted from 0"


def given_of(
    spring_constant: Any = None,
    sensitivity: Any = None,
    sampling_rate: Any = None,
    speed: Any = None,
    columns: Any = None,
) -> Given:
    """What a user states about a file, checked."""
    stated = {
        "spring_constant": spring_constant,
        "sensitivity": sensitivity,
        "sampling_rate": sampling_rate,
        "speed": speed,
    }
    numbers = {key: None if value is None else positive(value, key) for key, value in stated.items()}
    return Given(**numbers, columns=_columns(columns))


def _columns(asked: Any) -> dict[str, tuple[str | int, float]]:
    """``"time=3,stage=1:1e-6"``, or the same as a mapping, whose values are columns or (column, factor)."""
    if isinstance(asked, str):
        parts = (part.partition("=") for part in asked.split(","))
        asked = {key.strip(): tuple(value.strip().rsplit(":", 1)) for key, _, value in parts}
    if asked is not None and not isinstance(asked, Mapping):
        raise SceneError("columns", f"got {shown(asked)}", _COLUMNS)
    found: dict[str, tuple[str | int, float]] = {}
    for key, value in (asked or {}).items():
        column, factor = (value, 1.0) if not isinstance(value, tuple) else (*value, 1.0)[:2]
        if key not in KINDS or not isinstance(column, (int, str)) or isinstance(column, bool) or column == "":
            raise SceneError("columns", f"got {shown(key)}: {shown(value)}", _COLUMNS)
        number = int(column) if isinstance(column, str) and column.isdigit() else column
        try:
            found[key] = number, finite(float(factor), "columns")
        except (TypeError, ValueError):
            raise SceneError("columns", f"got the factor {shown(factor)}", "a number") from None
    return found


def read_file(path: Path, given: Given | None = None, si: bool = False) -> list[MeasuredCurve]:
    """All curves of a file; ``si``: units that a table states are converted.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, or which option states what the file does not.
    ImportError
        If the package that reads such files is not installed.
    """
    given = given or Given()
    _require_content(path)
    ending = path.suffix.lower()
    if given.columns:
        return [read_table_curve(path, given, si)]
    if ending == ".zip":
        return _read_archive(path, given)
    if ending in KNOWN or is_nanoscope(path):
        curves = _read_named(path, given)
    else:
        try:
            return [read_table_curve(path, given, si)]
        except SceneError as error:
            if ending != ".txt" and not path.read_bytes()[:99].startswith(WORKSHOP):
                raise
            try:
                curves = read_instrument(path, given)
            except UnknownFormat:
                raise error from None
    if not curves:
        raise SceneError("", "holds no curve", "a file of force-distance curves", str(path))
    return curves


def choose(curves: list[MeasuredCurve], enum: Any, segment: Any, file: Path) -> list[MeasuredCurve]:
    """The curve of a number, or all; of each the rows of a segment, or all."""
    if enum is not None:
        number = Whole(f"a number from 0 to {len(curves) - 1}", 0, len(curves) - 1)(enum, "enum")
        curves = [curves[number]]
    return curves if segment is None else [_segment_of(curve, segment, file) for curve in curves]


def _segment_of(curve: MeasuredCurve, segment: Any, file: Path) -> MeasuredCurve:
    """The longest segment of a kind, or the segments I to J - 1."""
    a_string(segment, "segment")
    numbers = re.fullmatch(r"(\d*):(\d*)", segment)
    if numbers:
        begin, end = (int(n) if n else None for n in numbers.groups())
        chosen = curve.segments[begin:end]
    elif segment in MOTIONS:
        chosen = sorted(
            (one for one in curve.segments if one.kind == segment), key=lambda one: one.first - one.last
        )[:1]
    else:
        raise SceneError("segment", f"got {shown(segment)}", _SEGMENT)
    if not chosen:
        held = ", ".join(f"{n} {one.kind}" for n, one in enumerate(curve.segments))
        raise SceneError("segment", f"{curve.name} has no {segment}", f"of {held}", str(file))
    return curve.between(chosen[0].first, chosen[-1].last)


def _read_archive(path: Path, given: Given) -> list[MeasuredCurve]:
    """All curves of the files in an archive, whatever their format."""
    curves = []
    try:
        with zipfile.ZipFile(path) as archive, TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            inside = [
                one for one in archive.infolist() if not one.is_dir() and "__MACOSX" not in one.filename
            ]
            if sum(one.file_size for one in inside) > LARGEST_FILE:
                raise SceneError("", f"unpacks to more than {LARGEST_FILE // 10**6} MB", "less", str(path))
            for one in sorted(inside, key=lambda one: one.filename):
                name = Path(folder) / Path(one.filename).name
                name.write_bytes(archive.read(one))
                try:
                    curves += read_file(name, given, si=True)
                except SceneError as error:
                    raise SceneError(error.key, error.problem, error.allowed, f"{path}/{name.name}") from None
    except zipfile.BadZipFile as error:
        reason = f"cannot be read: BadZipFile {error}"
        raise SceneError("", reason, "an archive of curves", str(path)) from None
    return curves


def _read_named(path: Path, given: Given) -> list[MeasuredCurve]:
    """By a name whose ending ``afmformats``, which tells A from a, knows."""
    if path.suffix == path.suffix.lower():
        return read_instrument(path, given)
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        name = Path(folder) / f"{path.stem}{path.suffix.lower()}"
        copyfile(path, name)
        try:
            return read_instrument(name, given)
        except SceneError as error:
            raise type(error)(error.key, error.problem, error.allowed, str(path)) from None


def _require_content(path: Path) -> None:
    """Refuse what is no regular file, cannot be opened, or holds nothing."""
    try:
        if path.exists() and not path.is_file():  # never wait on a pipe
            problem = "is a folder" if path.is_dir() else "is not a regular file"
        else:
            with path.open("rb") as stream:
                problem = "" if stream.read(1) else "the file is empty"
    except (OSError, ValueError) as error:
        problem = f"cannot be read: {getattr(error, 'strerror', None) or error}"
    if problem:
        raise SceneError("", problem, "an existing, readable file of curves", str(path))
