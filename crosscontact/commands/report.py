"""``crosscontact report``: a suite of built-in scenes, checked and drawn."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace

from crosscontact.commands import stability
from crosscontact.commands.failures import exit_code
from crosscontact.commands.interruption import telling_what_is_kept
from crosscontact.tables import cell
from validation import cases, scenes
from validation.compare import regression
from validation.compare.suite import SceneComparison, all_pairs
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.fields import cycle_fields
from validation.report.build import build
from validation.report.document import counted
from validation.report.json_data import of_report
from validation.report.report_folder import REPORT, check_report_unused
from validation.report.write import write


def run(
    suite: str,
    out: str,
    jobs: int,
    *,
    estimate: bool = True,
    baseline: str | None = None,
    fresh: bool = False,
    fields: bool = False,
) -> int:
    """Run a suite and write the report.

    Parameters
    ----------
    suite : str
        "quick", "paper" or "full".
    out : str
        Folder of the report.
    jobs : int
        Processes.
    estimate : bool
        Whether agreement is judged by error estimates, each from a second run, or by tolerances alone.
    baseline : str or None
        An earlier ``report.json`` to compare with.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.
    fields : bool
        Whether the fields under the surface are drawn too.

    Returns
    -------
    int
        1 if a check failed or a value moved beyond tolerance from the earlier report.

    Raises
    ------
    SceneError
        If the folder holds results on another scene, of another command or another program.
    """
    old = None if baseline is None else regression.read(baseline)
    folder = output_folder(out)
    loaded = cases.load_all(scenes.suite(suite))
    if not fresh:
        check_report_unused(folder, REPORT, loaded)
    store, claims = Store(folder, fresh), suite != "quick"
    with telling_what_is_kept(folder, store), processes(min(jobs, len(all_pairs(loaded)))) as executor:
        progress = Progress("report")
        progress.phase("runs")
        result = build(suite, loaded, executor, progress, estimate=estimate, claims=claims, store=store)
        if suite == "full":
            result = replace(result, stability=stability.compute(jobs, store))
        if fields:
            result = replace(result, fields=_fields(result.scenes))
        if baseline is not None and old is not None:
            result = replace(result, baseline=regression.compare(baseline, old, of_report(result), loaded))
        with Progress("report") as writing:
            writing.phase("drawing and writing")
            write(result, folder, executor, writing)
    store.clear()
    print(f"{counted(len(result.checks), 'check')}, {len(result.failures)} failed: {folder / 'index.html'}")
    code = exit_code(result.failures)
    if result.baseline is None:
        return code
    _print_changes(result.baseline)
    return 1 if result.baseline.beyond else code


def _print_changes(since: regression.ReportComparison) -> None:
    """What is not as in the earlier report."""
    for change in since.changes:
        print(f"changed: {change}")
    print(since.verdict)
    for move in since.beyond:
        print(
            f"moved: {move.scene}: {move.solver}: {move.what}: {cell(move.before)} -> {cell(move.after)}",
            file=sys.stderr,
        )


def _fields(comparisons: Sequence[SceneComparison]) -> cycle_fields.CycleFields:
    """Fields in the body for the report's section, with progress."""
    progress = Progress("report")
    progress.phase("fields in the body")
    runs = next((one.runs for one in comparisons if one.case.name == cycle_fields.SCENE), {})
    try:
        return cycle_fields.compute(runs, progress)
    finally:
        progress.close()
