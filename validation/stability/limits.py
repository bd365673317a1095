"""What the matrix found, in words: where a solver holds, where it gives up, where it costs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from validation.stability.growth import fit
from validation.stability.verdict import Cell, Verdict

UNBALANCED = 0.05  # of the largest energy: beyond this a run's own energy terms are not to be relied on


def limits(cells: Sequence[Cell]) -> list[str]:
    """Sentences, the gravest first."""
    said = [_counted(cells)]
    said += [f"{cell.verdict}: {cell.name}: {_found(cell)}" for cell in cells if cell.fault]
    for solver in dict.fromkeys(cell.solver for cell in cells):
        own = [cell for cell in cells if cell.solver == solver]
        said += _of(solver, own)
    unknown = [cell.name for cell in cells if cell.verdict is Verdict.UNKNOWN]
    if unknown:
        said.append(f"Not judged, the truth is missing: {'; '.join(unknown)}.")
    growths = fit(cells)
    fast = [growth for growth in growths if not growth.logarithmic]
    if growths:
        said.append(
            f"Work grows no faster than the logarithm of the stiffness in {len(growths) - len(fast)} of "
            f"{len(growths)} series (steps and rejected steps; at most 1 + decades times the first)."
        )
    return said + [growth.words for growth in fast]


def _of(solver: str, cells: Sequence[Cell]) -> list[str]:
    said = []
    silent = [cell for cell in cells if cell.verdict is Verdict.SAYS]
    if silent:
        named = "; ".join(f"{cell.axis}, {cell.label} ({cell.outcome})" for cell in silent)
        said.append(f"{solver} says that it has no answer: {named}.")
    judged = [cell for cell in cells if cell.verdict is Verdict.MEETS and cell.errors and cell.tolerance]
    if judged:
        worst = max(judged, key=lambda cell: (cell.error or 0.0) / cell.tolerance)
        said.append(
            f"{solver} comes closest to its tolerance at {worst.axis}, {worst.label}: "
            f"{worst.worst} {worst.error:.1e} of {worst.tolerance:.1e}."
        )
    loose = [cell for cell in cells if cell.residual is not None and cell.residual > UNBALANCED]
    if loose:
        most = max(loose, key=lambda cell: cell.residual or 0.0)
        said.append(
            f"{solver}: in {len(loose)} of {len(cells)} cells its energy terms, each integrated alone, miss "
            f"the balance by more than {UNBALANCED:.0%} of the largest; most at {most.axis}, {most.label} "
            f"({most.residual:.0%})."
        )
    slow = max(cells, key=lambda cell: cell.seconds)
    said.append(
        f"{solver} took longest at {slow.axis}, {slow.label}: {slow.seconds:.1f} s, {slow.steps} steps."
    )
    return said


def _counted(cells: Sequence[Cell]) -> str:
    counts = Counter(cell.verdict for cell in cells)
    return f"{len(cells)} cells: " + ", ".join(
        f"{counts[verdict]} {verdict}" for verdict in Verdict if counts[verdict] or verdict is Verdict.WRONG
    )


def _found(cell: Cell) -> str:
    if cell.errors:
        return f"{cell.worst} off by {cell.error:.2g}, tolerance {cell.tolerance:.1e} ({cell.outcome})"
    return f"{cell.outcome}: {cell.reason}"
