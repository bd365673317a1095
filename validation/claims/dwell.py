"""Claims of Sec. III on a rest between approach and retraction (dwell-time figure)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from validation.claims.claim import HOLDS, IN_PART, Part, claim
from validation.claims.evidence import DEPTH, DWELL_SPEEDS, DWELLS, Evidence, cycle, retraction
from validation.claims.measures import RECOVERED, crossing, rising
from validation.measure.events import end_of_approach

SPEED = 0.1
"""Speed of the cycles whose rest varies."""
PLACE = "Sec. III, dwell-time figure"
RELAXED = 0.9
"""Share of the relaxed contact's pull-off force at which a rest counts as complete."""
SAME = 5e-4
"""Relative difference within which two approaches are the same: the solver's accuracy, since the annuli are
chosen for the scene and finer where it rests."""


@claim(PLACE, "The approach is not affected by the rest that follows.", HOLDS)
def approach_does_not_know(evidence: Evidence) -> list[Part]:
    """Force at the end of the approach, rest by rest."""
    traces = [evidence.trace(cycle(SPEED, dwell=dwell)) for dwell in DWELLS]
    force = np.array([trace.force[end_of_approach(trace)] for trace in traces])
    spread = float(np.ptp(force) / force.mean())
    return [Part(f"force at its end the same to {spread:.1e} for {len(DWELLS)} rests", spread < SAME)]


@claim(PLACE, "At V = 0.1 a rest longer than τ raises the pull-off force, the more the longer.", HOLDS)
def longer_rest_holds_more(evidence: Evidence) -> list[Part]:
    """Pull-off over the rest at one speed."""
    values = dict(zip(DWELLS, (evidence.pull_off(cycle(SPEED, dwell=d)) for d in DWELLS), strict=True))
    beyond = [value for dwell, value in values.items() if dwell >= 1.0]
    shown = ", ".join(f"{value:.3f} at {dwell:g}" for dwell, value in values.items())
    return [
        Part(
            f"F_off/F_JKR {shown}",
            rising(beyond) and beyond[-1] > beyond[0],
            {f"dwell_{dwell:g}": value for dwell, value in values.items()},
        )
    ]


@claim(
    PLACE,
    "After a rest much longer than τ the retraction approaches that of the relaxed contact (flat punch), "
    "with very large pull-off force.",
    HOLDS,
)
def long_rest_is_relaxed(evidence: Evidence) -> list[Part]:
    """Pull-off after the longest rest against that from the relaxed contact."""
    last, limit = evidence.pull_off(cycle(SPEED, dwell=DWELLS[-1])), evidence.pull_off(retraction(SPEED))
    none = evidence.pull_off(cycle(SPEED))
    return [
        Part(f"{last:.3f} F_JKR after {DWELLS[-1]:g} τ; {limit:.3f} from the relaxed contact",
             abs(last / limit - 1) <= RECOVERED, {"last": last, "limit": limit}),
        Part(f"{none:.3f} without rest", last > 2.0 * none, {"none": none}),
    ]  # fmt: skip


@claim(
    PLACE,
    "The faster the approach and retraction, the longer the rest it takes to relax and to enter the "
    "flat-punch regime.",
    IN_PART,
)
def faster_needs_longer_rest(evidence: Evidence) -> list[Part]:
    """Rest after which pull-off reaches nine tenths of the relaxed contact's, speed by speed."""
    needed = {speed: _rest_needed(evidence, speed) for speed in DWELL_SPEEDS}
    parts = []
    for slow, fast in pairwise(DWELL_SPEEDS):
        a, b = needed[slow], needed[fast]
        parts.append(
            Part(
                f"rest for {RELAXED:.0%} of the relaxed contact's pull-off force: {_shown(a)} at V = "
                f"{slow:g}, {_shown(b)} at V = {fast:g}",
                a is not None and b is not None and b > 1.1 * a,
                {f"rest_{v:g}": rest for v, rest in ((slow, a), (fast, b)) if rest is not None},
            )
        )
    return parts


def _rest_needed(evidence: Evidence, speed: float) -> float | None:
    """Rest after which pull-off has reached its share of the relaxed contact's."""
    limit = evidence.pull_off(retraction(speed, DEPTH))
    reached = [evidence.pull_off(cycle(speed, dwell=d)) / limit for d in DWELLS[1:]]
    return crossing(DWELLS[1:], reached, RELAXED)


def _shown(rest: float | None) -> str:
    return "none in the sweep" if rest is None else f"{rest:.2f} τ"


CLAIMS = (approach_does_not_know, longer_rest_holds_more, long_rest_is_relaxed, faster_needs_longer_rest)
