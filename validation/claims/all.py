"""All statements of the paper, in its order, and their evaluation."""

from __future__ import annotations

from collections.abc import Iterable

from validation.claims import cycles, dwell, force, model, oscillations, preload, relaxed, release, surface
from validation.claims.claim import Claim, Finding, Verdict
from validation.claims.evidence import SOLVER, Evidence
from validation.measure.difference import Check

CLAIMS: tuple[Claim, ...] = (
    *model.CLAIMS,
    *cycles.CLAIMS,
    *surface.CLAIMS,
    *relaxed.CLAIMS,
    *preload.CLAIMS,
    *dwell.CLAIMS,
    *force.CLAIMS,
    *oscillations.CLAIMS,
    *release.CLAIMS,
)


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """Every claim evaluated on the same runs."""
    return tuple(statement.finding(evidence) for statement in CLAIMS)


def checks(results: Iterable[Finding]) -> list[Check]:
    """One check a statement: that its verdict is the recorded one."""
    return [
        Check(
            "claims",
            SOLVER,
            result.name,
            result.place,
            str(result.recorded),
            None if result.verdict is Verdict.NOT_EVALUATED else str(result.verdict),
            not result.changed,
            note=result.shown if result.changed else "",
        )
        for result in results
    ]
