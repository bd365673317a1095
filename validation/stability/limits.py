"""Limits of the solvers in words: where one is accurate, where it gives no answer, where it is expensive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from validation.stability.growth import work_growth
from validation.stability.verdict import Cell, CellVerdict

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
