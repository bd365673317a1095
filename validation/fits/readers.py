"""Files of curves: tables of text, formats of microscopes, archives of either; which curve, which segment."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import Whole, a_string
from validation.fits.given import Given
from validation.fits.instruments import KNOWN, UnknownFormat, is_nanoscope, read_instrument
from validation.fits.record import KINDS, MeasuredCurve
from validation.fits.tables import LARGEST_FILE, read_table_curve

WORKSHOP = b"Force-Distance Curve"
"""Begins a .csv of AFM Workshop."""


def read_file(path: Path, given: Given | None = None, si: bool = False) -> list[MeasuredCurve]:
    """All curves of a file; ``si``: units that a table states are converted."""
    given = given or Given()
    _require_content(path)
    ending = path.suffix.lower()
    if ending == ".zip" and not given.columns:
        return _read_archive(path, given)
    if given.columns or not (ending in KNOWN or is_nanoscope(path)):
        try:
            return [read_table_curve(path, given, si)]
        except SceneError as error:
            if given.columns or (ending != ".txt" and not path.read_bytes()[:99].startswith(WORKSHOP)):
                raise
            try:
                curves = read_instrument(path, given)
            except UnknownFormat:
                raise error from None
    else:
        curves = _read_named(path, given)
    if not curves:
        raise SceneError("", "holds no curve", "a file of force-distance curves", str(path))
    return curves


def choose(curves: list[MeasuredCurve], enum: Any, segment: Any, file: Path) -> list[MeasuredCurve]:
    """The curve of a number, or all; of each the rows of a segment, or all."""
    if enum is not None:
        last = len(curves) - 1
        curves = [curves[Whole(f"a number from 0 to {last}", 0, last)(enum, "enum")]]
    return curves if segment is None else [_segment_of(curve, segment, file) for curve in curves]


def _segment_of(curve: MeasuredCurve, segment: Any, file: Path) -> MeasuredCurve:
    """The longest segment of a kind, or the segments I to J - 1."""
    a_string(segment, "segment")
    numbers = re.fullmatch(r"(\d*):(\d*)", segment)
    if numbers:
        begin, end = (int(n) if n else None for n in numbers.groups())
        chosen = curve.segments[begin:end]
    elif segment in KINDS:
        of_kind = [one for one in curve.segments if one.kind == segment]
        chosen = sorted(of_kind, key=lambda one: one.first - one.last)[:1]
    else:
        allowed = f"{', '.join(KINDS)}, or I:J, segments I to J - 1, counted from 0"
        raise SceneError("segment", f"got {shown(segment)}", allowed)
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
