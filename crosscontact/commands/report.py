"""``crosscontact report``: a suite of built-in scenes, checked and drawn."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from crosscontact import arguments
from crosscontact.commands import stability
from crosscontact.commands.shared import exit_code, failed, run_options, telling_what_is_kept
from validation import cases, scenes
from validation.claims import evidence
from validation.claims import page as claims_page
from validation.claims.all import findings
from validation.compare import page, regression
from validation.compare.suite import SceneComparison, all_pairs, compare_scenes
from validation.fields import chapter as fields_chapter
from validation.report.document import counted, number
from validation.report.report import Chapter
from validation.runs.folder import claim, output_folder, scene_question
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.stability import page as stability_page


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Suite, folder, and what the report holds."""
    command.add_argument("--suite", choices=scenes.SUITES, default="quick")
    command.add_argument("--out", metavar="DIR", default="out/report", help="default: %(default)s")
    command.add_argument(
        "--estimates",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="judge agreement by error estimates, each from a coarser run (default), or by tolerances alone",
    )
    command.add_argument(
        "--baseline",
        metavar="OLD.json",
        help="an earlier report.json: list what moved, exit 1 when beyond tolerance",
    )
    command.add_argument(
        "--fields",
        action="store_true",
        help="draw what happens under the surface along the cycle of Fig. 3 too; a minute or two more",
    )
    run_options(command)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Run a suite and write the report; 1 if a check failed or a value moved beyond tolerance."""
    arguments.usable()  # names those that cannot be loaded
    suite, baseline = options.suite, options.baseline
    old = None if baseline is None else regression.read(baseline)
    folder = output_folder(options.out)
    loaded = cases.load_all(scenes.suite(suite))
    question = scene_question(*((case.name, case.scene) for case in loaded))
    claim(folder, "a report", question, fresh=options.fresh)
    store = Store(folder, options.fresh)
    with telling_what_is_kept(folder, store), processes(min(jobs, len(all_pairs(loaded)))) as executor:
        progress = Progress("report")
        progress.phase("runs")
        judged = suite != "quick"
        planned = all_pairs(loaded)
        further = evidence.missing_runs(planned) if judged else []
        compared = compare_scenes(
            suite, loaded, executor, progress, estimate=options.estimates, store=store, further=further
        )
        matrix = stability.compute(jobs, store) if suite == "full" else None
        fields = _fields(compared.scenes) if options.fields else None
        with Progress("report") as writing:
            writing.phase("drawing and writing")
            others = []
            if judged:
                collected = evidence.collect([*planned, *further], compared.runs)
                others.append(claims_page.chapter(findings(collected), collected))
            if matrix is not None:
                others.append(stability_page.chapter(matrix))
            if fields is not None:
                others.append(fields)
            new = page.data(compared, others)
            moved = None if old is None else regression.compare(baseline, old, new, loaded)
            page.write(compared, folder, executor, writing, others, moved)
    store.clear()
    checks = page.checks(compared, others)
    failures = [check for check in checks if not check.passed]
    print(f"{counted(len(checks), 'check')}, {len(failures)} failed: {folder / 'index.html'}")
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
    with Progress("report") as progress:
        progress.phase("fields in the body")
        return fields_chapter.chapter(runs, progress)
