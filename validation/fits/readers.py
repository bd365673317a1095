"""Files of curves: tables of text, formats of microscopes, archives of either; which curve, which segment.

Formats of microscopes are read by ``afmformats`` and ``igor2`` (extra ``fit``), in SI units. In their files a
height grows away from the sample; here positions grow into it. JPK: all segments, whatever their number.
Asylum: all channels in one wave, or one channel a file. Nanoscope by ``pyfmreader``, where it is installed;
there retractions are stored from far to near.
"""

from __future__ import annotations

import logging
import re
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import Whole, a_string
from validation.fits.record import KINDS, Given, MeasuredCurve, missing
from validation.fits.tables import LARGEST_FILE, read_table_curve

WORKSHOP = b"Force-Distance Curve"
"""Begins a .csv of AFM Workshop."""
WRITTEN = {".h5": "hdf5", ".tab": "tab"}
"""Formats that can be written, by their ending."""
KNOWN = (*WRITTEN, ".ibw", ".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series", ".spm")
"""Endings that are no tables."""
STAGE, PIEZO, TIP = "height (measured)", "height (piezo)", "tip position"
MOTIONS = {"extend": "approach", "pause": "pause", "retract": "retract"}
"""Kinds of segments as JPK calls them."""
SLOWEST = 2.0
"""Rows a second of a stated rate, at least: some files state the rate of curves there, about one a second."""
for _reader in ("afmformats", "igor2"):  # whole buffers are logged: not to a terminal unasked
    logging.getLogger(_reader).addHandler(logging.NullHandler())
_UNITS = {"time": "s", "force": "N", STAGE: "m", PIEZO: "m", TIP: "m"}


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
        curves = read_instrument(path, given)
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
            if sum(one.file_size for one in archive.infolist()) > LARGEST_FILE:
                raise SceneError("", f"unpacks to more than {LARGEST_FILE // 10**6} MB", "less", str(path))
            archive.extractall(folder)
            inside = (one for one in sorted(Path(folder).rglob("*")) if "__MACOSX" not in one.parts)
            for file in filter(Path.is_file, inside):
                try:
                    curves += read_file(file, given, si=True)
                except SceneError as error:
                    raise replace(error, file=f"{path}/{file.name}") from None
    except zipfile.BadZipFile as error:
        reason = f"cannot be read: BadZipFile {error}"
        raise SceneError("", reason, "an archive of curves", str(path)) from None
    return curves


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


def read_instrument(path: Path, given: Given) -> list[MeasuredCurve]:
    """All curves of a file, by its ending."""
    ending = path.suffix.lower()
    with _in_one_line(path):
        if is_nanoscope(path):
            return read_nanoscope(path, given)
        if ending == ".ibw":
            return read_asylum(path, given)
        return read_jpk(path, given) if ending.startswith(".jpk") else read_afmformats(path, given)


def is_nanoscope(path: Path) -> bool:
    """Whether the ending is one of Bruker's: ``.spm``, ``.000``."""
    return bool(re.fullmatch(r"\.(spm|\d{3})", path.suffix.lower()))


def read_afmformats(path: Path, given: Given) -> list[MeasuredCurve]:
    """Curves by the readers of ``afmformats``: its own formats, AFM Workshop, NT-MDT."""
    import afmformats

    ending, curves = path.suffix.lower(), []
    if ending == ".h5":
        _check_hdf5(path)
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        # Endings in capitals are unknown to it.
        plain = path if path.suffix == ending else copyfile(path, Path(folder) / f"{path.stem}{ending}")
        records = afmformats.load_data(plain, meta_override=given.overrides())
        if ending == ".tab":
            _check_rows(path)
        for name, record in zip(_names(path, len(records)), records, strict=True):
            stated, held = dict(record.metadata), record.columns
            columns = {key: record[key] for key in ("time", "force") if key in held}
            heights = [record[height] for height in (STAGE, PIEZO) if height in held]
            stiffness = given.spring_constant or stated.get("spring constant", np.nan)
            if heights and stiffness > 0.0:
                columns["stage"] = -heights[0]
            elif TIP in held:
                columns["penetration"], stiffness = -record[TIP], None
            elif heights:
                raise missing(["spring constant"], path)
            if "force" not in columns or len(columns) < 2:
                allowed = f"force, and {STAGE} or {TIP}"
                raise SceneError("", f"{name} has columns {', '.join(held)}", allowed, str(path))
            rate = stated.get("rate approach", np.nan)
            numbers = np.asarray(record["segment"]).astype(int) if "segment" in held else None
            rate = rate if rate > SLOWEST else None
            curves.append(given.curve(path, name, columns, stiffness, numbers, rate))
    return curves


def read_jpk(path: Path, given: Given) -> list[MeasuredCurve]:
    """JPK: ``afmformats`` knows records of two or three segments, its reader of the archive any."""
    from afmformats.formats.fmt_jpk.jpk_reader import JPKReader

    file = _any_segments(JPKReader)(path)
    file.set_metadata(given.overrides())
    curves = []
    for n, name in enumerate(_names(path, len(file))):
        spring, kinds = given.spring(file.get_metadata(n).get("spring constant"), path), []
        for k in file.get_index_segment_numbers(n):
            kind = MOTIONS[file.get_metadata_jpk_secondary(n, k)["curve type"]]
            kinds += [kind] * file.get_metadata(n, k)["point count"]
        try:
            height = file.get_data(STAGE, n)
        except (KeyError, ValueError, LookupError):
            height = file.get_data(PIEZO, n)
        columns = {"time": file.get_data("time", n), "stage": -height, "force": file.get_data("force", n)}
        curves.append(given.curve(path, name, columns, spring, file.get_data("segment", n), kinds=kinds))
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
    from igor2.binarywave import load

    wave = load(path)["wave"]
    lines = re.split(r"[\r\n]+", wave["note"].decode("latin-1"))
    note = {key: value.strip() for key, _, value in (line.partition(":") for line in lines)}
    if wave["wData"].ndim == 2:
        labels = [label.decode() for label in wave["labels"][1] if label]
        channels = dict(zip(labels, wave["wData"].T.astype(float), strict=True))
    else:
        stem, channels = re.sub(r"(Defl|ZSnsr|Raw)$", "", path.stem), {}
        for channel in ("Defl", "ZSnsr", "Raw"):
            beside = path.with_name(f"{stem}{channel}{path.suffix}")
            if beside.exists():
                channels[channel] = load(beside)["wave"]["wData"].astype(float)
    places = [key for key in ("ZSnsr", "Raw") if key in channels]
    if "Defl" not in channels or not places:
        allowed = "the channels Defl and ZSnsr, here or beside"
        raise SceneError("", f"holds {', '.join(channels)}", allowed, str(path))
    stage, deflection = channels[places[0]], channels["Defl"]
    if given.sensitivity is not None:
        slope = _stated(note, "InvOLS")
        if not slope:
            raise SceneError("", "states no InvOLS", "no --sensitivity with it", str(path))
        deflection = deflection * given.sensitivity / slope
    spring = given.spring(_stated(note, "SpringConstant"), path)
    begins = [int(float(row)) for row in note.get("Indexes", "").split(",") if row.strip()]
    numbers = np.searchsorted(begins[1:-1], np.arange(stage.size), side="right")
    columns = {"stage": stage, "force": spring * deflection}
    return [given.curve(path, path.stem, columns, spring, numbers, _stated(note, "NumPtsPerSec"))]


def _stated(note: Mapping[str, str], key: str) -> float | None:
    """A number of the note of a wave."""
    found = re.match(r"[-+]?[\d.]+(e[-+]?\d+)?", note.get(key, ""), re.IGNORECASE)
    return float(found[0]) if found else None


def read_nanoscope(path: Path, given: Given) -> list[MeasuredCurve]:
    """Single ramps of Bruker; force volumes of 4-byte data come out wrong by powers of ten."""
    import pyfmreader

    file = pyfmreader.loadfile(str(path))
    stated = file.filemetadata
    spring = given.spring(stated["spring_const_Nbym"], path)
    slope = given.sensitivity or 1e-9 * stated["defl_sens_nmbyV"]
    parts: list[tuple[Any, ...]] = []  # number of the segment, time, stage, deflection
    begin = 0.0
    for n, (_, segment) in enumerate(file.getcurve(0).get_segments()):
        time, height, volts = (
            np.asarray(segment.segment_formated_data[key], float) for key in ("time", "height", "vDeflection")
        )
        if parts and abs(volts[-1] - parts[-1][3][-1]) < abs(volts[0] - parts[-1][3][-1]):
            height, volts = height[::-1], volts[::-1]
        step = float(np.median(np.diff(time)))
        parts.append((np.full(height.size, n), begin + step * np.arange(height.size), height, volts))
        begin += step * height.size
    numbers, time, height, volts = map(np.concatenate, zip(*parts, strict=True))
    columns = {"time": time, "stage": height, "force": volts * slope * spring}
    return [given.curve(path, path.stem, columns, spring, numbers)]


def write_afm(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve so that afmformats, and what is built on it, reads it."""
    if path.suffix.lower() not in WRITTEN:
        raise SceneError("path", f"cannot write {path.suffix}", ", ".join((".csv", *WRITTEN)))
    with _in_one_line(path):
        import afmformats
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
    record = afmformats.AFMForceDistance(columns, metadata)
    keys = [key for key in metadata if key != "path"]
    record.export_data(path, metadata=keys, fmt=WRITTEN[path.suffix.lower()])


def _names(path: Path, count: int) -> list[str]:
    """Names of the curves of a file."""
    return [path.stem] if count == 1 else [f"{path.stem}-{number}" for number in range(count)]


def _check_hdf5(path: Path) -> None:
    """Columns must hold real numbers, in the unit that they are read in where they state one."""
    import h5py

    if not h5py.is_hdf5(path):
        return
    with h5py.File(path, "r") as file:
        columns = [(name, curve[name]) for curve in file.values() for name in _UNITS.keys() & set(curve)]
        for name, column in columns:
            unit, key = column.attrs.get("unit", ""), column.name.lstrip("/")
            unit = (unit.decode() if isinstance(unit, bytes) else str(unit)).strip()
            if column.dtype.kind not in "iuf":
                raise SceneError(key, f"holds {column.dtype}", "real numbers", str(path))
            if unit not in ("", _UNITS[name]):
                raise SceneError(key, f"is in {unit}", f"{_UNITS[name]}: nothing is converted", str(path))


def _check_rows(path: Path) -> None:
    """Rows must be as many as stated, and as long as the header: cells that are missing are read as 0."""
    lines = path.read_text("utf-8", "replace").splitlines(keepends=True)
    stated = re.search(r'"point count": (\d+)', "".join(line for line in lines if line.startswith("#")))
    rows = [line for line in lines if not line.startswith("#") and line.strip()]
    whole = sum(row.count("\t") == rows[0].count("\t") for row in rows)
    points = int(stated[1]) if stated else len(rows)
    if not whole == points == len(rows):
        raise SceneError("", f"holds {whole} whole rows of {points}", "a file that is not cut off", str(path))


class UnknownFormat(SceneError):
    """A file that no reader takes for its own."""


@contextmanager
def _in_one_line(path: Path) -> Iterator[None]:
    """What the readers of foreign files raise as one line, without their warnings."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except ImportError as error:
        hint = "pyfmreader" if error.name == "pyfmreader" else "'crosscontact[fit]'"
        raise ImportError(f"{error.name} is not installed: pip install {hint}") from None
    except (SceneError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # those of afmformats are not all derived from Exception
        kind, ending = type(error).__name__, path.suffix.lower()
        if kind == "MissingMetaDataError":
            raise missing(sorted(getattr(error, "meta_keys", ()), reverse=True), path) from None
        if kind == "FileFormatNotSupportedError" or (ending.startswith(".jpk") and "zip" in str(error)):
            problem = "is damaged, or in no format that afmformats knows"
            allowed = f"a {ending} of a force microscope; a table is a .csv or a .txt"
            raise UnknownFormat("", problem, allowed, str(path)) from None
        problem = f"cannot be read: {kind} {error}"
        raise SceneError("", problem, "a file of afmformats", str(path)) from None
