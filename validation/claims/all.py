"""All statements of the paper, in its order, and their judgement."""

from __future__ import annotations

from validation.claims import cycles, dwell, force, model, oscillations, preload, relaxed, release, surface
from validation.claims.claim import Claim, Finding
from validation.claims.evidence import Evidence

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


def judge(found: Evidence) -> tuple[Finding, ...]:
    """Every claim judged on the same runs."""
    return tuple(one.judged(found) for one in CLAIMS)
