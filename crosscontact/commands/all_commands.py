"""What each command does, and what it prints. Returns exit codes; imports stay inside for a quick start."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from validation import cases
from validation.execution.progress import Progress

if TYPE_CHECKING:
    from validation.compare.suite import SceneComparison
    from validation.execution.runs import Run
    from validation.fields.cycle_fields import CycleFields

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


def solve(name: str, solver: str, resolution: int | None, out: str | None, fresh: bool = False) -> int:
    """Run one solver on one scene; exit code 2 if it refuses the scene, 1 if it does not finish.

    With a folder to write to, a run that is stopped leaves what it has, and goes on when it is asked again.
    """
    from validation.execution.checkpoints import run_with_checkpoints
    from validation.execution.files import output_folder
    from validation.execution.run_folder import write_run
    from validation.execution.runs import run

    case = cases.load(name)
    folder = None if out is None else output_folder(out)
    progress = Progress(f"{case.name} {solver}")
    try:
        if folder is None:
            result, writer = run(case, solver, resolution, progress), None
        else:
            result, writer = run_with_checkpoints(case, solver, resolution, progress, folder, fresh)
    finally:
        progress.close()
    if result.refused:
        print(f"crosscontact: error: {result.failure}", file=sys.stderr)
        return 2
    if folder is not None:
        write_run(folder, case.scene, result)
    _print(result, folder)
    if writer is not None and writer.stopped:
        print(f"crosscontact: kept in {writer.path}: the same command goes on from there", file=sys.stderr)
        raise KeyboardInterrupt
    if writer is not None and result.trace is not None:  # a breakdown may come of the machine: go on later
        writer.remove()
    if not result.finished:
        print(f"crosscontact: not finished: {result.ending}", file=sys.stderr)
        return 1
    return 0


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


def compare(given: list[str], out: str | None, jobs: int | None, fresh: bool = False) -> int:
    """All solvers on the given scenes, one table with error estimates; exit code 1 when they disagree."""
    from validation.execution.files import output_folder
    from validation.execution.store import Store
    from validation.report import terminal
    from validation.report.build import build
    from validation.report.sections.scene import verdicts
    from validation.report.write import write

    loaded = cases.load_all(given)
    folder = None if out is None else output_folder(out)
    store = Store(folder, fresh)
    result = build("compare", loaded, workers(jobs), Progress("compare"), store=store)
    for scene in result.scenes:
        print(terminal.text(verdicts(scene)))
    if folder is not None:
        write(result, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    return _verdict(result.failures)


def study(given: list[str], out: str | None, jobs: int | None, fresh: bool = False) -> int:
    """Refinement ladders and error against run time; exit code 1 when a level gives no answer."""
    from validation.execution.files import output_folder
    from validation.execution.store import Store
    from validation.report import terminal
    from validation.report.sections.study import short
    from validation.report.write import write_study
    from validation.studies.study import study as run_study

    loaded = cases.load_all(given)
    folder = None if out is None else output_folder(out)
    store = Store(folder, fresh)
    result = run_study(loaded, workers(jobs), Progress("study"), store)
    print(terminal.text(short(result)))
    if folder is not None:
        write_study(result, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    for scene in result.scenes:
        for ladder, level in scene.failed:
            name = f"{scene.case.name}: {ladder.ladder.scheme}: {ladder.ladder.kind} {level.level.label}"
            print(f"failed: {name}: {level.failure}", file=sys.stderr)
    return 1 if any(scene.failed for scene in result.scenes) else 0


def report(
    suite: str,
    out: str,
    jobs: int | None,
    estimate: bool = True,
    baseline: str | None = None,
    fresh: bool = False,
    fields: bool = False,
) -> int:
    """Run a suite and write the report; exit code 1 when a check fails or a value left its baseline."""
    from validation.compare import regression as earlier
    from validation.execution.files import output_folder
    from validation.execution.store import Store
    from validation.report.build import build
    from validation.report.json_data import of_report
    from validation.report.write import write

    old = None if baseline is None else earlier.read(baseline)
    folder = output_folder(out)
    loaded = cases.load_all(cases.suite(suite))
    store, claims = Store(folder, fresh), suite != "quick"
    result = build(suite, loaded, workers(jobs), Progress("report"), estimate, claims, store)
    if suite == "full":
        from crosscontact.commands.stability import compute

        result = replace(result, stability=compute(workers(jobs), store))
    if fields:
        result = replace(result, fields=_fields(result.scenes))
    if baseline is not None and old is not None:
        result = replace(result, baseline=earlier.compare(baseline, old, of_report(result), loaded))
    write(result, folder)
    store.clear()
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


def _fields(scenes: list[SceneComparison]) -> CycleFields:
    """The report's section on fields, with progress."""
    from validation.fields import cycle_fields

    progress = Progress("fields")
    runs = next((one.runs for one in scenes if one.case.name == cycle_fields.SCENE), {})
    try:
        return cycle_fields.compute(runs, progress)
    finally:
        progress.close()


def workers(jobs: int | None) -> int:
    """Processes asked for, or as many as there are cores."""
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
