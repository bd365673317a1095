"""The folder of a report, before anything is written to it: whose numbers it holds.

A folder has one page, ``index.html``, and beside it the file of that page's numbers, by which it is known;
that of a sweep has no page and is known by its runs. A command writes over its own numbers on the same
scenes, with the same or other options, and over nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from contact_scene import SceneError
from contact_scene.files import read_text
from validation.cases import Case
from validation.runs.files import from_json
from validation.runs.premises import of_case
from validation.runs.run_folder import OUTPUT, check_unused, occupied
from validation.runs.run_table import FILE as SWEEP

REPORT, STUDY, STABILITY = "report.json", "study.json", "stability.json"
EXAM, FIT = "exam.json", "fit.json"
KINDS = {
    REPORT: "a report",
    STUDY: "a study",
    STABILITY: "a stability matrix",
    EXAM: "the verdicts on an exam",
    FIT: "a fit",
    SWEEP: "a sweep",
}
"""Files by which a folder is known, and what they are."""
LARGEST = 1_000_000_000
"""Bytes of such a file, at most: beyond, it is not of this program."""


def poisson_json(scene: str) -> str:
    """Name of the file of a study of Poisson's ratio."""
    return f"poisson-{scene}.json"


def zones_json(scene: str) -> str:
    """Name of the file of a study of process zones."""
    return f"zones-{scene}.json"


def check_report_unused(folder: Path, own: str, cases: Sequence[Case] = ()) -> None:
    """Refuse a folder with another kind of report, with one on other scenes, or of another program.

    ``own`` is the file of the report's numbers, ``cases`` its scenes; none where the user has named none.
    """
    for case in cases:
        check_unused(folder, case.scene)
    run = next((name for name in OUTPUT if (folder / name).exists()), None)
    if run is not None and not cases:
        raise occupied(folder, f"a {run}, which is not of {KINDS[own]}")
    if own in KINDS:
        check_kind(folder, own)
    if cases and (folder / own).exists():
        _check_scenes(folder, own, {case.name: case for case in cases})
    for case in cases if own == REPORT else ():
        for earlier in (folder / "runs" / case.name).glob("*"):
            check_unused(earlier, case.scene)


def check_kind(folder: Path, own: str, key: str = "--out") -> None:
    """Refuse a folder that another kind of command has written to, unless it is known by the file ``own``."""
    for name, kind in KINDS.items():
        if name != own and (folder / name).exists():
            raise occupied(folder, f"{kind}, {name}", key)


def _check_scenes(folder: Path, own: str, asked: dict[str, Case]) -> None:
    """Refuse numbers on a scene that is not asked for, or that has changed."""
    try:
        there = _inputs(from_json(read_text(folder / own, LARGEST)))
    except (SceneError, ValueError, TypeError, KeyError):
        raise occupied(folder, f"{own}, which is not of this program") from None
    for name, parts in there.items():
        if name not in asked or of_case(asked[name])["input"] != parts:
            raise occupied(folder, f"the results of another scene, {name!r}")


def _inputs(numbers: dict[str, Any]) -> dict[str, Any]:
    """Fingerprints of the scenes of a file of numbers, by name."""
    if "scene" in numbers:
        return {numbers["scene"]: numbers["premises"]["input"]}
    return {scene["name"]: scene["premises"]["input"] for scene in numbers["scenes"]}
