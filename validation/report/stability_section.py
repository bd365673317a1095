"""The stiff and extreme matrix in every form of the report: heat maps, limits in words, growth, table."""

from __future__ import annotations

import math
import xml.etree.ElementTree as tree
from collections.abc import Sequence
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING, Any

from validation.drawing import figures
from validation.report import stability_map
from validation.stability.checks import checks
from validation.stability.growth import WorkGrowth, fit
from validation.stability.limits import limits
from validation.stability.runner import Matrix
from validation.stability.verdict import Cell, CellVerdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TITLE = "Stiff and extreme cases"
EXPLAINED = (
    "Every field is one run of one solver on one scene, in a process of its own that is killed if it hangs. "
    "Its error is the largest of several observables against a closed form where there is one, else against "
    "the front tracking, whose own error estimate is added to the tolerance. A run is within its tolerance, "
    "or says that it has no answer; anything else is a fault. Resolutions are coarse and tolerances chosen "
    "for them, with the reason beside each. Balance: what stored energy, branch dissipation and release at "
    "the edge, each integrated on its own, leave of the work, relative to the largest of them."
)
HEAD = (
    "no.",
    "axis",
    "place",
    "solver",
    "verdict",
    "error",
    "in",
    "tolerance",
    "truth ±",
    "outcome",
    "steps",
    "rejected",
    "balance",
    "s",
    "measured against",
    "why this tolerance",
)


def numbers(cells: Sequence[Cell]) -> dict[tuple[str, str], int]:
    """Probes numbered as they come, from one."""
    return {key: i for i, key in enumerate(dict.fromkeys((cell.axis, cell.label) for cell in cells), 1)}


def maps(matrix: Matrix) -> dict[str, Figure]:
    """A heat map for every solver."""
    counted = numbers(matrix.cells)
    solvers = dict.fromkeys(cell.solver for cell in matrix.cells)
    return {
        solver: stability_map.draw([cell for cell in matrix.cells if cell.solver == solver], counted)
        for solver in solvers
    }


def pictures(matrix: Matrix) -> dict[str, bytes]:
    """The same as PNG, by file name."""
    return {f"stability-{solver}.png": figures.png(figure, 150) for solver, figure in maps(matrix).items()}


def html(matrix: Matrix) -> str:
    """Section of a page."""
    drawn = "".join(
        f'<figure class="whole">{figures.svg(figure, f"stability-{solver}", f"Heat map, {solver}")}'
        f"<figcaption>{escape(solver)}: {escape(stability_map.LEGEND)}.</figcaption></figure>"
        for solver, figure in maps(matrix).items()
    )
    said = "".join(f"<li>{escape(line)}</li>" for line in limits(matrix.cells))
    return (
        f'<section id="stability"><h2>{TITLE}</h2><p>{escape(EXPLAINED)}</p>'
        f'<h3>Limits found</h3><ul>{said}</ul><div class="figures">{drawn}</div>'
        f"<h3>Work against stiffness</h3>{_growth(fit(matrix.cells))}"
        f'<details><summary>All {len(matrix.cells)} cells</summary><div class="wide">{_table(matrix.cells)}'
        "</div></details></section>"
    )


def _growth(growths: Sequence[WorkGrowth]) -> str:
    if not growths:
        return "<p>No series was long enough.</p>"
    return "<ul>" + "".join(f"<li>{escape(growth.words)}</li>" for growth in growths) + "</ul>"


def _table(cells: Sequence[Cell]) -> str:
    counted = numbers(cells)
    titles = "".join(f"<th>{escape(name)}</th>" for name in HEAD)
    rows = ""
    for cell in cells:
        shown = [escape(text) for text in row(cell, counted[cell.axis, cell.label])]
        kind = "fail" if cell.fault else "pass" if cell.verdict is CellVerdict.WITHIN else ""
        shown[4] = f'<span class="{kind}">{shown[4]}</span>' if kind else shown[4]
        rows += "<tr>" + "".join(f"<td>{text}</td>" for text in shown) + "</tr>"
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{rows}</tbody></table>"


def row(cell: Cell, number: int) -> tuple[str, ...]:
    """One line of the table, in the order of ``HEAD``."""
    outcome = cell.outcome if cell.verdict is CellVerdict.WITHIN else f"{cell.outcome}: {cell.reason}"
    return (
        str(number),
        cell.axis,
        cell.label,
        cell.solver,
        str(cell.verdict),
        _short(cell.error),
        cell.worst,
        _short(cell.tolerance),
        _short(cell.truth_error) if cell.truth_error else "",
        outcome,
        str(cell.steps),
        str(cell.rejected_steps),
        _short(cell.residual),
        f"{cell.seconds:.2f}",
        cell.source,
        cell.why,
    )


def markdown(matrix: Matrix) -> list[str]:
    """Lines: the limits, and every cell that is not simply within its tolerance."""
    lines = ["", f"## {TITLE}", "", *(f"- {line}" for line in limits(matrix.cells))]
    told = [cell for cell in matrix.cells if cell.verdict is not CellVerdict.WITHIN]
    if told:
        counted = numbers(matrix.cells)
        lines += ["", "| " + " | ".join(HEAD) + " |", "|---" * len(HEAD) + "|"]
        for cell in told:
            shown = row(cell, counted[cell.axis, cell.label])
            lines.append("| " + " | ".join(text.replace("|", "\\|") for text in shown) + " |")
    return lines


def data(matrix: Matrix, complete: bool = True) -> dict[str, Any]:
    """Everything, for programs."""
    counted = numbers(matrix.cells)
    return {
        "complete": complete,
        "wall_seconds": matrix.wall_seconds,
        "limits": limits(matrix.cells),
        "growth": [asdict(growth) | {"logarithmic": growth.logarithmic} for growth in fit(matrix.cells)],
        "cells": [
            asdict(cell)
            | {"number": counted[cell.axis, cell.label], "error": cell.error, "worst": cell.worst}
            for cell in matrix.cells
        ],
    }


def junit(matrix: Matrix) -> tree.Element:
    """A test suite, one case for every axis and solver."""
    found = checks(matrix.cells)
    suite = tree.Element(
        "testsuite",
        name="stability",
        tests=str(len(found)),
        failures=str(sum(not check.passed for check in found)),
        errors="0",
        time=f"{matrix.wall_seconds:.3f}",
    )
    for check in found:
        case = tree.SubElement(
            suite, "testcase", classname=f"stability.{check.solver}", name=check.quantity, time="0"
        )
        if not check.passed:
            tree.SubElement(case, "failure", message=f"{check.found:.0f} at fault").text = check.note
    return suite


def _short(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.1e}" if math.isfinite(value) else "none given"
