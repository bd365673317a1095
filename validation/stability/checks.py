"""What the matrix has to fulfil: no cell at fault, one check for every axis and solver."""

from __future__ import annotations

from collections.abc import Sequence

from validation.measure.check import Check
from validation.stability.verdict import Cell


def checks(cells: Sequence[Cell]) -> list[Check]:
    """One check for every axis and solver, in the order of the cells."""
    groups: dict[tuple[str, str], list[Cell]] = {}
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
