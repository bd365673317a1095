"""Claims of Sec. III on approach-retraction cycles (Fig. 2)."""

from __future__ import annotations

import numpy as np

from validation.claims import elastic
from validation.claims.claim import HOLDS, IN_PART, Part, claim
from validation.claims.evidence import CYCLE_SPEEDS, DEPTH, Evidence, cycle
from validation.claims.measures import (
    LARGER,
    RECOVERED,
    STEADY,
    first_slope,
    hysteresis,
    last_slope,
    tension_row,
)
from validation.measure.events import end_of_approach

SLOWEST, FASTEST = CYCLE_SPEEDS[0], CYCLE_SPEEDS[-1]
QUOTED_SLOW = 2e-5
"""Speed that the paper names as slow enough for a soft elastic cycle."""
PLACE = "Sec. III, Fig. 2"


@claim(
    PLACE,
    "Contact begins at zero penetration by a jump that is elastic with the glassy modulus (JKR), whatever "
    "the speed.",
    HOLDS,
)
def jump_in_is_glassy(evidence: Evidence) -> list[Part]:
    """Radius of the first row at every speed, against JKR with and without the finite process zone."""
    starts = [evidence.trace(cycle(speed)) for speed in CYCLE_SPEEDS]
    radii = np.array([trace.contact_radius[0] for trace in starts])
    exact = elastic.vanishing(glassy=True).at_penetration(0.0).contact_radius
    finite = elastic.finite(glassy=True).at_penetration(0.0).contact_radius
    spread = float(np.ptp(radii) / radii.mean())
    return [
        Part(f"start radius the same to {spread:.1e} at {len(radii)} speeds", spread < STEADY),
        Part(
            f"a/R = {radii[0]:.4f}: JKR with E∞ {exact:.4f}, with the finite process zone {finite:.4f}",
            abs(radii[0] / exact - 1.0) < RECOVERED,
            {"start_radius": float(radii[0]), "jkr": exact, "finite_zone": finite},
        ),
    ]


@claim(
    PLACE,
    "At V = 2e-5 the soft elastic JKR response is recovered in approach and retraction, without hysteresis.",
    IN_PART,
)
def slow_cycle_is_soft(evidence: Evidence) -> list[Part]:
    """Force, radius and pull-off against the relaxed elastic contact, hysteresis against its largest."""
    trace, soft = evidence.trace(cycle(QUOTED_SLOW)), elastic.finite(glassy=False)
    row, known = end_of_approach(trace), soft.at_penetration(DEPTH)
    force, radius = trace.force[row] / known.force, trace.contact_radius[row] / known.contact_radius
    pull = evidence.pull_off(cycle(QUOTED_SLOW)) / elastic.pull_off(glassy=False)
    slower = evidence.pull_off(cycle(SLOWEST)) / elastic.pull_off(glassy=False)
    ratio = _hysteresis(evidence, QUOTED_SLOW)
    return [
        Part(f"force at the end of approach {force:.4f} of the soft value", abs(force - 1) <= RECOVERED),
        Part(f"contact radius there {radius:.4f} of it", abs(radius - 1) <= RECOVERED),
        Part(
            f"pull-off force {pull:.3f} of the soft value (at V = {SLOWEST:g}: {slower:.3f})",
            abs(pull - 1) <= RECOVERED,
            {"pull_off_ratio": pull, "pull_off_ratio_slowest": slower},
        ),
        Part(f"hysteresis {ratio:.3f} of its largest over V", ratio <= RECOVERED, {"hysteresis": ratio}),
    ]


@claim(
    PLACE, "At V >> 1 the glassy elastic JKR response is recovered, with vanishing hysteresis.", HOLDS
)  # fmt: skip
def fast_cycle_is_glassy(evidence: Evidence) -> list[Part]:
    """Force, pull-off and hysteresis against the glassy elastic contact with the same process zone."""
    parts = []
    stiff = elastic.finite(glassy=True)
    for speed in (10.0, FASTEST):
        trace, known = evidence.trace(cycle(speed)), stiff.at_penetration(DEPTH)
        row = end_of_approach(trace)
        force = trace.force[row] / known.force
        pull = evidence.pull_off(cycle(speed)) / elastic.pull_off(glassy=True)
        ratio = _hysteresis(evidence, speed)
        parts += [
            Part(f"V = {speed:g}: force at the end of approach {force:.4f} of the stiff value",
                 abs(force - 1) <= RECOVERED, {f"force_{speed:g}": force}),
            Part(f"pull-off force {pull:.4f} of "
            "it", abs(pull - 1) <= RECOVERED, {f"pull_off_{speed:g}": pull}),
            Part(f"hysteresis {ratio:.3f} of its largest over "
            "V", ratio <= RECOVERED, {f"hysteresis_{speed:g}": ratio}),
        ]  # fmt: skip
    return parts


@claim(PLACE, "In both elastic limits the pull-off force is the same, independent of the modulus.", HOLDS)
def limits_share_the_pull_off_force(evidence: Evidence) -> list[Part]:
    """The slowest cycle against the fastest; the finite process zone alone sets them 3 % apart."""
    slow, fast = evidence.pull_off(cycle(SLOWEST)), evidence.pull_off(cycle(FASTEST))
    zone = [elastic.pull_off(glassy) for glassy in (False, True)]
    return [
        Part(
            f"{slow:.4f} F_JKR at V = {SLOWEST:g}, {fast:.4f} at V = {FASTEST:g}; the finite process zone "
            f"makes it {zone[0]:.4f} and {zone[1]:.4f}, exactly 1 for both only as it vanishes",
            abs(fast / slow - 1.0) <= RECOVERED,
            {"slow": slow, "fast": fast},
        )
    ]


@claim(
    PLACE,
    "At intermediate speed viscoelastic loss makes a large adhesive hysteresis, and tensile loads are "
    "significantly larger than elastic ones.",
    HOLDS,
)
def intermediate_cycles_lose_and_hold(evidence: Evidence) -> list[Part]:
    """Where over the speeds hysteresis and largest tension peak, and how far they fall to both ends."""
    losses = [hysteresis(evidence.trace(cycle(speed))) for speed in CYCLE_SPEEDS]
    pulls = [evidence.pull_off(cycle(speed)) for speed in CYCLE_SPEEDS]
    loud, strong = int(np.argmax(losses)), int(np.argmax(pulls))
    ends = max(losses[0], losses[-1]) / losses[loud]
    return [
        Part(
            f"hysteresis largest at V = {CYCLE_SPEEDS[loud]:g}, at the ends of the sweep at most "
            f"{ends:.3f} of it",
            0 < loud < len(losses) - 1 and ends < 0.5,
            {"speed": CYCLE_SPEEDS[loud]},
        ),
        Part(
            f"largest tension {pulls[strong]:.3f} F_JKR at V = {CYCLE_SPEEDS[strong]:g}",
            0 < strong < len(pulls) - 1 and pulls[strong] > LARGER,
            {"pull_off": pulls[strong], "speed": CYCLE_SPEEDS[strong]},
        ),
    ]


@claim(
    PLACE,
    "Pull-off can occur farther out than in the elastic case, and at larger speed even at positive "
    "penetration.",
    HOLDS,
)
def where_pull_off_occurs(evidence: Evidence) -> list[Part]:
    """Penetration at the largest tension, against JKR's under force control."""
    soft = elastic.vanishing(glassy=False).pull_off_force_control().penetration
    at = {v: evidence.measure(cycle(v), "pull_off_penetration") for v in CYCLE_SPEEDS}
    farther = [v for v, depth in at.items() if depth < LARGER * soft]
    inside = [v for v, depth in at.items() if depth > 0.0]
    return [
        Part(
            f"farther out than JKR with E₀ (Δ/R = {soft:.5f}) at V = {_list(farther)}; farthest "
            f"{min(at.values()):.5f}",
            bool(farther),
            {"farthest": min(at.values()), "jkr": soft},
        ),
        Part(f"at positive penetration at V = {_list(inside)}", bool(inside)),
    ]


@claim(
    PLACE,
    "Where pull-off comes at positive penetration, the material has not been glassy while approaching; the "
    "reversal triggers the glassy modulus.",
    HOLDS,
)
def reversal_triggers_glass(evidence: Evidence) -> list[Part]:
    """Force and tangent about the reversal; 2 a E* is the tangent of a still edge."""
    parts = []
    soft, stiff = (elastic.finite(glassy).at_penetration(DEPTH).force for glassy in (False, True))
    soft_slope = elastic.modulus(glassy=False) / elastic.modulus(glassy=True)
    for speed in (0.02, 0.05, 0.1):
        trace = evidence.trace(cycle(speed))
        row = end_of_approach(trace)
        share = (trace.force[row] - soft) / (stiff - soft)
        glass = 2.0 * trace.contact_radius[row] * elastic.modulus(glassy=True)
        slope = 0.5 * (last_slope(trace) + first_slope(trace)) / glass  # what relaxes meanwhile cancels
        parts += [
            Part(f"V = {speed:g}: force at reversal {share:.2f} of the way from soft to stiff", share < 0.95),
            Part(
                f"mean slope before and after it {slope:.3f} of 2 a E∞*, nearer to that than to 2 a E₀*",
                slope > 0.5 * (1.0 + soft_slope),
                {f"slope_{speed:g}": slope},
            ),
        ]
    return parts


@claim(
    PLACE,
    "Pull-off at positive penetration comes with a contact area and a tension much larger than elastic ones.",
    IN_PART,
)
def pull_off_inside_is_large(evidence: Evidence) -> list[Part]:
    """Area and tension against JKR's pull-off at every speed that pulls off at positive penetration."""
    exact = elastic.vanishing(glassy=False).pull_off_force_control()
    parts = []
    for speed in CYCLE_SPEEDS:
        trace = evidence.trace(cycle(speed))
        row = tension_row(trace)
        if trace.penetration[row] <= 0.0:
            continue
        area = (trace.contact_radius[row] / exact.contact_radius) ** 2
        force = evidence.pull_off(cycle(speed))
        parts.append(
            Part(
                f"V = {speed:g}: area {area:.2f}, tension {force:.2f} times JKR's with E₀",
                area > LARGER and force > LARGER,
                {f"area_{speed:g}": area, f"force_{speed:g}": force},
            )
        )
    return parts


def _hysteresis(evidence: Evidence, speed: float) -> float:
    largest = max(hysteresis(evidence.trace(cycle(v))) for v in CYCLE_SPEEDS)
    return hysteresis(evidence.trace(cycle(speed))) / largest


def _list(speeds: list[float]) -> str:
    return ", ".join(f"{v:g}" for v in speeds) or "none"


CLAIMS = (
    jump_in_is_glassy,
    slow_cycle_is_soft,
    fast_cycle_is_glassy,
    limits_share_the_pull_off_force,
    intermediate_cycles_lose_and_hold,
    where_pull_off_occurs,
    reversal_triggers_glass,
    pull_off_inside_is_large,
)
