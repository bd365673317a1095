"""Checks as rows of a table, the same in every form."""

from __future__ import annotations

from collections.abc import Iterable

from validation.measure.check import Check
from validation.measure.dimensionless import SYMBOLS
from validation.report.document import ABSENT, DataTable, Record, VerdictCell, formatted, number, plain

_RELATIONS = {"<=": "≤ ", ">=": "≥ "}


def table(checks: Iterable[Check], with_scene: bool = False) -> DataTable:
    """A row for each check; ``with_scene`` adds a column for its scene."""
    rows = ({**({"scene": check.scene} if with_scene else {}), **cells(check)} for check in checks)
    return DataTable.of(rows, unbroken=("estimates",))


def cells(check: Check) -> Record:
    """One check in words and numbers, by the title of the column."""
    unit = SYMBOLS[check.unit]
    verdict = "pass" if check.passed else ("missing" if check.found is None else "FAIL")
    return {
        "solver": check.solver,
        "quantity": plain(check.quantity) + (f" / {unit}" if unit else ""),
        "found": number(check.found),
        "expected": _RELATIONS.get(check.relation, "") + number(check.expected),
        "difference": formatted(check.difference, "+.1e"),
        "estimates": estimates(check.estimate, check.base_estimate),
        "tolerance": formatted(check.tolerance, ".0e"),
        "verdict": VerdictCell(verdict, check.passed),
        "source": f"{check.source}; {check.note}" if check.note else check.source,
    }


def estimates(own: float | None, base: float | None) -> str:
    """Relative error estimates of a run and of what it is compared with."""
    return ABSENT if own is None or base is None else f"{own:.1e} + {base:.1e}"
