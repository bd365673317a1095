"""The stiff and extreme matrix: limits in words, heat maps, growth of work, all cells; ``stability.json``.

The keys of ``stability.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from validation.drawing import export
from validation.measure.difference import Check
from validation.report import markdown, report
from validation.report.document import (
    Bullets,
    DataTable,
    Document,
    Figure,
    Figures,
    Fold,
    Paragraph,
    Record,
    Section,
    VerdictCell,
    counted,
    with_drawing,
)
from validation.report.report import Chapter
from validation.report.tables import environment
from validation.runs.folder import to_json, write_whole
from validation.runs.provenance import stamp
from validation.stability import heat_map
from validation.stability import verdict as judged
from validation.stability.limits import limits, work_growth
from validation.stability.runner import StabilityMatrix

FORMAT = 1
TITLE = "Stiff and extreme cases"
EXPLAINED = (
    "Every field is one run of one solver on one scene, in a process of its own that is killed if it hangs. "
    "Its error is the largest of several observables against a closed form where there is one, else against "
    "the front tracking, whose own error estimate is added to the tolerance. A run is within its tolerance, "
    "or reports no answer; anything else is a fault. Resolutions are coarse and tolerances chosen "
    "for them, with the reason beside each. Balance: what stored energy, branch dissipation and release at "
    "the edge, each integrated on its own, leave of the work, relative to the largest of them."
)
MAP_DOTS = 150  # per inch of a heat map saved as PNG: its numbers are small


def chapter(matrix: StabilityMatrix) -> Chapter:
    """The matrix within a report."""
    return Chapter(
        "stability",
        checks(matrix.cells),
        (section(matrix),),
        (summary(matrix),),
        {"stability": data(matrix)},
        {"": matrix.wall_seconds},
    )


def checks(cells: Sequence[judged.Cell]) -> list[Check]:
    """No cell at fault: one check for every axis and solver, in the order of the cells."""
    groups: dict[tuple[str, str], list[judged.Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.axis, cell.solver), []).append(cell)
    return [
        Check(
            "stability",
            solver,
            f"faults: {axis}",
            "within tolerance, or no answer reported",
            0.0,
            float(sum(cell.fault for cell in group)),
            not any(cell.fault for cell in group),
            relation="<=",
            note="; ".join(f"{cell.label}: {cell.verdict}" for cell in group if cell.fault),
        )
        for (axis, solver), group in groups.items()
    ]


def data(matrix: StabilityMatrix, complete: bool = True) -> dict[str, Any]:
    """The matrix in ``report.json``; ``complete`` is false while cells are still missing."""
    counted = numbers(matrix.cells)
    return {
        "complete": complete,
        "wall_seconds": matrix.wall_seconds,
        "limits": limits(matrix.cells),
        "growth": [
            asdict(growth) | {"logarithmic": growth.logarithmic} for growth in work_growth(matrix.cells)
        ],
        "cells": [
            asdict(cell)
            | {"number": counted[cell.axis, cell.label], "error": cell.error, "worst": cell.worst}
            for cell in matrix.cells
        ],
    }


def write(matrix: StabilityMatrix, folder: Path) -> None:
    """Write ``index.html``, ``stability.md``, ``stability.json`` and ``figures/``."""
    title, lead = "crosscontact stability", (_lead(matrix),)
    parts = section(matrix), environment(stamp(), matrix.wall_seconds)
    short = Document(title, lead, (summary(matrix),))
    texts = {"stability.json": _json(matrix, True), "stability.md": markdown.text(short)}
    report.write(folder, Document(title, lead, parts), texts)


def write_cells(cells: Sequence[judged.Cell], folder: Path) -> None:
    """Write ``stability.json`` alone, of a matrix that is not complete yet."""
    write_whole(folder / "stability.json", _json(StabilityMatrix(tuple(cells), 0.0), False))


def _json(matrix: StabilityMatrix, complete: bool) -> str:
    return to_json({"format": FORMAT} | data(matrix, complete))


def section(matrix: StabilityMatrix) -> Section:
    """Everything about the matrix."""
    growth = tuple(one.words for one in work_growth(matrix.cells))
    work = Bullets(growth) if growth else Paragraph("No series was long enough.")
    return Section(
        TITLE,
        (
            Paragraph(EXPLAINED),
            Section("Limits found", (Bullets(tuple(limits(matrix.cells))), _maps(matrix))),
            Section("Work against stiffness", (work,)),
            Fold(f"All {len(matrix.cells)} cells", (_table(matrix, matrix.cells),)),
        ),
        "stability",
    )


def summary(matrix: StabilityMatrix) -> Section:
    """The limits, and every cell that is not simply within its tolerance."""
    shown = [cell for cell in matrix.cells if cell.verdict is not judged.CellVerdict.WITHIN]
    table = (_table(matrix, shown),) if shown else ()
    return Section(TITLE, (Bullets(tuple(limits(matrix.cells))), *table))


def _lead(matrix: StabilityMatrix) -> Paragraph:
    """How many cells, and how many at fault."""
    faults = len(matrix.faults)
    verdict = f"{faults} at fault" if faults else "no fault"
    return Paragraph(f"{counted(len(matrix.cells), 'cell')}: {verdict}.", not faults)


def numbers(cells: Sequence[judged.Cell]) -> dict[tuple[str, str], int]:
    """Cases numbered in their order, from one, by axis and label."""
    return {key: i for i, key in enumerate(dict.fromkeys((cell.axis, cell.label) for cell in cells), 1)}


def _maps(matrix: StabilityMatrix) -> Figures:
    """A heat map for every solver."""
    counted, figures = numbers(matrix.cells), []
    for solver in dict.fromkeys(cell.solver for cell in matrix.cells):
        name = f"stability-{solver}"
        drawing = heat_map.draw([cell for cell in matrix.cells if cell.solver == solver], counted)
        caption = f"{solver}: {heat_map.LEGEND}."
        files = {f"{name}.png": export.png(drawing, MAP_DOTS)}
        figure = Figure(name, caption, wide=True, files=files)
        figures.append(with_drawing(figure, drawing, f"Heat map, {solver}"))
    return Figures(tuple(figures))


def _table(matrix: StabilityMatrix, cells: Iterable[judged.Cell]) -> DataTable:
    counted = numbers(matrix.cells)
    return DataTable.of(_cells(cell, counted[cell.axis, cell.label]) for cell in cells)


def _cells(cell: judged.Cell, number: int) -> Record:
    meets = cell.verdict is judged.CellVerdict.WITHIN
    return {
        "no.": str(number),
        "axis": cell.axis,
        "place": cell.label,
        "solver": cell.solver,
        "verdict": VerdictCell(str(cell.verdict), False if cell.fault else True if meets else None),
        "error": _short(cell.error),
        "in": cell.worst,
        "tolerance": _short(cell.tolerance),
        "expected ±": _short(cell.expected_error) if cell.expected_error else "",
        "outcome": cell.outcome if meets else f"{cell.outcome}: {cell.reason}",
        "steps": str(cell.steps),
        "rejected": str(cell.rejected_steps),
        "balance": _short(cell.residual),
        "s": f"{cell.seconds:.2f}",
        "measured against": cell.source,
        "why this tolerance": cell.why,
    }


def _short(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.1e}" if math.isfinite(value) else "none given"
