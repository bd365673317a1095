"""Checks that the paper's statements and the stiff and extreme matrix add to a report."""

from __future__ import annotations

from dataclasses import dataclass

from validation.claims.claim import Finding, Verdict
from validation.claims.evidence import Evidence
from validation.compare.checks import Check
from validation.stability.runner import Matrix
from validation.stability.verdict import Cell

COUNTED = dict(zip(Verdict, ("hold", "hold in part", "do not hold", "could not be judged"), strict=True))


@dataclass(frozen=True)
class Claims:
    """The findings, and the runs they rest on."""

    findings: tuple[Finding, ...]
    evidence: Evidence

    @property
    def checks(self) -> list[Check]:
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
            for one in self.findings
        ]

    @property
    def summary(self) -> str:
        """How many hold, and how many not."""
        counts = {verdict: sum(one.verdict is verdict for one in self.findings) for verdict in Verdict}
        verdicts = ", ".join(f"{count} {COUNTED[verdict]}" for verdict, count in counts.items() if count)
        changed = sum(one.changed for one in self.findings)
        changes = "no verdict" if not changed else f"{changed} verdict{'s' if changed > 1 else ''}"
        return f"{len(self.findings)} statements: {verdicts}; {changes} changed."


def stability_checks(matrix: Matrix) -> list[Check]:
    """One check for every axis and solver: no cell of it is at fault."""
    groups: dict[tuple[str, str], list[Cell]] = {}
    for cell in matrix.cells:
        groups.setdefault((cell.axis, cell.solver), []).append(cell)
    return [
        Check(
            "stability",
            solver,
            f"faults: {axis}",
            "within tolerance, or said that there is no answer",
            0.0,
            float(sum(cell.fault for cell in cells)),
            not any(cell.fault for cell in cells),
            relation="<=",
            note="; ".join(f"{cell.label}: {cell.verdict}" for cell in cells if cell.fault),
        )
        for (axis, solver), cells in groups.items()
    ]
