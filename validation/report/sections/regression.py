"""What moved since an earlier report."""

from __future__ import annotations

from validation.compare.regression import Comparison, Move
from validation.report.document import ABSENT, Paragraph, Section, Table, VerdictCell, number, plain
from validation.report.sections.checks import signed

HEAD = ("scene", "solver", "what", "before", "after", "change", "tolerance", "beyond")
MOST = 20  # moves a summary lists, unless more are beyond tolerance


def section(baseline: Comparison) -> Section:
    """All moves."""
    return Section("Since the baseline", (Paragraph(baseline.verdict), *_listed(baseline.moves)))


def summary(baseline: Comparison) -> Section:
    """All that count and the largest of the rest."""
    shown = baseline.moves[: max(len(baseline.beyond), MOST)]
    more = len(baseline.moves) - len(shown)
    rest = (Paragraph(f"{more} smaller moves are in report.json."),) if more else ()
    return Section("Since the baseline", (Paragraph(baseline.verdict), *_listed(shown), *rest))


def _listed(moves: tuple[Move, ...]) -> tuple[Table, ...]:
    return (Table(HEAD, tuple(map(_row, moves))),) if moves else ()


def _row(move: Move) -> tuple[str | VerdictCell, ...]:
    return (
        move.scene,
        move.solver or ABSENT,
        plain(move.what),
        number(move.before, 8),
        number(move.after, 8),
        signed(move.change),
        ABSENT if move.tolerance is None else format(move.tolerance, ".0e"),
        VerdictCell("BEYOND" if move.beyond else "no", not move.beyond),
    )
