"""How the work grows with stiffness: steps against its logarithm, within every series of cases."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from validation.stability.verdict import Cell, CellVerdict

FEWEST = 3
"""Least number of stiffnesses that a slope is fitted to."""


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
