"""The report as Markdown, short enough for the summary of a CI job."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.report import claims_section, stability_section
from validation.report.text import HEAD, MOVE_HEAD, move_row, number, row, spared_by

if TYPE_CHECKING:
    from validation.compare.regression import ReportComparison
    from validation.report.build import Page, Report

MOST = 20  # moves shown, if fewer count


def text(report: Report) -> str:
    """Verdict, one line per scene, then every check that did not pass."""
    failed = report.failures
    verdict = "all passed" if not failed else f"**{len(failed)} failed**"
    lines = [
        f"# crosscontact report, suite {report.suite}",
        "",
        f"{len(report.checks)} checks on {len(report.pages)} scenes: {verdict}. "
        f"{report.wall_seconds:.0f} s on {report.environment['processor']}.",
        "",
        "| scene | checks | verdict | pull-off force | " + " | ".join(_solvers(report)) + " |",
        "|---|---|---|---|" + "---|" * len(_solvers(report)),
    ]
    lines += [_line(page) for page in report.pages]
    lines += ["", "Left out, by the counters of work:", ""]
    lines += [f"- {_cell(page.case.name)}: {_cell(spared_by(page))}" for page in report.pages]
    if failed:
        rule = "|---" * (1 + len(HEAD)) + "|"
        lines += ["", "## Not passed", "", "| scene | " + " | ".join(HEAD) + " |", rule]
        lines += [f"| {_cell(c.scene)} | " + " | ".join(map(_cell, row(c))) + " |" for c in failed]
    if report.claims is not None:
        lines += claims_section.markdown(report.claims)
    if report.stability is not None:
        lines += stability_section.markdown(report.stability)
    if report.baseline is not None:
        lines += _baseline(report.baseline)
    return "\n".join(lines) + "\n"


def _baseline(baseline: ReportComparison) -> list[str]:
    """What moved, all that counts and the largest of the rest."""
    lines = ["", "## Since the baseline", "", baseline.verdict]
    shown = baseline.moves[: max(len(baseline.beyond), MOST)]
    if shown:
        lines += ["", "| " + " | ".join(MOVE_HEAD) + " |", "|---" * len(MOVE_HEAD) + "|"]
        lines += ["| " + " | ".join(map(_cell, move_row(move))) + " |" for move in shown]
    if len(shown) < len(baseline.moves):
        lines += ["", f"{len(baseline.moves) - len(shown)} smaller moves are in report.json."]
    return lines


def _solvers(report: Report) -> list[str]:
    return list(dict.fromkeys(solver for page in report.pages for solver in page.runs))


def _line(page: Page) -> str:
    good = sum(check.passed for check in page.checks)
    forces = [run.measures.get("pull_off_force") for run in page.runs.values()]
    endings = [
        f"{run.trace.outcome.kind}, {run.wall_seconds:.2g} s" if run.trace else run.ending
        for run in page.runs.values()
    ]
    cells = [
        page.case.name,
        f"{good}/{len(page.checks)}",
        "pass" if page.passed else "**FAIL**",
        " / ".join(number(force, 5) for force in forces),
        *endings,
    ]
    return "| " + " | ".join(map(_cell, cells)) + " |"


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
