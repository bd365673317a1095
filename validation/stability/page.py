"""The matrix as a chapter, a page, Markdown and JSON: limits in words, heat maps, growth of work.

A heat map has one row an axis, one field a case, numbered as in the table: colour is the error, the letter
how the run ended. The colours are those of cividis, which a colour-blind reader sees alike; a fault is framed
and crossed out, so that no colour is needed to find it.

The keys of ``stability.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing.figure import INK, VERMILION, drawing, png
from validation.measure.difference import Check
from validation.report import document as doc
from validation.report import report
from validation.report.report import Chapter
from validation.report.tables import environment
from validation.report.texts import markdown
from validation.runs.folder import to_json
from validation.runs.provenance import stamp
from validation.stability.matrix import Cell, CellVerdict, StabilityMatrix

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

LEAST, MOST = -8.0, 0.0  # log10 of the errors that are told apart
BLANK = "#c9c9c9"  # a field without an error: an answer that there is none
FAULT = VERMILION
LETTERS = {
    "completed": "c", "detached": "d", "refused": "R", "no equilibrium at the start": "N",
    "step underflow": "U", "step budget exhausted": "B", "not finite": "F", "out of range": "O",
    "out of the model's range": "Z", "trigger not reached": "T", "breakdown": "L", "interrupted": "I",
    "hung": "H", "failed": "X", "died": "X",
}  # fmt: skip
LEGEND = (
    "c completed, d detached, R refused, N no equilibrium, U step underflow, B step budget, F not finite, "
    "O out of range, Z contact as short as the process zone, T trigger not reached, L contact lost while "
    "pressed in, I interrupted, H hung, X crashed, "
    "? not compared; underlined: reports no answer; framed and crossed out: silently wrong, crashed "
    "or hung"
)
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
FEWEST = 3
"""Least number of stiffnesses that a slope is fitted to."""
UNBALANCED = 0.05
"""Residual of the energy balance, relative to the largest energy, from which on it is reported."""


def chapter(matrix: StabilityMatrix) -> Chapter:
    """The matrix within a report."""
    parts, short = (section(matrix),), (summary(matrix),)
    seconds = {"": matrix.wall_seconds}
    return Chapter("stability", checks(matrix.cells), parts, short, {"stability": data(matrix)}, seconds)


def checks(cells: Sequence[Cell]) -> list[Check]:
    """No cell at fault: one check for every axis and solver, in the order of the cells."""
    found = []
    for axis, solver in dict.fromkeys((cell.axis, cell.solver) for cell in cells):
        faults = [one for one in cells if (one.axis, one.solver) == (axis, solver) and one.fault]
        note = "; ".join(f"{cell.label}: {cell.verdict}" for cell in faults)
        what, number = "within tolerance, or no answer reported", float(len(faults))
        check = Check(
            "stability", solver, f"faults: {axis}", what, 0.0, number, not faults, relation="<=", note=note
        )
        found.append(check)
    return found


def data(matrix: StabilityMatrix) -> dict[str, Any]:
    """The matrix in ``report.json``."""
    numbered = numbers(matrix.cells)
    return {
        "complete": True,
        "wall_seconds": matrix.wall_seconds,
        "limits": limits(matrix.cells),
        "growth": [asdict(one) | {"logarithmic": one.logarithmic} for one in work_growth(matrix.cells)],
        "cells": [
            asdict(cell)
            | {"number": numbered[cell.axis, cell.label], "error": cell.error, "worst": cell.worst}
            for cell in matrix.cells
        ],
    }


def write(matrix: StabilityMatrix, folder: Path) -> None:
    """Write ``index.html``, ``stability.md``, ``stability.json`` and ``figures/``."""
    faults = len(matrix.faults)
    verdict = f"{faults} at fault" if faults else "no fault"
    lead = (doc.Paragraph(f"{doc.counted(len(matrix.cells), 'cell')}: {verdict}.", not faults),)
    parts = section(matrix), environment(stamp(), matrix.wall_seconds)
    short = doc.Document("crosscontact stability", lead, (summary(matrix),))
    texts = {
        "stability.json": to_json({"format": FORMAT} | data(matrix)),
        "stability.md": markdown(short),
    }
    report.write(folder, doc.Document("crosscontact stability", lead, parts), texts)


def section(matrix: StabilityMatrix) -> doc.Section:
    """Everything about the matrix."""
    growth = tuple(one.words for one in work_growth(matrix.cells))
    work = doc.Bullets(growth) if growth else doc.Paragraph("No series was long enough.")
    parts = (
        doc.Paragraph(EXPLAINED),
        doc.Section("Limits found", (doc.Bullets(tuple(limits(matrix.cells))), _maps(matrix))),
        doc.Section("Work against stiffness", (work,)),
        doc.Fold(f"All {len(matrix.cells)} cells", (_table(matrix, matrix.cells),)),
    )
    return doc.Section(TITLE, parts, "stability")


def summary(matrix: StabilityMatrix) -> doc.Section:
    """The limits, and every cell that is not simply within its tolerance."""
    shown = [cell for cell in matrix.cells if cell.verdict is not CellVerdict.WITHIN]
    table = (_table(matrix, shown),) if shown else ()
    return doc.Section(TITLE, (doc.Bullets(tuple(limits(matrix.cells))), *table))


def numbers(cells: Sequence[Cell]) -> dict[tuple[str, str], int]:
    """Cases numbered in their order, from one, by axis and label."""
    return {key: i for i, key in enumerate(dict.fromkeys((cell.axis, cell.label) for cell in cells), 1)}


def _maps(matrix: StabilityMatrix) -> doc.Figures:
    """A heat map for every solver."""
    numbered, figures = numbers(matrix.cells), []
    for solver in dict.fromkeys(cell.solver for cell in matrix.cells):
        name = f"stability-{solver}"
        drawing = draw([cell for cell in matrix.cells if cell.solver == solver], numbered)
        files = {f"{name}.png": png(drawing, MAP_DOTS)}
        figure = doc.Figure(name, f"{solver}: {LEGEND}.", wide=True, files=files)
        figures.append(doc.with_drawing(figure, drawing, f"Heat map, {solver}"))
    return doc.Figures(tuple(figures))


def _table(matrix: StabilityMatrix, cells: Sequence[Cell]) -> doc.DataTable:
    numbered = numbers(matrix.cells)
    return doc.DataTable.of(_row(cell, numbered[cell.axis, cell.label]) for cell in cells)


def _row(cell: Cell, number: int) -> doc.Record:
    meets = cell.verdict is CellVerdict.WITHIN
    return {
        "no.": str(number),
        "axis": cell.axis,
        "place": cell.label,
        "solver": cell.solver,
        "verdict": doc.VerdictCell(str(cell.verdict), False if cell.fault else True if meets else None),
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


def limits(cells: Sequence[Cell]) -> list[str]:
    """Where each solver is accurate, gives no answer, is expensive: sentences, the most serious first."""
    counts = Counter(cell.verdict for cell in cells)
    shown = [one for one in CellVerdict if counts[one] or one is CellVerdict.WRONG]
    sentences = [f"{len(cells)} cells: " + ", ".join(f"{counts[verdict]} {verdict}" for verdict in shown)]
    sentences += [f"{cell.verdict}: {cell.name}: {_fault(cell)}" for cell in cells if cell.fault]
    for solver in dict.fromkeys(cell.solver for cell in cells):
        sentences += _of_solver(solver, [cell for cell in cells if cell.solver == solver])
    unknown = [cell.name for cell in cells if cell.verdict is CellVerdict.UNKNOWN]
    if unknown:
        sentences.append(f"Not compared, the expected values are missing: {'; '.join(unknown)}.")
    growths = work_growth(cells)
    fast = [growth for growth in growths if not growth.logarithmic]
    if growths:
        sentences.append(
            f"Work grows no faster than the logarithm of the stiffness in {len(growths) - len(fast)} of "
            f"{len(growths)} series (steps and rejected steps; at most 1 + decades times the first)."
        )
    return sentences + [growth.words for growth in fast]


def _fault(cell: Cell) -> str:
    if cell.errors:
        return f"{cell.worst} off by {cell.error:.2g}, tolerance {cell.tolerance:.1e} ({cell.outcome})"
    return f"{cell.outcome}: {cell.reason}"


def _of_solver(solver: str, cells: Sequence[Cell]) -> list[str]:
    sentences = []
    silent = [cell for cell in cells if cell.verdict is CellVerdict.DECLINED]
    if silent:
        named = "; ".join(f"{cell.axis}, {cell.label} ({cell.outcome})" for cell in silent)
        sentences.append(f"{solver} reports no answer: {named}.")
    compared = [one for one in cells if one.verdict is CellVerdict.WITHIN and one.errors and one.tolerance]
    if compared:
        worst = max(compared, key=lambda cell: (cell.error or 0.0) / cell.tolerance)
        sentences.append(
            f"{solver} comes closest to its tolerance at {worst.axis}, {worst.label}: "
            f"{worst.worst} {worst.error:.1e} of {worst.tolerance:.1e}."
        )
    loose = [cell for cell in cells if (cell.residual or 0.0) > UNBALANCED]
    if loose:
        most = max(loose, key=lambda cell: cell.residual or 0.0)
        sentences.append(
            f"{solver}: in {len(loose)} of {len(cells)} cells its energy terms, each integrated alone, miss "
            f"the balance by more than {UNBALANCED:.0%} of the largest; most at {most.axis}, {most.label} "
            f"({most.residual:.0%})."
        )
    slow = max(cells, key=lambda cell: cell.seconds)
    took = f"{slow.seconds:.1f} s, {slow.steps} steps"
    return [*sentences, f"{solver} took longest at {slow.axis}, {slow.label}: {took}."]


@dataclass(frozen=True)
class WorkGrowth:
    """Steps (rejected ones included) of one solver along one series of rising stiffness.

    ``steps = at_first + per_decade * log10(stiffness/first)``, least squares; ``power`` is the slope of
    ``log(steps)`` over ``log(stiffness)``.
    """

    axis: str
    series: str
    solver: str
    stiffness: tuple[float, ...]
    steps: tuple[int, ...]
    at_first: float
    per_decade: float
    power: float

    @property
    def logarithmic(self) -> bool:
        """Whether nowhere more than ``1 + decades`` times the first: no faster than the logarithm."""
        decades = np.log10(np.array(self.stiffness) / self.stiffness[0])
        return bool((np.array(self.steps) <= self.steps[0] * (1.0 + decades)).all())

    @property
    def words(self) -> str:
        """One sentence."""
        decades = math.log10(self.stiffness[-1] / self.stiffness[0])
        verdict = "no faster than logarithmic" if self.logarithmic else "FASTER than logarithmic"
        return (
            f"{self.axis}, {self.series}, {self.solver}: {self.steps[0]} to {self.steps[-1]} steps over "
            f"{decades:.0f} decades, {self.per_decade:+.1f} a decade (power {self.power:+.3f}): {verdict}."
        )


def work_growth(cells: Sequence[Cell]) -> list[WorkGrowth]:
    """Every series of every solver, from the cells that have an answer within tolerance."""
    series: dict[tuple[str, str, str], dict[float, int]] = {}
    for cell in cells:
        if cell.series and cell.verdict is CellVerdict.WITHIN and cell.steps:
            work = series.setdefault((cell.axis, cell.series, cell.solver), {})
            work[cell.stiffness] = cell.steps + cell.rejected_steps
    found = []
    for key, work in series.items():
        if len(work) >= FEWEST:
            stiffness, steps = zip(*sorted(work.items()), strict=True)
            decades = np.log10(np.array(stiffness) / stiffness[0])
            per_decade, at_first = map(float, np.polyfit(decades, steps, 1))
            power = float(np.polyfit(decades, np.log10(steps), 1)[0])
            found.append(WorkGrowth(*key, stiffness, steps, at_first, per_decade, power))
    return found


# Heat maps


def draw(cells: Sequence[Cell], numbers: dict[tuple[str, str], int]) -> Drawing:
    """The map of one solver; ``numbers`` are those of the cases, by axis and label."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    axes_names = list(dict.fromkeys(cell.axis for cell in cells))
    rows = {name: [cell for cell in cells if cell.axis == name] for name in axes_names}
    widest = max(len(row) for row in rows.values())
    figure, axes = drawing((2.2 + 0.36 * widest, 0.9 + 0.42 * len(rows)))
    colours = ScalarMappable(Normalize(LEAST, MOST), colormaps["cividis"])
    for down, name in enumerate(axes_names):
        for across, cell in enumerate(rows[name]):
            _field(axes, across, down, cell, numbers[cell.axis, cell.label], colours)
    axes.set_xlim(0, widest)
    axes.set_ylim(len(rows), 0)
    axes.set_yticks([down + 0.5 for down in range(len(rows))], axes_names, color=INK)
    axes.set_xticks([])
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    bar = figure.colorbar(colours, ax=axes, shrink=0.8, pad=0.01, extend="both")
    bar.set_label("relative error", color=INK)
    bar.set_ticks([-8, -6, -4, -2, 0], labels=["1e-8", "1e-6", "1e-4", "1e-2", "1"], color=INK)
    return figure


def level(cell: Cell) -> float | None:
    """``log10`` of the error within the range of the colours; ``None`` without an error."""
    error = cell.error
    if error is None:
        return None
    if error <= 0.0:
        return LEAST
    return min(max(math.log10(error), LEAST), MOST) if math.isfinite(error) else MOST


def letter(cell: Cell) -> str:
    """How the run ended."""
    return "?" if cell.verdict is CellVerdict.UNKNOWN else LETTERS.get(cell.outcome, "?")


def _field(axes: Axes, across: int, down: int, cell: Cell, number: int, colours) -> None:
    from matplotlib.patches import Rectangle

    value = level(cell)
    colour = BLANK if value is None else colours.to_rgba(value)
    axes.add_patch(Rectangle((across + 0.04, down + 0.06), 0.92, 0.88, facecolor=colour, linewidth=0))
    light = value is None or value > 0.55 * LEAST + 0.45 * MOST
    ink = "#000000" if light else "#ffffff"
    axes.text(across + 0.5, down + 0.45, letter(cell), ha="center", va="center", fontsize=9, color=ink)
    axes.text(across + 0.9, down + 0.86, str(number), ha="right", va="center", fontsize=5.5, color=ink)
    if cell.verdict is CellVerdict.DECLINED:
        axes.plot([across + 0.25, across + 0.75], [down + 0.7, down + 0.7], color=ink, linewidth=1.2)
    if cell.fault:
        frame = Rectangle((across + 0.08, down + 0.1), 0.84, 0.8, fill=False, edgecolor=FAULT, linewidth=2.2)
        axes.add_patch(frame)
        axes.plot([across + 0.12, across + 0.88], [down + 0.86, down + 0.14], color=FAULT, linewidth=1.6)
