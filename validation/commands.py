"""What each command does, and what it prints. Returns exit codes; imports stay inside for a quick start."""

from __future__ import annotations

import os
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from validation import cases
from validation.progress import Progress

if TYPE_CHECKING:
    from scene import Scene
    from validation.runs import Run

SHOWN = (
    "approach_force",
    "approach_radius",
    "pull_off_force",
    "pull_off_penetration",
    "pull_off_radius",
    "detachment_time",
    "detachment_penetration",
    "loop_energy",
    "dissipated_energy",
)


def scenes() -> int:
    """List the built-in scenes."""
    titles = cases.titles()
    width = max(map(len, titles))
    quick = set(cases.suite("quick"))
    for name, title in titles.items():
        print(f"{name:<{width}}  {'quick' if name in quick else '     '}  {title}")
    return 0


def solve(name: str, solver: str, resolution: int | None, out: str | None) -> int:
    """Run one solver on one scene; exit code 2 if it refuses the scene, 1 if it does not finish."""
    from validation.files import output_folder
    from validation.runs import run

    case = cases.load(name)
    folder = None if out is None else output_folder(out)
    progress = Progress(f"{case.name} {solver}")
    try:
        result = run(case, solver, resolution, progress)
    finally:
        progress.close()
    if result.refused:
        print(f"crosscontact: error: {result.failure}", file=sys.stderr)
        return 2
    if folder is not None:
        write_run(folder, case.scene, result)
    _print(result, folder)
    if not result.finished:
        print(f"crosscontact: not finished: {result.ending}", file=sys.stderr)
        return 1
    return 0


def write_run(folder: Path, scene: Scene, result: Run) -> None:
    """``scene.toml``, ``trace.csv`` and, last, ``summary.json``: whoever finds it finds a whole set."""
    from scene import write_scene, write_trace
    from validation.files import to_json, write_whole
    from validation.runs import summary

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "summary.json").unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".scene.") as made:
        write_scene(scene, Path(made) / "scene.toml")  # with tables of its own, where it has any
        for file in sorted(Path(made).iterdir()):
            file.replace(folder / file.name)
    if result.trace is not None:
        write_trace(result.trace, folder / "trace.csv")
    else:
        (folder / "trace.csv").unlink(missing_ok=True)
    write_whole(folder / "summary.json", to_json(summary(result)))


def _print(result: Run, folder: Path | None) -> None:
    print(f"{result.scene} by {result.solver}: {result.ending}")
    for name in SHOWN:
        value = result.measures.get(name)
        print(f"  {name:<24}{'-' if value is None else format(value, '.8g')}")
    steps = result.measures.get("counters.steps")
    print(f"  {'steps':<24}{'-' if steps is None else format(steps, '.0f')}")
    print(f"  {'wall_seconds':<24}{result.wall_seconds:.3f}")
    if folder is not None:
        print(f"written to {folder}")


def compare(given: list[str], out: str | None, jobs: int | None) -> int:
    """All solvers on the given scenes, one table with error estimates; exit code 1 when they disagree."""
    from validation.files import output_folder
    from validation.report.build import build, write
    from validation.report.text import table

    loaded = cases.load_all(given)
    folder = None if out is None else output_folder(out)
    result = build("compare", loaded, _workers(jobs), Progress("compare"))
    for page in result.pages:
        print(table(page))
    if folder is not None:
        write(result, folder)
        print(f"written to {folder / 'index.html'}")
    return _verdict(result.failures)


def study(given: list[str], out: str | None, jobs: int | None) -> int:
    """Refinement ladders and error against run time; exit code 1 when a level gives no answer."""
    from validation.files import output_folder
    from validation.report.study_forms import lines, write
    from validation.study import study as run_study

    loaded = cases.load_all(given)
    folder = None if out is None else output_folder(out)
    result = run_study(loaded, _workers(jobs), Progress("study"))
    for line in lines(result):
        print(line)
    if folder is not None:
        write(result, folder)
        print(f"written to {folder / 'index.html'}")
    for scene in result.scenes:
        for ladder, level in scene.failed:
            name = f"{scene.case.name}: {ladder.ladder.scheme}: {ladder.ladder.kind} {level.level.label}"
            print(f"failed: {name}: {level.failure}", file=sys.stderr)
    return 1 if any(scene.failed for scene in result.scenes) else 0


def report(suite: str, out: str, jobs: int | None, estimate: bool = True, baseline: str | None = None) -> int:
    """Run a suite and write the report; exit code 1 when a check fails or a value left its baseline."""
    from validation import baseline as earlier
    from validation.files import output_folder
    from validation.report.build import build, write
    from validation.report.jsonreport import data

    old = None if baseline is None else earlier.read(baseline)
    folder = output_folder(out)
    loaded = cases.load_all(cases.suite(suite))
    result = build(suite, loaded, _workers(jobs), Progress("report"), estimate, claims=suite != "quick")
    if baseline is not None and old is not None:
        result = replace(result, baseline=earlier.compare(baseline, old, data(result), loaded))
    write(result, folder)
    print(f"{len(result.checks)} checks, {len(result.failures)} failed: {folder / 'index.html'}")
    code = _verdict(result.failures)
    if result.baseline is None:
        return code
    print(result.baseline.verdict)
    for move in result.baseline.beyond:
        print(
            f"moved: {move.scene}: {move.solver}: {move.what}: {_short(move.before)} -> {_short(move.after)}",
            file=sys.stderr,
        )
    return 1 if result.baseline.beyond else code


def _workers(jobs: int | None) -> int:
    if jobs is not None:
        return jobs
    if hasattr(os, "sched_getaffinity"):  # the cores this process may use, not those of the machine
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _verdict(failures: list) -> int:
    for check in failures:
        print(
            f"failed: {check.scene}: {check.solver}: {check.quantity}: found {_short(check.found)}, "
            f"expected {check.relation} {_short(check.expected)}{' ' + check.note if check.note else ''}",
            file=sys.stderr,
        )
    return 1 if failures else 0


def _short(value: object) -> str:
    return "-" if value is None else format(value, ".6g") if isinstance(value, float) else str(value)
