"""Checks that the paper's statements and the stiff and extreme matrix add to a report."""

from __future__ import annotations

from collections.abc import Iterable

from validation.claims.claim import Finding, Verdict
from validation.compare.checks import Check
from validation.stability.verdict import Cell


def claim_checks(findings: Iterable[Finding]) -> list[Check]:
    """One check a statement: that its verdict is the recorded one."""
    return [
        Check(
            "claims",
            "bem",
            one.name,
            one.place,
            str(one.recorded),
            None if one.verdict is Verdict.NOT_JUDGED else str(one.verdict),
            not one.changed,
            note=one.shown if one.changed else "",
        )
        for one in findings
    ]


def stability_checks(cells: Iterable[Cell]) -> list[Check]:
    """One check for every axis and solver: no cell of it is at fault."""
    groups: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.axis, cell.solver), []).append(cell)
    return [
        Check(
            "stability",
            solver,
            f"faults: {axis}",
            "within tolerance, or said that there is no answer",
            0.0,
            float(sum(cell.fault for cell in group)),
            not any(cell.fault for cell in group),
            relation="<=",
            note="; ".join(f"{cell.label}: {cell.verdict}" for cell in group if cell.fault),
        )
        for (axis, solver), group in groups.items()
    ]
