"""A report read back from its folder, and packed small enough to be kept beside the code.

The folder is what ``crosscontact report --out`` wrote, or a ZIP archive of it made by
``python -m benchmarks.saved_report out/report docs/data/report.zip``. Nothing is run.
"""

from __future__ import annotations

import io
import lzma
import shutil
import sys
import tempfile
import zipfile
import zlib
from pathlib import Path
from typing import Any

from contact_scene import COLUMNS, SceneError, read_columns, read_scene
from validation.cases import Case
from validation.claims.claim import Finding, Part, Verdict
from validation.compare.suite import SceneComparison, SuiteComparison
from validation.measure.difference import Check
from validation.runs.folder import from_json, in_words
from validation.runs.run import Run, read_run

DIGITS = 7
"""Significant digits of a packed trace: its figures are drawn to four."""
EARLIEST = (1980, 1, 1, 0, 0, 0)
"""Date of the files in an archive, so that the same report gives the same archive."""
LARGEST = 100_000_000
"""Most bytes that an archive unpacks to: a full report has 13 MB. A file of it is unpacked
as far as its size in the list says."""
DOCUMENTS = ("report.json", "stability.json", "study.md")
"""Files of a folder that are packed as they are, beside the runs."""


def read(source: Path) -> SuiteComparison:
    """The scenes of a report from its folder or archive."""
    if source.is_dir():
        return _report(source)
    with tempfile.TemporaryDirectory() as folder:
        unpack(source, Path(folder))
        return _report(Path(folder))


def unpack(archive: Path, folder: Path) -> None:
    """Unpack an archive that :func:`pack` made."""
    try:
        with zipfile.ZipFile(archive) as packed:
            if sum(one.file_size for one in packed.infolist()) > LARGEST:
                raise SceneError("", f"unpacks to more than {in_words(LARGEST)}", "a report", str(archive))
            packed.extractall(folder)
    except (OSError, EOFError, RuntimeError, lzma.LZMAError, zipfile.BadZipFile, zlib.error) as error:
        raise SceneError("", f"cannot be read: {error}", "the archive of a report", str(archive)) from None


def findings(data: list[dict[str, Any]]) -> tuple[Finding, ...]:
    """The findings on the paper's statements, of ``report.json``."""
    return tuple(
        Finding(
            one["name"],
            one["place"],
            one["wording"],
            Verdict(one["recorded"]),
            tuple(Part(**part) for part in one["parts"]),
            one["failure"],
        )
        for one in data
    )


def pack(folder: Path, archive: Path) -> None:
    """Pack a report: every number, the scenes, the runs with the columns that are drawn, its figures."""
    with tempfile.TemporaryDirectory() as stage:
        packed = Path(stage) / "packed.zip"
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_LZMA) as target:
            for path in sorted(folder.rglob("*")):
                name = path.relative_to(folder)
                if name.parts[0] == "runs" and path.suffix in (".toml", ".json", ".csv"):
                    data = _drawn_columns(path) if path.name == "trace.csv" else path.read_bytes()
                elif (name.parts[0] == "figures" and path.suffix == ".png") or str(name) in DOCUMENTS:
                    data = path.read_bytes()
                else:
                    continue
                target.writestr(zipfile.ZipInfo(name.as_posix(), EARLIEST), data, zipfile.ZIP_LZMA)
        shutil.copyfile(packed, archive)


def _drawn_columns(path: Path) -> bytes:
    columns = read_columns(path)
    text = io.StringIO()
    text.write(",".join(COLUMNS) + "\n")
    for row in zip(*(columns[name].tolist() for name in COLUMNS), strict=True):
        text.write(",".join(f"{value:.{DIGITS}g}" for value in row) + "\n")
    return text.getvalue().encode()


def _report(folder: Path) -> SuiteComparison:
    file = folder / "report.json"
    try:
        data = from_json(file.read_text("utf-8"))
        scenes = [_scene(folder, scene) for scene in data["scenes"]]
        return SuiteComparison(data["suite"], scenes, data["environment"], data["wall_seconds"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError("", f"damaged: {error}", "report.json as written", str(file)) from None


def _scene(folder: Path, data: dict[str, Any]) -> SceneComparison:
    runs = {
        solver: _run(folder / "runs" / data["name"] / solver, run) for solver, run in data["runs"].items()
    }
    scene = read_scene(folder / "runs" / data["name"] / next(iter(runs)) / "scene.toml")
    case = Case(data["name"], scene, data["figure"], data["statement"])
    return SceneComparison(case, runs, [Check(**check) for check in data["checks"]])


def _run(folder: Path, data: dict[str, Any]) -> Run:
    if data["outcome"] not in ("failed", "refused"):
        return read_run(folder)[1]
    details = data.get("traceback") or ""
    return Run(data["scene"], data["solver"], None, data["reason"], data["outcome"] == "refused", details)


if __name__ == "__main__":
    pack(Path(sys.argv[1]), Path(sys.argv[2]))
