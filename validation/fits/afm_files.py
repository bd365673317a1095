"""Curves in the formats of force microscopes, by ``afmformats`` (extra ``fit``), in SI units.

There a height grows away from the sample, and the height of the tip is that of the stage plus the deflection
``force/k``; here positions grow into the sample. A file with a spring constant gives the stage, one without
the tip. A file may hold many curves.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from contact_scene.errors import SceneError
from validation.fits.afm_columns import STAGE, TIP, check_columns
from validation.fits.afm_package import UnknownFormat, afmformats, errors_in_one_line
from validation.fits.curve_files import read_csv
from validation.fits.record import MeasuredCurve

WRITTEN = {".h5": "hdf5", ".tab": "tab"}
"""Formats that can be written, by their ending."""
READ = (".h5", ".ibw", ".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".tab", ".txt", ".zip")
"""Endings that are left to ``afmformats``; all others are CSV."""
TEXT = ".txt"
"""The one of them that tables have as well."""


def read_file(path: Path) -> list[MeasuredCurve]:
    """All curves of a file, CSV or of a microscope.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong.
    ImportError
        If the file is left to ``afmformats``, which is not installed.
    """
    if path.suffix.lower() != TEXT:
        return read_afm(path) if is_afm_file(path) else [read_csv(path)]
    try:
        return [read_csv(path)]
    except SceneError as error:
        with suppress(UnknownFormat):
            return read_afm(path)
        raise error from None


def is_afm_file(path: Path) -> bool:
    """Whether the ending is one of a microscope's formats."""
    return path.suffix.lower() in READ


def read_afm(path: Path) -> list[MeasuredCurve]:
    """All curves of a file.

    Raises
    ------
    SceneError
        One line, if it cannot be read or a curve lacks time, force or position.
    ImportError
        If ``afmformats`` is not installed.
    """
    package = afmformats()
    _require_content(path)
    with _lower_case_ending(path) as opened, errors_in_one_line(package, path):
        check_columns(opened)
        records = package.load_data(opened)
        names = [path.stem] if len(records) == 1 else [f"{path.stem}-{n}" for n in range(len(records))]
        # Within the block: columns are read from the file when they are asked for.
        curves = [_curve(record, name, str(path)) for record, name in zip(records, names, strict=True)]
    if not curves:
        raise SceneError("", "holds no curve", "a file of force-distance curves", str(path))
    return curves


def write_afm(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve so that afmformats, and what is built on it, reads it.

    Raises
    ------
    SceneError
        If the ending is none of those that can be written.
    """
    package = afmformats()
    if path.suffix.lower() not in WRITTEN:
        raise SceneError("path", f"cannot write {path.suffix}", ", ".join((".csv", *WRITTEN)))
    columns = {
        "time": curve.time,
        "force": curve.force,
        TIP: -curve.motion,
        "segment": (np.arange(curve.time.size) > int(np.argmax(curve.motion))).astype(np.uint8),
    }
    metadata: dict[str, Any] = {
        "imaging mode": "force-distance",
        "path": path,
        "enum": 0,
        "point count": curve.time.size,
        "duration": float(curve.time[-1] - curve.time[0]),
        "software": "crosscontact",
        "software version": "0",
    }
    if curve.stage is not None:
        columns[STAGE] = -curve.stage
        metadata["spring constant"] = curve.stiffness
    record = package.AFMForceDistance(columns, metadata)
    record.export_data(
        path, metadata=[key for key in metadata if key != "path"], fmt=WRITTEN[path.suffix.lower()]
    )


def _curve(record: Any, name: str, file: str) -> MeasuredCurve:
    for needed in ("time", "force"):
        if needed not in record.columns:
            raise SceneError("", f"{name} has no column {needed}", "time, force and a height", file)
    stiffness = dict(record.metadata).get("spring constant", np.nan)
    known: dict[str, Any] = {
        "time": np.asarray(record["time"], float),
        "force": np.asarray(record["force"], float),
    }
    if STAGE in record.columns and np.isfinite(stiffness):
        known |= {"stage": -np.asarray(record[STAGE], float), "stiffness": float(stiffness)}
    elif TIP in record.columns:
        known["penetration"] = -np.asarray(record[TIP], float)
    else:
        allowed = f"{STAGE} with a spring constant, or {TIP}"
        raise SceneError("", f"{name} has no position of the tip", allowed, file)
    try:
        return MeasuredCurve(**known, name=name)
    except SceneError as error:
        raise error.in_file(file) from None


@contextmanager
def _lower_case_ending(path: Path) -> Iterator[Path]:
    """The file by a name whose ending ``afmformats``, which tells A from a, knows."""
    if path.suffix == path.suffix.lower():
        yield path
        return
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        name = Path(folder) / f"{path.stem}{path.suffix.lower()}"
        try:
            name.symlink_to(path.resolve())
        except OSError:  # on Windows links take a privilege
            copyfile(path, name)
        yield name


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
