"""The table of accuracy and cost, for the README and the site, from a saved report.

``python docs/update_readme.py`` puts it into the README anew.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from statistics import median

from benchmarks import saved_report as saved
from validation.execution.runs import Run
from validation.report.report import Report
from validation.solvers import REFERENCE, SOLVERS

QUANTITIES = {"pull_off_force": "pull-off force", "loop_energy": "loop energy"}
MARKED = re.compile(r"(<!-- generated: accuracy -->\n).*?(<!-- end -->)", re.DOTALL)


def accuracy(report: Path) -> str:
    """Differences from the reference and processor time of each solver over the scenes of a report.

    Parameters
    ----------
    report : Path
        Its folder or archive.

    Returns
    -------
    str
        Markdown.
    """
    found = saved.read(report)
    scenes = [scene for scene in found.scenes if scene.case.scene.is_adhesive and REFERENCE in scene.runs]
    lines = [
        f"| solver | {' | '.join(QUANTITIES.values())} | processor seconds |",
        "|---|---|---|---|",
    ]
    for name in [*(one for one in SOLVERS if one != REFERENCE), REFERENCE]:
        pairs = [(scene.runs[name], scene.runs[REFERENCE]) for scene in scenes if name in scene.runs]
        if pairs:
            errors = [_range(_differences(pairs, quantity)) for quantity in QUANTITIES]
            seconds = [run.cpu_seconds for run, _ in pairs if run.trace is not None]
            cost = f"{_seconds(median(seconds))} ({_seconds(max(seconds))})"
            lines.append(f"| `{name}` | {' | '.join(errors)} | {cost} |")
    return "\n".join([*lines, "", _caption(found, len(scenes))]) + "\n"


def _seconds(value: float) -> str:
    """Two digits, without an exponent."""
    return f"{float(f'{value:.2g}'):g}"


def _differences(pairs: Iterable[tuple[Run, Run]], quantity: str) -> list[float]:
    """Relative differences from the reference; for the reference itself its own estimates."""
    found = []
    for run, reference in pairs:
        value, base = run.measures.get(quantity), reference.measures.get(quantity)
        if run.solver == REFERENCE and quantity in run.errors and base:
            found.append(run.errors[quantity])
        elif value is not None and base:
            found.append(abs(value / base - 1.0))
    return found


def _range(values: list[float]) -> str:
    return f"{median(values):.0e} ({max(values):.0e})" if values else "–"


def _caption(report: Report, scenes: int) -> str:
    processor = report.environment["processor"]
    return f"""\
Relative difference from the reference (for `{REFERENCE}`: its own error estimate), median and in brackets
the largest over the {scenes} adhesive scenes of `report --suite {report.suite}`, default resolution;
processor time of a run on one core ({processor})."""


def update(readme: Path, report: Path) -> None:
    """Put the table into the README."""
    text = readme.read_text("utf-8")
    readme.write_text(with_table(text, accuracy(report)), "utf-8")


def with_table(text: str, table: str) -> str:
    """The text of the README with this table between its marks."""
    return MARKED.sub(lambda found: f"{found.group(1)}{table}{found.group(2)}", text)
