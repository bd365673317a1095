"""Checks as rows of a table, the same in every form."""

from __future__ import annotations

from collections.abc import Iterable

from validation.compare.checks import Check
from validation.measure.dimensionless import SYMBOLS
from validation.report.document import ABSENT, Table, VerdictCell, number, plain

HEAD = (
    "solver", "quantity", "found", "expected", "difference", "estimates", "tolerance", "verdict", "source"
)  # fmt: skip
_RELATIONS = {"<=": "≤ ", ">=": "≥ "}


def table(checks: Iterable[Check], with_scene: bool = False) -> Table:
    """A row for each check; ``with_scene`` adds a column for its scene."""
    rows = tuple(((check.scene,) if with_scene else ()) + _marked(check) for check in checks)
    return Table((("scene",) if with_scene else ()) + HEAD, rows, unbroken=("estimates",))


def _marked(check: Check) -> tuple[str | VerdictCell, ...]:
    texts = cells(check)
    at = HEAD.index("verdict")
    return (*texts[:at], VerdictCell(texts[at], check.passed), *texts[at + 1 :])


def cells(check: Check) -> tuple[str, ...]:
    """One check in words and numbers, in the order of ``HEAD``."""
    unit = SYMBOLS[check.unit]
    quantity = plain(check.quantity)
    return (
        check.solver,
        f"{quantity} / {unit}" if unit else quantity,
        number(check.found),
        _RELATIONS.get(check.relation, "") + number(check.expected),
        signed(check.difference),
        estimates(check.estimate, check.base_estimate),
        ABSENT if check.tolerance is None else format(check.tolerance, ".0e"),
        "pass" if check.passed else ("missing" if check.found is None else "FAIL"),
        f"{check.source}; {check.note}" if check.note else check.source,
    )


def signed(difference: float | None) -> str:
    """A relative difference with its sign."""
    return ABSENT if difference is None else format(difference, "+.1e")


def estimates(own: float | None, base: float | None) -> str:
    """Relative error estimates of a run and of what it is compared with."""
    return ABSENT if own is None or base is None else f"{own:.1e} + {base:.1e}"
