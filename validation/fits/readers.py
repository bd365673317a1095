"""Files of curves: tables of text, formats of microscopes, archives of either; which curve, which segment.

Formats of microscopes are read by ``afmformats`` and ``igor2`` (extra ``fit``), in SI units; Nanoscope by
``pyfmreader``, where it is installed. In their files a height grows away from the sample; here positions grow
into it. A table has a header, one row a sample, and comments that state what holds for the curve::

    # stiffness = 0.05
    # indenter_radius = 2.5e-6
    time,stage,force
    0.0,-1e-6,2e-12

It is one of :mod:`contact_scene.tables`: columns are found by name, and others are ignored. Besides, numbers
may have decimal commas where something else parts the cells, and columns may be named by hand. Units in
brackets are labels of the scene's own units, or are converted to SI; those of an instrument's columns always.
"""

from __future__ import annotations

import logging
import re
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked, Positive
from contact_scene.errors import SceneError, shown
from contact_scene.files import read_text, table_text, write_whole
from contact_scene.tables import PREFIXES, TextTable, bracketed, is_number, read_table, spelt
from contact_scene.value_checks import LARGEST, Range, Rule, Whole, a_string, finite
from validation.fits.contact import Array
from validation.fits.record import (
    COLUMNS,
    FEWEST_ROWS,
    KINDS,
    CurveSegment,
    MeasuredCurve,
    moved_segments,
)

INSTRUMENTS = ("deflection", "height", "piezo")
"""Columns that only instruments write: their units are what they measured in."""
HELD = (*COLUMNS, *INSTRUMENTS)
NUMBERS = ("stiffness", "indenter_radius", "noise")
"""What holds for a whole curve, if it is stated."""
WRITTEN = {".h5": "hdf5", ".tab": "tab"}
"""Formats that can be written, by their ending."""
WORKSHOP = b"Force-Distance Curve"
"""Begins a .csv of AFM Workshop."""
STAGE, PIEZO, TIP = "height (measured)", "height (piezo)", "tip position"
MOTIONS = {"extend": "approach", "pause": "pause", "retract": "retract"}
"""Kinds of segments as JPK calls them."""
SLOWEST = 2.0
"""Rows a second of a stated rate, at least: some files state the rate of curves there, about one a second."""
MOST_DROPPED = 0.05
"""Share of rows without numbers, or at whose time one has been recorded before, above which there is no
record: a clock that is read twice between two ticks doubles a few."""
LARGEST_FILE = 200_000_000
"""Bytes; a record of a few million rows, above which a file is no record of one curve."""
_WANTED = (
    "a header: time, penetration or stage, force and, if measured, contact_radius; or --columns "
    "time=1,stage=2:1e-9,force=3:1e-9"
)
_UNITS = {"time": "s", "force": "N", STAGE: "m", PIEZO: "m", TIP: "m"}
_POWERS = {prefix + base: power for prefix, power in PREFIXES.items() for base in ("m", "s", "N", "V")}
_OTHER = {"": 1.0, "min": 60.0, "h": 3600.0, "sec": 1.0, "Å": 1e-10, "A": 1e-10, "Angstrom": 1e-10}
_SPRING = r"(?<!\w)(?:spring[ _]?constant|stiffness|k)"
_RADIUS = r"(?<!\w)(?:(?:indenter|tip|bead|sphere)[ _]?radius)"
_NUMBER = r"[-+]?\d+(?:[.,]\d*)?(?:[eE][-+]?\d+)?"
for _reader in ("afmformats", "igor2"):  # whole buffers are logged: not to a terminal unasked
    logging.getLogger(_reader).addHandler(logging.NullHandler())


class _ByHand(Rule):
    """Column and factor by what a column holds."""

    def __call__(self, value: Any, key: str) -> dict[str, tuple[str | int, float]]:
        found: dict[str, tuple[str | int, float]] = {}
        try:
            if isinstance(value, str):
                parts = (part.partition("=") for part in value.split(","))
                value = {holds.strip(): tuple(at.strip().rsplit(":", 1)) for holds, _, at in parts}
            for holds, at in value.items():
                column, factor = (*at, 1.0)[:2] if isinstance(at, tuple) else (at, 1.0)
                if column == "" or type(column) not in (int, str):
                    raise ValueError
                column = int(column) if str(column).isdigit() else column
                found[HELD[HELD.index(holds)]] = column, finite(float(factor), holds)
        except (AttributeError, TypeError, ValueError):
            raise self.refused(key, f"got {shown(value)}") from None
        return found


BY_HAND = _ByHand(
    f"HOLDS=COLUMN[:FACTOR], ...: COLUMN by name or by number from 1, HOLDS one of {', '.join(HELD)}"
)


@dataclass(frozen=True)
class Given(Checked):
    """Stated by the user, in SI units: it goes before what the file says. ``columns`` of a table by what they
    hold: name or number (from 1), and a factor, ``"time=3,stage=1:1e-6"`` or a mapping."""

    spring_constant: Positive | None = None
    sensitivity: Positive | None = None
    sampling_rate: Positive | None = None
    speed: Positive | None = None
    columns: Annotated[Any, BY_HAND] | None = None

    def overrides(self) -> dict[str, float]:
        """The first two as ``afmformats`` takes them."""
        stated = {"spring constant": self.spring_constant, "sensitivity": self.sensitivity}
        return {key: value for key, value in stated.items() if value is not None}

    def spring(self, stated: Any, file: Path) -> float:
        """The spring constant, given or stated."""
        value = stated if self.spring_constant is None else self.spring_constant
        if value is None or not 0.0 < float(value) < LARGEST:
            raise _missing(["spring constant"], file)
        return float(value)

    def times(self, position: Array, rate: float | None, file: Path) -> Array:
        """Times of rows that have none: at the rate given, at the speed given, or at the rate stated."""
        rate = self.sampling_rate or (None if self.speed else rate)
        if rate:
            return np.asarray(np.arange(position.size) / rate)
        if self.speed is None:
            raise SceneError("", "states no times", "--sampling-rate or --speed with it", str(file))
        steps = np.abs(np.diff(position)) / self.speed
        return np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-9 * steps.max(initial=0.0)))])

    def curve(self, file: Path, name: str, recorded: Recorded) -> MeasuredCurve:
        """A curve of what is recorded; left out are rows without numbers or of a time told before."""
        kept = {key: np.asarray(column, float) for key, column in recorded.columns.items()}
        driven, more = "stage" if "stage" in kept else "penetration", dict(recorded.more)
        if "time" not in kept:
            kept["time"] = self.times(kept[driven], recorded.rate, file)
        good = np.all([np.abs(column) <= LARGEST for column in kept.values()], axis=0)
        latest = np.maximum.accumulate(np.where(good, kept["time"], -np.inf))
        good[1:] &= latest[1:] > latest[:-1]
        if good.size and good.mean() < 1.0 - MOST_DROPPED:
            problem = f"{int((~good).sum())} of {good.size} rows hold no numbers, or times that do not rise"
            raise SceneError("", problem, "a record row by row; are two columns swapped?", str(file))
        kept = {key: column[good] for key, column in kept.items()}
        if recorded.numbers is not None and good.any():
            told = [kind for kind, left in zip(recorded.kinds, good, strict=False) if left]
            more["segments"] = moved_segments(kept[driven], recorded.numbers[good], told)
        try:
            return MeasuredCurve(**(more | kept), stiffness=recorded.spring, name=name)
        except SceneError as error:
            raise replace(error, file=str(file)) from None


class Recorded(NamedTuple):
    """Columns as recorded, in SI units or those of a scene, and a spring constant; the number of the segment
    of each row and what the drive does there, and rows a second, if stated; ``more`` of the curve."""

    columns: Mapping[str, Array]
    spring: float | None
    numbers: NDArray[Any] | None = None
    rate: float | None = None
    kinds: Sequence[str] = ()
    more: Mapping[str, Any] = {}


def _missing(keys: list[str], file: Path) -> SceneError:
    """The error of a file that does not state something, with the options that do."""
    options = ", ".join(f"--{key.replace(' ', '-')}" for key in keys)
    return SceneError("", f"states no {' and no '.join(keys)}", f"{options} with it", str(file))


def read_file(path: Path, given: Given | None = None, si: bool = False) -> list[MeasuredCurve]:
    """All curves of a file; ``si``: units that a table states are converted."""
    given = given or Given()
    if path.is_dir():
        raise SceneError("", "is a folder", "an existing, readable file of curves", str(path))
    begin, ending = _begin(path), path.suffix.lower()
    if ending == ".zip" and not given.columns:
        return _read_archive(path, given)
    reader = _reader_of(ending)
    try:
        if reader is None or given.columns:
            return [given.curve(path, path.stem, _read_table(path, given, si))]
    except SceneError as error:
        if given.columns or (ending != ".txt" and begin != WORKSHOP):
            raise
        no_table = error
    try:
        with _in_one_line(path):
            records = (reader or _read_afmformats)(path, given)
            several = [f"{path.stem}-{number}" for number in range(len(records))]
            names = [path.stem] if len(records) == 1 else several
            curves = [given.curve(path, name, one) for name, one in zip(names, records, strict=True)]
    except UnknownFormat:
        if reader is None:
            raise no_table from None
        raise
    if not curves:
        raise SceneError("", "holds no curve", "a file of force-distance curves", str(path))
    return curves


def _reader_of(ending: str) -> Callable[[Path, Given], list[Recorded]] | None:
    """What reads the formats of an instrument that have an ending of their own."""
    if re.fullmatch(r"\.(spm|\d{3})", ending):
        return _read_nanoscope
    return READERS.get(ending)


def _begin(path: Path) -> bytes:
    """The first bytes of a regular file that is not empty."""
    try:
        if path.exists() and not path.is_file():  # never wait on a pipe
            raise ValueError("is not a regular file")
        with path.open("rb") as stream:
            begin = stream.read(len(WORKSHOP))
    except (OSError, ValueError) as error:
        reason = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        raise SceneError("", reason, "an existing, readable file of curves", str(path)) from None
    if not begin:
        raise SceneError("", "the file is empty", "a file of curves", str(path))
    return begin


def choose(curves: list[MeasuredCurve], enum: Any, segment: Any, file: Path) -> list[MeasuredCurve]:
    """The curve of a number, or all; of each all rows, or those of the longest segment of a kind, or of the
    segments I to J - 1."""
    if enum is not None:
        last = len(curves) - 1
        curves = [curves[Whole(f"a number from 0 to {last}", 0, last)(enum, "enum")]]
    if segment is None:
        return curves
    numbers, found = re.fullmatch(r"(\d*):(\d*)", a_string(segment, "segment")), []
    if not numbers and segment not in KINDS:
        allowed = f"{', '.join(KINDS)}, or I:J, segments I to J - 1, counted from 0"
        raise SceneError("segment", f"got {shown(segment)}", allowed)
    for curve in curves:
        of_kind = [one for one in curve.segments if one.kind == segment]
        chosen: Sequence[CurveSegment] = sorted(of_kind, key=lambda one: one.first - one.last)[:1]
        if numbers:
            chosen = curve.segments[slice(*(int(n) if n else None for n in numbers.groups()))]
        if not chosen:
            held = ", ".join(f"{n} {one.kind}" for n, one in enumerate(curve.segments))
            raise SceneError("segment", f"{curve.name} has no {segment}", f"of {held}", str(file))
        found.append(curve.between(chosen[0].first, chosen[-1].last))
    return found


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


# Tables


class _OrNone(Range):
    """Numbers as recorded, nan and infinity included: such rows are left out."""

    def __call__(self, value: Any, key: str) -> float:
        return float(value)

    def holds(self, value: Any) -> Any:
        return np.full(np.shape(value), True)


def _read_table(path: Path, given: Given, si: bool) -> Recorded:
    """One curve; ``si``: units in brackets are converted."""
    table = read_table(_plain(_text(path)), str(path), () if given.columns else HELD, _WANTED)
    si |= bool(given.columns) or not set(INSTRUMENTS).isdisjoint(table.kinds)
    if given.columns:
        places = {key: (_place(table, key, at), factor) for key, (at, factor) in given.columns.items()}
    elif not si:
        places = {kind: (at, 1.0) for kind, at in table.places(("time", "force")).items()}
    elif {"force", "deflection"} & set(table.kinds):
        numbered = reversed(list(enumerate(table.kinds)))
        places = {kind: (at, _in_si(table, at)) for at, kind in numbered if kind}
    else:
        raise table.unknown()
    rule = _OrNone("") if si else finite
    columns = {kind: factor * table.column(at, rule) for kind, (at, factor) in places.items()}
    stated: dict[str, Any] = {key: table.stated(key, finite) for key in (("noise",) if si else NUMBERS)}
    if si:
        head = "\n".join(line.content for line in table.head)
        stated |= {"stiffness": _stated_in_si(head, _SPRING), "indenter_radius": _stated_in_si(head, _RADIUS)}
    spring = given.spring_constant or stated.pop("stiffness")
    for instrument, sign in (("piezo", 1.0), ("height", -1.0)):
        if instrument in columns:
            columns.setdefault("stage", sign * columns[instrument])
    if "stage" in columns and "penetration" in columns and si:
        del columns["penetration" if spring else "stage"]
    if "deflection" in columns and "force" not in columns:
        volts = dict(zip(table.kinds, table.units, strict=True)).get("deflection", "").endswith("V")
        slope: Any = given.sensitivity or (None if volts else 1.0)
        if not (spring and slope):
            needed = {"spring constant": spring, "sensitivity": slope}
            raise _missing([key for key, value in needed.items() if not value], path)
        columns["force"] = columns["deflection"] * spring * slope
    stated.pop("stiffness", None)
    return Recorded({key: columns[key] for key in COLUMNS if key in columns}, spring, more=stated)


def _place(table: TextTable, holds: str, column: str | int) -> int:
    """Of a column that the user names by its number from 1, or its name in the header."""
    names = [name.replace("_", " ") for name in table.names]
    place = column - 1 if isinstance(column, int) else names.index(column) if column in names else -1
    if not 0 <= place < table.width:
        listed = ", ".join(f"{n} {name}".strip() for n, name in enumerate(names, 1))
        raise SceneError("columns", f"{holds} is to be column {column}", f"one of {listed}", table.file)
    return place


def _in_si(table: TextTable, place: int) -> float:
    """From the unit of a column to SI."""
    unit = spelt(table.units[place])
    if unit not in _POWERS and unit not in _OTHER:
        problem = f"{table.names[place]} in {unit}"
        raise SceneError("columns", problem, "a unit of SI, as nm, s, nN", table.file)
    return _OTHER[unit] if unit in _OTHER else float(f"1e{_POWERS[unit]}")


def _stated_in_si(head: str, name: str) -> float | None:
    """The number that the head states: ``k (N/m)  0.05``, ``# spring constant = 50 pN/nm``."""
    found = re.findall(rf"{name}\s*([\[(][^\])]*[\])])?[\"']?\s*[=:\t ]\s*({_NUMBER})[ \t]*([\w/µμ]*)", head)
    if not found:
        return None
    before, value, behind = found[-1]
    parts = spelt(bracketed(before) or behind).split("/")
    power = sum(sign * _POWERS.get(part, 0) for part, sign in zip(parts, (1, -1), strict=False))
    return float(value.replace(",", ".")) * float(f"1e{power}")


def _text(path: Path) -> str:
    """The text of a file in UTF-8, or in the code of western Windows, as instruments write it."""
    try:
        return read_text(path, LARGEST_FILE)
    except SceneError as error:
        if "UTF-8" not in error.problem:
            raise
    data = path.read_bytes()
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    if not wide and b"\0" in data[:1000]:
        raise SceneError("", "is no text", "a table of text", str(path))
    return data.decode("utf-16" if wide else "cp1252", errors="replace")


def _plain(text: str) -> str:
    """A record as a table: decimal commas as points, and lines that state numbers above its rows as comments;
    rows are the lines of numbers alone, as many in each as in most."""
    lines = re.split(r"\r\n|\r|\n", text)
    for decimal in (True, False):
        parted = r";|\s" if decimal else r"[;,\s]"
        widths = [_numbers(re.split(parted, line.strip(" ;\t")), decimal) for line in lines]
        [(width, rows)] = Counter(one for one in widths if one > 1).most_common(1) or [(0, 0)]
        if rows >= FEWEST_ROWS:
            first = widths.index(width)
            stating = [bool(re.search(r"\d", line)) and line[0] not in "#%" for line in lines[:first]]
            head = [f"# {line}" if told else line for line, told in zip(lines, stating, strict=False)]
            body = [line.replace(",", ".") for line in lines[first:]] if decimal else lines[first:]
            return "\n".join([*head, *body])
    return "\n".join(lines)


def _numbers(cells: list[str], decimal: bool) -> int:
    """How many cells there are, if all are numbers; else 0."""
    filled = [cell.strip('"') for cell in cells if cell]
    points = (cell.replace(",", ".") if decimal and not cell.endswith(",") else cell for cell in filled)
    return len(filled) if all(map(is_number, points)) else 0


def write_csv(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve with all its digits."""
    head = [f"# {key} = {getattr(curve, key)!r}" for key in NUMBERS if getattr(curve, key) is not None]
    write_whole(path, table_text(curve.columns(), head))


# Formats of instruments


def _read_afmformats(path: Path, given: Given) -> list[Recorded]:
    """Curves by the readers of ``afmformats``: its own formats, AFM Workshop, NT-MDT."""
    import afmformats

    ending, curves = path.suffix.lower(), []
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        # Endings in capitals are unknown to it.
        plain = path if path.suffix == ending else copyfile(path, Path(folder) / f"{path.stem}{ending}")
        if ending == ".h5":
            _check_hdf5(path)
        records = afmformats.load_data(plain, meta_override=given.overrides())
        if ending == ".tab":
            _check_rows(path)
        for number, record in enumerate(records):
            stated, held = dict(record.metadata), record.columns
            columns = {key: record[key] for key in ("time", "force") if key in held}
            heights = [record[height] for height in (STAGE, PIEZO) if height in held]
            stiffness = given.spring_constant or stated.get("spring constant", np.nan)
            if heights and stiffness > 0.0:
                columns["stage"] = -heights[0]
            elif TIP in held:
                columns["penetration"], stiffness = -record[TIP], None
            elif heights:
                raise _missing(["spring constant"], path)
            if "force" not in columns or len(columns) < 2:
                allowed = f"force, and {STAGE} or {TIP}"
                raise SceneError("", f"curve {number} has columns {', '.join(held)}", allowed, str(path))
            rate = stated.get("rate approach", np.nan)
            numbers = np.asarray(record["segment"]).astype(int) if "segment" in held else None
            rate = rate if rate > SLOWEST else None
            curves.append(Recorded(columns, stiffness, numbers, rate))
    return curves


def _read_jpk(path: Path, given: Given) -> list[Recorded]:
    """JPK: ``afmformats`` knows records of two or three segments, its reader of the archive any."""
    from afmformats.formats.fmt_jpk.jpk_reader import JPKReader

    class AnySegments(JPKReader):
        """Of records of any number of segments, modulated ones taken for pauses."""

        def get_imaging_mode(self) -> str:
            return "force-distance"

        def get_metadata_jpk_secondary(self, index: int, segment: int | None = None) -> Any:
            found = super().get_metadata_jpk_secondary(index=index, segment=segment)
            return found if found.get("curve type") in MOTIONS else found | {"curve type": "pause"}

    file = AnySegments(path)
    file.set_metadata(given.overrides())
    curves = []
    for n in range(len(file)):
        spring, kinds = given.spring(file.get_metadata(n).get("spring constant"), path), []
        for k in file.get_index_segment_numbers(n):
            kind = MOTIONS[file.get_metadata_jpk_secondary(n, k)["curve type"]]
            kinds += [kind] * file.get_metadata(n, k)["point count"]
        try:
            height = file.get_data(STAGE, n)
        except (KeyError, ValueError, LookupError):
            height = file.get_data(PIEZO, n)
        columns = {"time": file.get_data("time", n), "stage": -height, "force": file.get_data("force", n)}
        curves.append(Recorded(columns, spring, file.get_data("segment", n), kinds=kinds))
    return curves


def _read_asylum(path: Path, given: Given) -> list[Recorded]:
    """Igor binary waves, all channels in one or one a file; segments begin at the ``Indexes`` of the note."""
    from igor2.binarywave import load

    wave = load(path)["wave"]
    lines = re.split(r"[\r\n]+", wave["note"].decode("latin-1"))
    note = {key: value.strip() for key, _, value in (line.partition(":") for line in lines)}
    if wave["wData"].ndim == 2:
        labels = [label.decode() for label in wave["labels"][1] if label]
        channels = dict(zip(labels, wave["wData"].T.astype(float), strict=True))
    else:
        stem = re.sub(r"(Defl|ZSnsr|Raw)$", "", path.stem)
        files = {name: path.with_name(f"{stem}{name}{path.suffix}") for name in ("Defl", "ZSnsr", "Raw")}
        channels = {
            name: load(file)["wave"]["wData"].astype(float) for name, file in files.items() if file.exists()
        }
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
    return [Recorded(columns, spring, numbers, _stated(note, "NumPtsPerSec"))]


def _stated(note: Mapping[str, str], key: str) -> float | None:
    """A number of the note of a wave."""
    found = re.match(r"[-+]?[\d.]+(e[-+]?\d+)?", note.get(key, ""), re.IGNORECASE)
    return float(found[0]) if found else None


def _read_nanoscope(path: Path, given: Given) -> list[Recorded]:
    """Single ramps of Bruker, whose retraction is stored from far to near; force volumes of 4-byte data come
    out wrong by powers of ten."""
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
    return [Recorded(columns, spring, numbers)]


READERS = {
    **dict.fromkeys(WRITTEN, _read_afmformats),
    ".ibw": _read_asylum,
    **dict.fromkeys((".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series"), _read_jpk),
}
"""Of formats with endings of their own, which are no tables."""


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
    stated: dict[str, Any] = {"imaging mode": "force-distance", "enum": 0, "point count": curve.time.size}
    stated |= {"duration": float(np.ptp(curve.time)), "software": "crosscontact", "software version": "0"}
    if curve.stage is not None:
        columns[STAGE] = -curve.stage
        stated["spring constant"] = curve.stiffness
    record = afmformats.AFMForceDistance(columns, stated | {"path": path})
    record.export_data(path, metadata=list(stated), fmt=WRITTEN[path.suffix.lower()])


def _check_hdf5(path: Path) -> None:
    """Columns must hold real numbers, in the unit that they are read in where they state one."""
    import h5py

    if not h5py.is_hdf5(path):
        return
    with h5py.File(path, "r") as file:
        for column in (curve[name] for curve in file.values() for name in _UNITS.keys() & set(curve)):
            key, wanted = column.name.lstrip("/"), _UNITS[column.name.rsplit("/", 1)[1]]
            unit = column.attrs.get("unit", "")
            unit = (unit.decode() if isinstance(unit, bytes) else str(unit)).strip()
            if column.dtype.kind not in "iuf":
                raise SceneError(key, f"holds {column.dtype}", "real numbers", str(path))
            if unit not in ("", wanted):
                raise SceneError(key, f"is in {unit}", f"{wanted}: nothing is converted", str(path))


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
            raise _missing(sorted(getattr(error, "meta_keys", ()), reverse=True), path) from None
        if kind == "FileFormatNotSupportedError" or (ending.startswith(".jpk") and "zip" in str(error)):
            problem = "is damaged, or in no format that afmformats knows"
            allowed = f"a {ending} of a force microscope; a table is a .csv or a .txt"
            raise UnknownFormat("", problem, allowed, str(path)) from None
        problem = f"cannot be read: {kind} {error}"
        raise SceneError("", problem, "a file of afmformats", str(path)) from None
