"""Curves in the formats of force microscopes, in SI units, by ``afmformats`` and ``igor2`` (extra ``fit``).

In their files a height grows away from the sample; here positions grow into it. JPK: all segments, whatever
their number. Asylum: all channels in one wave, or one channel a file. Nanoscope by ``pyfmreader``, where it
is installed; there retractions are stored from far to near.
"""

from __future__ import annotations

import logging
import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene.errors import SceneError
from validation.fits.reading import Given, missing
from validation.fits.record import MeasuredCurve

WRITTEN = {".h5": "hdf5", ".tab": "tab"}
"""Formats that can be written, by their ending."""
KNOWN = (*WRITTEN, ".ibw", ".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series", ".spm")
"""Endings that are no tables."""
STAGE, TIP = "height (measured)", "tip position"
MOTIONS = {"extend": "approach", "pause": "pause", "retract": "retract"}
"""Kinds of segments as JPK calls them."""
SLOWEST = 2.0
"""Rows a second of a stated rate, at least: some files state the rate of curves there, about one a second."""
_UNITS = {"time": "s", "force": "N", STAGE: "m", "height (piezo)": "m", TIP: "m"}


_PACKAGES: dict[str, Callable[[], Any]] = {
    "afmformats": lambda: import_module("afmformats"),
    "afmformats.formats.fmt_jpk.jpk_reader": lambda: import_module("afmformats.formats.fmt_jpk.jpk_reader"),
    "igor2.binarywave": lambda: import_module("igor2.binarywave"),
    "h5py": lambda: import_module("h5py"),
    "pyfmreader": lambda: import_module("pyfmreader"),
}


def package(name: str) -> Any:
    """A package that reads files, or the line that it is not installed."""
    try:
        return _PACKAGES[name]()
    except ImportError:
        hint = "pyfmreader" if name == "pyfmreader" else "'crosscontact[fit]'"
        raise ImportError(f"{name} is not installed: pip install {hint}") from None


def read_instrument(path: Path, given: Given) -> list[MeasuredCurve]:
    """All curves of a file, by its ending."""
    ending = path.suffix.lower()
    reader = read_asylum if ending == ".ibw" else read_jpk if ending.startswith(".jpk") else read_afmformats
    if is_nanoscope(path):
        reader = read_nanoscope
    with _in_one_line(path):
        return reader(path, given)


def is_nanoscope(path: Path) -> bool:
    """Whether the ending is one of Bruker's: ``.spm``, ``.000``."""
    return bool(re.fullmatch(r"\.(spm|\d{3})", path.suffix.lower()))


def read_afmformats(path: Path, given: Given) -> list[MeasuredCurve]:
    """Curves by the readers of ``afmformats``: its own formats, AFM Workshop, NT-MDT."""
    if path.suffix == ".h5":
        _check_hdf5(path)
    records = package("afmformats").load_data(path, meta_override=given.overrides())
    if path.suffix == ".tab":
        _check_rows(path)
    return [
        _afmformats_curve(path, one, _name(path, n, len(records)), given) for n, one in enumerate(records)
    ]


def _afmformats_curve(path: Path, record: Any, name: str, given: Given) -> MeasuredCurve:
    stated = dict(record.metadata)
    heights = [height for height in (STAGE, "height (piezo)") if height in record.columns]
    columns = {key: record[key] for key in ("time", "force") if key in record.columns}
    stiffness = given.spring_constant or stated.get("spring constant", np.nan)
    if heights and stiffness > 0.0:
        columns["stage"] = -record[heights[0]]
    elif TIP in record.columns:
        columns["penetration"], stiffness = -record[TIP], None
    elif heights:
        raise missing(["spring constant"], path)
    if "force" not in columns or len(columns) < 2:
        allowed = f"force, and {STAGE} or {TIP}"
        raise SceneError("", f"{name} has columns {', '.join(record.columns)}", allowed, str(path))
    rate = stated.get("rate approach", np.nan)
    numbers = np.asarray(record["segment"]).astype(int) if "segment" in record.columns else None
    return given.curve(path, name, columns, stiffness, numbers, rate if rate > SLOWEST else None)


def read_jpk(path: Path, given: Given) -> list[MeasuredCurve]:
    """JPK: ``afmformats`` knows records of two or three segments, its reader of the archive any."""
    file = _any_segments(package("afmformats.formats.fmt_jpk.jpk_reader").JPKReader)(path)
    file.set_metadata(given.overrides())
    curves = []
    for n in range(len(file)):
        spring, segments = given.spring(file.get_metadata(n).get("spring constant"), path), []
        for k in file.get_index_segment_numbers(n):
            kind = MOTIONS[file.get_metadata_jpk_secondary(n, k)["curve type"]]
            segments += [kind] * file.get_metadata(n, k)["point count"]
        try:
            height = file.get_data(STAGE, n)
        except (KeyError, ValueError, LookupError):
            height = file.get_data("height (piezo)", n)
        columns = {"time": file.get_data("time", n), "stage": -height, "force": file.get_data("force", n)}
        numbers = file.get_data("segment", n)
        curves.append(given.curve(path, _name(path, n, len(file)), columns, spring, numbers, kinds=segments))
    return curves


def _any_segments(reader: Any) -> Any:
    """The reader of an archive for records of any number of segments, modulated ones taken for pauses."""

    class AnySegments(reader):
        def get_imaging_mode(self) -> str:
            return "force-distance"

        def get_metadata_jpk_secondary(self, index: int, segment: int | None = None) -> Any:
            found = super().get_metadata_jpk_secondary(index=index, segment=segment)
            if found.get("curve type") not in MOTIONS:
                found["curve type"] = "pause"
            return found

    return AnySegments


def read_asylum(path: Path, given: Given) -> list[MeasuredCurve]:
    """Igor binary waves; ``Indexes`` of the note are the rows at which segments begin."""
    load = package("igor2.binarywave").load
    wave = load(path)["wave"]
    lines = re.split(r"[\r\n]+", wave["note"].decode("latin-1"))
    note = {key: value.strip() for key, _, value in (line.partition(":") for line in lines)}
    if wave["wData"].ndim == 2:
        labels = [label.decode() for label in wave["labels"][1] if label]
        channels = dict(zip(labels, wave["wData"].T.astype(float), strict=True))
    else:
        stem = re.sub(r"(Defl|ZSnsr|Raw)$", "", path.stem)
        beside = {
            channel: path.with_name(f"{stem}{channel}{path.suffix}") for channel in ("Defl", "ZSnsr", "Raw")
        }
        channels = {
            key: load(one)["wave"]["wData"].astype(float) for key, one in beside.items() if one.exists()
        }
    places = [key for key in ("ZSnsr", "Raw") if key in channels]
    if "Defl" not in channels or not places:
        raise SceneError(
            "", f"holds {', '.join(channels)}", "the channels Defl and ZSnsr, here or beside", str(path)
        )
    stage, deflection = channels[places[0]], channels["Defl"]
    if given.sensitivity is not None:
        deflection = deflection * given.sensitivity / _number(note, "InvOLS", path)
    spring = given.spring(_stated(note, "SpringConstant"), path)
    begins = [int(float(row)) for row in note.get("Indexes", "").split(",") if row.strip()]
    numbers = np.searchsorted(begins[1:-1], np.arange(stage.size), side="right")
    columns = {"stage": stage, "force": spring * deflection}
    return [given.curve(path, path.stem, columns, spring, numbers, _stated(note, "NumPtsPerSec"))]


def _stated(note: dict[str, str], key: str) -> float | None:
    found = re.match(r"[-+]?[\d.]+(e[-+]?\d+)?", note.get(key, ""), re.IGNORECASE)
    return float(found[0]) if found else None


def _number(note: dict[str, str], key: str, path: Path) -> float:
    value = _stated(note, key)
    if not value:
        raise SceneError("", f"states no {key}", "no --sensitivity with it", str(path))
    return value


def read_nanoscope(path: Path, given: Given) -> list[MeasuredCurve]:
    """Single ramps of Bruker; force volumes of 4-byte data come out wrong by powers of ten."""
    file = package("pyfmreader").loadfile(str(path))
    stated = file.filemetadata
    spring = given.spring(stated["spring_const_Nbym"], path)
    slope = given.sensitivity or 1e-9 * stated["defl_sens_nmbyV"]
    columns: dict[str, list[Any]] = {"time": [], "stage": [], "force": []}
    numbers, begin, volts = [], 0.0, np.zeros(0)
    for n, (_, part) in enumerate(file.getcurve(0).get_segments()):
        data = {
            key: np.asarray(part.segment_formated_data[key], float)
            for key in ("time", "height", "vDeflection")
        }
        height, step = data["height"], float(np.median(np.diff(data["time"])))
        if n and abs(data["vDeflection"][-1] - volts[-1]) < abs(data["vDeflection"][0] - volts[-1]):
            height, data["vDeflection"] = height[::-1], data["vDeflection"][::-1]
        volts = data["vDeflection"]
        columns["time"].append(begin + step * np.arange(height.size))
        columns["stage"].append(height)
        columns["force"].append(volts * slope * spring)
        numbers.append(np.full(height.size, n))
        begin += step * height.size
    whole = {key: np.concatenate(parts) for key, parts in columns.items()}
    return [given.curve(path, path.stem, whole, spring, np.concatenate(numbers))]


def write_afm(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve so that afmformats, and what is built on it, reads it.

    Raises
    ------
    SceneError
        If the ending is none of those that can be written.
    """
    library = package("afmformats")
    if path.suffix.lower() not in WRITTEN:
        raise SceneError("path", f"cannot write {path.suffix}", ", ".join((".csv", *WRITTEN)))
    numbers = np.zeros(curve.time.size, np.uint8)
    for n, segment in enumerate(curve.segments):
        numbers[segment.rows] = n
    columns = {"time": curve.time, "force": curve.force, TIP: -curve.motion, "segment": numbers}
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
    record = library.AFMForceDistance(columns, metadata)
    keys = [key for key in metadata if key != "path"]
    record.export_data(path, metadata=keys, fmt=WRITTEN[path.suffix.lower()])


def _name(path: Path, number: int, count: int) -> str:
    return path.stem if count == 1 else f"{path.stem}-{number}"


def _check_hdf5(path: Path) -> None:
    """Columns must hold real numbers, in the unit that they are read in where they state one."""
    library = package("h5py")
    if not library.is_hdf5(path):
        return
    with library.File(path, "r") as file:
        curves = [group for group in file.values() if isinstance(group, library.Group)]
        for column, taken_as in ((c[name], si) for c in curves for name, si in _UNITS.items() if name in c):
            key = column.name.lstrip("/")
            if column.dtype.kind not in "iuf":
                raise SceneError(key, f"holds {column.dtype}", "real numbers", str(path))
            unit = column.attrs.get("unit", "")
            unit = (unit.decode() if isinstance(unit, bytes) else str(unit)).strip()
            if unit not in ("", taken_as):
                raise SceneError(key, f"is in {unit}", f"{taken_as}: nothing is converted", str(path))


def _check_rows(path: Path) -> None:
    """Rows must be as long as the header, and whole: missing cells are read as 0."""
    lines = path.read_text("utf-8", "replace").splitlines(keepends=True)
    first = next((n for n, line in enumerate(lines) if not line.startswith("#")), len(lines))
    stated = re.search(r'"point count": (\d+)', "".join(lines[:first]))
    points, width = int(stated[1]) if stated else 0, "".join(lines[first : first + 1]).count("\t") + 1
    for row, line in enumerate(lines[first:], 1):
        key, cells = f"line {first + row}", line.strip().count("\t") + 1
        if line.strip() and not line.endswith("\n") and row < points:
            raise SceneError(
                key, f"ends within row {row} of {points}", "a file that is not cut off", str(path)
            )
        if line.strip() and cells != width:
            allowed = f"{width}, separated by tabs, as in line {first + 1}"
            raise SceneError(key, f"{cells} cells", allowed, str(path))


class UnknownFormat(SceneError):
    """A file that no reader takes for its own."""


@contextmanager
def _in_one_line(path: Path) -> Iterator[None]:
    """What the readers of foreign files raise as one line; their warnings and logs stay off the terminal."""
    library = package("afmformats")
    own = library.errors.AFMFileFormatError, library.meta.MetaDataMissingError  # of BaseException
    try:
        with _logged_nowhere_else(), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except (SceneError, ImportError):
        raise
    except library.errors.MissingMetaDataError as error:
        raise missing(sorted(error.meta_keys, reverse=True), path) from None
    except (Exception, *own) as error:  # whatever a reader of foreign files may raise
        unknown = library.errors.FileFormatNotSupportedError
        if isinstance(error, unknown) or (path.suffix.startswith(".jpk") and "zip" in str(error)):
            problem = "is damaged, or in no format that afmformats knows"
            allowed = f"a {path.suffix} of a force microscope; a table is a .csv or a .txt"
            raise UnknownFormat("", problem, allowed, str(path)) from None
        reason = f"{type(error).__name__} {error}"
        raise SceneError("", f"cannot be read: {reason}", "a file of afmformats", str(path)) from None


@contextmanager
def _logged_nowhere_else() -> Iterator[None]:
    """Logs of foreign readers go only to handlers of their own, as of a file that its user asked for."""
    handler = logging.NullHandler()  # with none: stderr, whole buffers among it
    loggers = [logging.getLogger(name) for name in ("afmformats", "igor2")]
    propagated = [logger.propagate for logger in loggers]
    for logger in loggers:
        logger.propagate = False
        logger.addHandler(handler)
    try:
        yield
    finally:
        for logger, was in zip(loggers, propagated, strict=True):
            logger.removeHandler(handler)
            logger.propagate = was
