"""What moved since an earlier report."""

from __future__ import annotations

from validation.compare.regression import Move, ReportComparison
from validation.report.document import (
    ABSENT,
    Bullets,
    DataTable,
    Paragraph,
    Record,
    Section,
    VerdictCell,
    formatted,
    number,
    plain,
)

MOST = 20  # moves a summary lists, unless more are beyond tolerance


def section(baseline: ReportComparison) -> Section:
    """All moves."""
    return Section("Since the baseline", (*_heading(baseline), *_listed(baseline.moves)))


def summary(baseline: ReportComparison) -> Section:
    """All that count and the largest of the rest."""
    shown = baseline.moves[: max(len(baseline.beyond), MOST)]
    more = len(baseline.moves) - len(shown)
    rest = (Paragraph(f"{more} smaller moves are in report.json."),) if more else ()
    return Section("Since the baseline", (*_heading(baseline), *_listed(shown), *rest))


def _heading(baseline: ReportComparison) -> tuple[Bullets | Paragraph, ...]:
    changes = (Bullets(baseline.changes),) if baseline.changes else ()
    return (*changes, Paragraph(baseline.verdict))


def _listed(moves: tuple[Move, ...]) -> tuple[DataTable, ...]:
    return (DataTable.of(map(_cells, moves)),) if moves else ()


def _cells(move: Move) -> Record:
    return {
        "scene": move.scene,
        "solver": move.solver or ABSENT,
        "what": plain(move.what),
        "before": number(move.before, 8),
        "after": number(move.after, 8),
        "change": formatted(move.change, "+.1e"),
        "tolerance": formatted(move.tolerance, ".0e"),
        "beyond": VerdictCell("BEYOND" if move.beyond else "no", not move.beyond),
    }
