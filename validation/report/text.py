"""Numbers and tables as plain text, the same wording in every form of the report."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from validation.measure.dimensionless import SYMBOLS
from validation.measure.skipped_work import in_words

if TYPE_CHECKING:
    from validation.compare.regression import Move
    from validation.compare.suite import SceneComparison
    from validation.measure.check import Check

NONE = "–"
HEAD = (
    "solver", "quantity", "found", "expected", "difference", "estimates", "tolerance", "verdict", "source"
)  # fmt: skip


def number(value: object, digits: int = 6) -> str:
    """A number with enough digits to see a difference; words as they are."""
    if value is None:
        return NONE
    if isinstance(value, float):
        return format(value, f".{digits}g")
    return str(value)


def row(check: Check) -> tuple[str, ...]:
    """One verdict, in the order of ``HEAD``."""
    unit = SYMBOLS[check.unit]
    relation = {"<=": "≤ ", ">=": "≥ "}.get(check.relation, "")
    expected = relation + number(check.expected)
    source = check.source if not check.note else f"{check.source}; {check.note}"
    return (
        check.solver,
        f"{check.quantity.replace('_', ' ')} / {unit}" if unit else check.quantity.replace("_", " "),
        number(check.found),
        expected,
        NONE if check.difference is None else format(check.difference, "+.1e"),
        _estimates(check),
        NONE if check.tolerance is None else format(check.tolerance, ".0e"),
        "pass" if check.passed else ("missing" if check.found is None else "FAIL"),
        source,
    )


def _estimates(check: Check) -> str:
    """What the solver says of its own error, and what the reference says of its own."""
    if check.estimate is None or check.base_estimate is None:
        return NONE
    return f"{check.estimate:.1e} + {check.base_estimate:.1e}"


MOVE_HEAD = ("scene", "solver", "what", "before", "after", "change", "tolerance", "beyond")


def move_row(move: Move) -> tuple[str, ...]:
    """One difference from an earlier report, in the order of ``MOVE_HEAD``."""
    return (
        move.scene,
        move.solver or NONE,
        move.what.replace("_", " "),
        number(move.before, 8),
        number(move.after, 8),
        NONE if move.change is None else format(move.change, "+.1e"),
        NONE if move.tolerance is None else format(move.tolerance, ".0e"),
        "BEYOND" if move.beyond else "no",
    )


def table(page: SceneComparison) -> str:
    """All verdicts on a scene in aligned columns."""
    rows = [HEAD, *(row(check) for check in page.checks)]
    widths = [max(len(line[i]) for line in rows) for i in range(len(HEAD))]
    lines = [f"{page.case.name}: {page.case.scene.title}"]
    lines += [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in rows
    ]
    return "\n".join(lines) + "\n"


def spared_by(page: SceneComparison) -> str:
    """What the solvers left out because the scene did not need it."""
    work = {solver: asdict(run.trace.counters) for solver, run in page.runs.items() if run.trace is not None}
    return in_words(work) if work else "No run has counters of its work."


def parameters(page: SceneComparison) -> list[tuple[str, str]]:
    """What the scene consists of, as name and value."""
    scene = page.case.scene
    material = scene.material
    branches = ", ".join(f"{b.modulus:g} (τ = {b.time:g})" for b in material.branches) or "none: elastic"
    shape = ", ".join(
        f"{name.replace('_', ' ')} {value:g}"
        for name, value in vars(scene.indenter).items()
        if isinstance(value, float)
    )
    steps = "; ".join(
        step.kind
        + " "
        + ", ".join(
            f"{name.replace('_', ' ')} {value:g}"
            for name, value in vars(step).items()
            if isinstance(value, float)
        )
        for step in scene.loading.steps
    )
    rows = [
        ("relaxed modulus E₀", f"{material.modulus:g}"),
        ("branches", branches if len(material.branches) <= 8 else f"{len(material.branches)} branches"),
        ("Poisson's ratio", f"{material.poisson:g}"),
        ("indenter", f"{scene.indenter.shape}{', ' + shape if shape else ''}"),
        ("start", f"{scene.loading.start} at penetration {scene.loading.penetration:g}"),
        ("loading", steps or "none"),
    ]
    if scene.adhesion is not None:
        rows[4:4] = [
            ("work of adhesion", f"{scene.adhesion.work:g}"),
            ("process zone", f"{scene.adhesion.zone:g}"),
        ]
    return rows
