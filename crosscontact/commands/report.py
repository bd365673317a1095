"""``crosscontact report``: a suite of built-in scenes, checked and drawn."""

from __future__ import annotations

import sys
from dataclasses import replace

from crosscontact.commands import stability
from crosscontact.commands.failures import exit_code, short
from validation import cases
from validation.compare import regression
from validation.execution.files import output_folder
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report import build, fields_section
from validation.report.jsonreport import data


def run(
    suite: str,
    out: str,
    jobs: int,
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
        Whether runs stored by an earlier, interrupted command are ignored.
    fields : bool
        Whether the fields under the surface are drawn too.

    Returns
    -------
    int
        1 if a check failed or a value moved beyond tolerance from the earlier report.
    """
    old = None if baseline is None else regression.read(baseline)
    folder = output_folder(out)
    loaded = cases.load_all(cases.suite(suite))
    store, claims = Store(folder, fresh), suite != "quick"
    result = build.build(suite, loaded, jobs, Progress("report"), estimate, claims, store)
    if suite == "full":
        result = replace(result, stability=stability.compute(jobs, store))
    if fields:
        result = replace(result, fields=_fields(result.pages))
    if baseline is not None and old is not None:
        result = replace(result, baseline=regression.compare(baseline, old, data(result), loaded))
    build.write(result, folder)
    store.clear()
    print(f"{len(result.checks)} checks, {len(result.failures)} failed: {folder / 'index.html'}")
    code = exit_code(result.failures)
    if result.baseline is None:
        return code
    print(result.baseline.verdict)
    for move in result.baseline.beyond:
        print(
            f"moved: {move.scene}: {move.solver}: {move.what}: {short(move.before)} -> {short(move.after)}",
            file=sys.stderr,
        )
    return 1 if result.baseline.beyond else code


def _fields(pages: list[build.Page]) -> fields_section.FieldsSection:
    """The report's section on fields, with progress."""
    progress = Progress("fields")
    try:
        return fields_section.compute(pages, progress)
    finally:
        progress.close()
