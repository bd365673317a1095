"""Limits of the solvers in words: where one is accurate, where it gives no answer, where it is expensive.

The work grows with stiffness: steps against its logarithm, within every series of cases.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from validation.stability.verdict import Cell, CellVerdict

FEWEST = 3
"""Least number of stiffnesses that a slope is fitted to."""
UNBALANCED = 0.05
"""Residual of the energy balance, relative to the largest energy, from which on it is reported."""


def limits(cells: Sequence[Cell]) -> list[str]:
    """Sentences, the most serious first."""
    sentences = [_counted(cells)]
    sentences += [f"{cell.verdict}: {cell.name}: {_error_text(cell)}" for cell in cells if cell.fault]
    for solver in dict.fromkeys(cell.solver for cell in cells):
        own = [cell for cell in cells if cell.solver == solver]
        sentences += _of(solver, own)
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


def _of(solver: str, cells: Sequence[Cell]) -> list[str]:
    sentences = []
    silent = [cell for cell in cells if cell.verdict is CellVerdict.DECLINED]
    if silent:
        named = "; ".join(f"{cell.axis}, {cell.label} ({cell.outcome})" for cell in silent)
        sentences.append(f"{solver} reports no answer: {named}.")
    compared = [
        cell for cell in cells if cell.verdict is CellVerdict.WITHIN and cell.errors and cell.tolerance
    ]
    if compared:
        worst = max(compared, key=lambda cell: (cell.error or 0.0) / cell.tolerance)
        sentences.append(
            f"{solver} comes closest to its tolerance at {worst.axis}, {worst.label}: "
            f"{worst.worst} {worst.error:.1e} of {worst.tolerance:.1e}."
        )
    loose = [cell for cell in cells if cell.residual is not None and cell.residual > UNBALANCED]
    if loose:
        most = max(loose, key=lambda cell: cell.residual or 0.0)
        sentences.append(
            f"{solver}: in {len(loose)} of {len(cells)} cells its energy terms, each integrated alone, miss "
            f"the balance by more than {UNBALANCED:.0%} of the largest; most at {most.axis}, {most.label} "
            f"({most.residual:.0%})."
        )
    slow = max(cells, key=lambda cell: cell.seconds)
    sentences.append(
        f"{solver} took longest at {slow.axis}, {slow.label}: {slow.seconds:.1f} s, {slow.steps} steps."
    )
    return sentences


def _counted(cells: Sequence[Cell]) -> str:
    counts = Counter(cell.verdict for cell in cells)
    return f"{len(cells)} cells: " + ", ".join(
        f"{counts[verdict]} {verdict}"
        for verdict in CellVerdict
        if counts[verdict] or verdict is CellVerdict.WRONG
    )


def _error_text(cell: Cell) -> str:
    if cell.errors:
        return f"{cell.worst} off by {cell.error:.2g}, tolerance {cell.tolerance:.1e} ({cell.outcome})"
    return f"{cell.outcome}: {cell.reason}"


@dataclass(frozen=True)
class WorkGrowth:
    """Steps (rejected ones included) of one solver along one series.

    Parameters
    ----------
    stiffness, steps : tuple of float
        Rising stiffness, and the work there.
    at_first, per_decade : float
        ``steps = at_first + per_decade * log10(stiffness/first)``, least squares.
    power : float
        Slope of ``log(steps)`` over ``log(stiffness)``.
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
        first = self.stiffness[0]
        return all(
            steps <= self.steps[0] * (1.0 + math.log10(stiffness / first))
            for stiffness, steps in zip(self.stiffness, self.steps, strict=True)
        )

    @property
    def words(self) -> str:
        """One sentence."""
        decades = math.log10(self.stiffness[-1] / self.stiffness[0])
        verdict = "no faster than logarithmic" if self.logarithmic else "FASTER than logarithmic"
        return (
            f"{self.axis}, {self.series}, {self.solver}: {self.steps[0]} to {self.steps[-1]} steps over "
            f"{decades:.0f} decades, {self.per_decade:+.1f} a decade (power {self.power:+.3f}): {verdict}."
        )


def work_growth(cells: Iterable[Cell]) -> list[WorkGrowth]:
    """Every series of every solver, from the cells that have an answer within tolerance."""
    series_steps: dict[tuple[str, str, str], dict[float, int]] = defaultdict(dict)
    for cell in cells:
        if cell.series and cell.verdict is CellVerdict.WITHIN and cell.steps:
            series_steps[cell.axis, cell.series, cell.solver][cell.stiffness] = (
                cell.steps + cell.rejected_steps
            )
    return [_growth_of(*key, work) for key, work in series_steps.items() if len(work) >= FEWEST]


def _growth_of(axis: str, series: str, solver: str, work: dict[float, int]) -> WorkGrowth:
    stiffness, steps = zip(*sorted(work.items()), strict=True)
    decades = np.log10(np.array(stiffness) / stiffness[0])
    per_decade, at_first = np.polyfit(decades, steps, 1)
    power = np.polyfit(decades, np.log10(steps), 1)[0]
    return WorkGrowth(
        axis, series, solver, stiffness, steps, float(at_first), float(per_decade), float(power)
    )
