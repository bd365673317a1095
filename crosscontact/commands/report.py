"""``crosscontact report``: a suite of built-in scenes, checked and drawn."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from crosscontact import arguments
from crosscontact.commands import shared, stability
from crosscontact.commands.shared import exit_code, failed, flag, value
from validation import cases, scenes
from validation.claims import evidence
from validation.claims import page as claims_page
from validation.compare import page, regression
from validation.compare.suite import SceneComparison, all_pairs, compare_scenes
from validation.fields import chapter as fields_chapter
from validation.report.document import counted, number
from validation.report.report import Chapter
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.stability import page as stability_page

OPTIONS = {
    "--suite": {"choices": scenes.SUITES, "default": "quick"},
    "--out": value("DIR", "default: %(default)s", default="out/report"),
    "--estimates": {
        "action": argparse.BooleanOptionalAction,
        "default": True,
        "help": "judge agreement by error estimates, each from a coarser run (default), or by tolerances "
        "alone",
    },
    "--baseline": value("OLD.json", "an earlier report.json: list what moved, exit 1 when beyond tolerance"),
    "--fields": flag(
        "draw what happens under the surface along the cycle of Fig. 3 too; a minute or two more"
    ),
    **shared.jobs(),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Run a suite and write the report; 1 if a check failed or a value moved beyond tolerance."""
    arguments.usable()  # names those that cannot be loaded
    suite, baseline = options.suite, options.baseline
    old = None if baseline is None else regression.read(baseline)
    loaded = cases.load_all(scenes.suite(suite))
    planned, others, moved = all_pairs(loaded), list[Chapter](), None
    with (
        shared.long_work("report", options, "a report", loaded) as work,
        processes(min(jobs, len(planned))) as executor,
    ):
        further = evidence.missing_runs(planned) if suite != "quick" else []
        settings = {"estimate": options.estimates, "store": work.store, "further": further}
        compared = compare_scenes(suite, loaded, executor, work.runs(), **settings)
        matrix = stability.compute(jobs, work.store) if suite == "full" else None
        fields = _fields(compared.scenes) if options.fields else None
        with Progress("report", "drawing and writing") as writing:
            if suite != "quick":
                collected = evidence.collect([*planned, *further], compared.runs)
                others.append(claims_page.chapter(claims_page.findings(collected), collected))
            if matrix is not None:
                others.append(stability_page.chapter(matrix))
            if fields is not None:
                others.append(fields)
            if old is not None:
                moved = regression.compare(baseline, old, page.data(compared, others), loaded)
            page.write(compared, Path(options.out), executor, writing, others, moved)
    checks = page.checks(compared, others)
    failures = [check for check in checks if not check.passed]
    index = Path(options.out) / "index.html"
    print(f"{counted(len(checks), 'check')}, {len(failures)} failed: {index}")
    code = exit_code(failures)
    return code if moved is None else max(code, _moved(moved))


def _moved(since: regression.ReportComparison) -> int:
    """Print what is not as in the earlier report; 1 if anything is beyond tolerance."""
    for change in since.changes:
        print(f"changed: {change}")
    print(since.verdict)
    return failed(
        [
            f"moved: {move.scene}: {move.solver}: {move.what}: {number(move.before)} -> {number(move.after)}"
            for move in since.beyond
        ]
    )


def _fields(comparisons: Sequence[SceneComparison]) -> Chapter:
    """Fields in the body for the report's section, with progress."""
    runs = next((one.runs for one in comparisons if one.case.name == fields_chapter.SCENE), {})
    with Progress("report", "fields in the body") as progress:
        return fields_chapter.chapter(runs, progress)
