"""Claims on how much a preload, and a relaxation under it, add to the pull-off force (Fig. 4 c)."""

from __future__ import annotations

from validation.claims.claim import HOLDS, Part, claim
from validation.claims.evidence import PRELOAD_SPEEDS, PRELOADS, Evidence, cycle, retraction
from validation.claims.measures import RECOVERED, rising

MOST = 10.0
"""``Einf/E0``, the limit of the pull-off force over ``F_JKR``."""


@claim(
    "Sec. III, Fig. 4(c)",
    "With growing initial penetration the enhancement reaches a plateau, F_off/F_JKR ≈ E∞/E₀ at very "
    "high speed.",
    HOLDS,
)
def preload_plateau(evidence: Evidence) -> list[Part]:
    """Pull-off over the initial penetration at the highest speed of the sweep."""
    speed = PRELOAD_SPEEDS[-1]
    values = [evidence.pull_off(retraction(speed, depth)) for depth in PRELOADS]
    shown = ", ".join(f"{v:.2f} at {d:g}" for d, v in zip(PRELOADS, values, strict=True))
    return [
        Part(f"F_off/F_JKR at V = {speed:g}: {shown}: never falls", rising(values, 0.01)),
        Part(
            f"last two {abs(values[-1] / values[-2] - 1):.3f} apart",
            abs(values[-1] / values[-2] - 1) <= RECOVERED,
        ),
        Part(
            f"{values[-1]:.2f} at the end",
            abs(values[-1] / MOST - 1) <= 2 * RECOVERED,
            {"plateau": values[-1]},
        ),
    ]


@claim("Sec. III, Fig. 4(c)", "At every preload a lower speed gives a lower pull-off force.", HOLDS)
def preload_lower_speed_is_weaker(evidence: Evidence) -> list[Part]:
    """Pull-off over the speed at every initial penetration."""
    parts = []
    for depth in PRELOADS:
        values = [evidence.pull_off(retraction(speed, depth)) for speed in PRELOAD_SPEEDS]
        shown = ", ".join(f"{v:.2f}" for v in values)
        parts.append(Part(f"Δ_B = {depth:g}: {shown} F_JKR with rising speed", rising(values, 1e-3)))
    return parts


@claim(
    "Abstract; Sec. III",
    "Retraction after full relaxation enhances the pull-off force even more than approach-retraction "
    "cycles do.",
    HOLDS,
)
def relaxing_first_holds_more(evidence: Evidence) -> list[Part]:
    """Pull-off from the relaxed contact and of the cycle, speed by speed."""
    parts = []
    for speed in (2e-3, 6e-3, 2e-2, 0.1, 10.0):
        with_rest, without = evidence.pull_off(retraction(speed)), evidence.pull_off(cycle(speed))
        parts.append(
            Part(f"V = {speed:g}: {with_rest:.3f} against {without:.3f} F_JKR", with_rest > without * 1.001)
        )
    return parts


CLAIMS = (preload_plateau, preload_lower_speed_is_weaker, relaxing_first_holds_more)
