"""Claims of Sec. III on a constant tension applied at once to the relaxed contact (Fig. 5)."""

from __future__ import annotations

import numpy as np

from validation.cases import load
from validation.claims import elastic
from validation.claims.claim import IN_PART, Part, claim
from validation.claims.evidence import DEPTH, FORCES, MATCHED, Evidence, retraction
from validation.claims.measures import LARGER, RECOVERED, rising
from validation.measure.scaling import unit_sizes
from validation.reference.frozen import FrozenRetraction

PLACE = "Sec. III, Fig. 5"


@claim(
    PLACE,
    "The jump of the load is answered by the glassy flat punch: F0 = F_B - 2 a_B E∞* (Δ_B - Δ0).",
    IN_PART,
)
def jump_is_a_flat_punch(evidence: Evidence) -> list[Part]:
    """Change of penetration across the jump over that of a frozen edge, and the radius after it."""
    scene = load("force-2").scene
    assert scene.adhesion is not None
    frozen = FrozenRetraction(scene.material, scene.indenter, scene.adhesion.work, DEPTH)
    exact = -frozen.release().force / unit_sizes(scene)["jkr-force"]
    parts = [
        Part(
            f"vanishing process zone: exact up to {exact:.3f} F_JKR, where the frozen edge lets go",
            exact >= max(FORCES),
            {"line_ends": exact},
        )
    ]
    for force in FORCES:
        trace = evidence.trace(f"force-{force}")
        jump = int(np.flatnonzero(trace.time <= 0.0)[-1])
        line = (trace.force[0] - trace.force[jump]) / (
            2.0 * trace.contact_radius[0] * elastic.modulus(glassy=True)
        )
        ratio = float((trace.penetration[0] - trace.penetration[jump]) / line)
        radius_ratio = float(trace.contact_radius[jump] / trace.contact_radius[0])
        parts.append(
            Part(
                f"process zone of the paper, {force} F_JKR: penetration jumps by {ratio:.4f} of that, "
                f"radius to {radius_ratio:.4f} of a_B",
                abs(ratio - 1.0) <= RECOVERED,
                {f"jump_{force}": ratio, f"radius_{force}": radius_ratio},
            )
        )
    return parts


@claim(
    PLACE,
    "After the jump contact area, penetration and retraction speed fall monotonically, until the contact "
    "becomes unstable and detaches.",
    IN_PART,
)
def everything_falls_until_detachment(evidence: Evidence) -> list[Part]:
    """Monotony of area, penetration and speed from the jump to the detachment."""
    parts = []
    for force in FORCES:
        trace = evidence.trace(f"force-{force}")
        first = int(np.flatnonzero(trace.time <= 0.0)[-1])
        rows = slice(first, int(np.flatnonzero(trace.contact_radius > 0.0)[-1]) + 1)
        t, depth, a = trace.time[rows], trace.penetration[rows], trace.contact_radius[rows]
        moving = np.diff(t) > 0.0
        speed = -np.diff(depth)[moving] / np.diff(t)[moving]
        slowest = int(speed.argmin())
        again = float(t[1:][moving][slowest] / t[-1])
        parts += [
            Part(f"{force} F_JKR: area falls", rising(-a, 1e-4)),
            Part("penetration falls", rising(-depth, 1e-4)),
            Part(
                f"speed of retraction falls until t = {again:.2f} of the time of detachment, {t[-1]:.3g} τ, "
                f"then rises {speed[-1] / speed[slowest]:.3g}-fold",
                rising(-speed, 0.01),
                {f"slowest_at_{force}": again, f"detachment_{force}": float(t[-1])},
            ),
            Part("contact is lost", str(trace.outcome.kind) == "detached"),
        ]
    return parts


@claim(
    PLACE,
    "Contact is lost at significantly larger elongation than in the retraction at constant speed that has "
    "the same pull-off force.",
    IN_PART,
)
def farther_than_at_constant_speed(evidence: Evidence) -> list[Part]:
    """Withdrawal under constant force against the retraction matched to its pull-off force."""
    parts = []
    for force, speed in MATCHED.items():
        same = retraction(speed)
        drawn = DEPTH - evidence.measure(f"force-{force}", "detachment_penetration")
        parts += [
            Part(
                f"{force} F_JKR ({evidence.pull_off(same):.3f} at V = {speed:g}): withdrawn by {drawn:.4f} "
                f"R when contact is lost, by {DEPTH - depth:.4f} R at constant speed {where}",
                drawn > LARGER * (DEPTH - depth),
                {f"force_{force}": drawn, f"{name}_{force}": DEPTH - depth},
            )
            for name, where in (
                ("pull_off", "at the largest tension"),
                ("detachment", "when contact is lost"),
            )
            for depth in (evidence.measure(same, f"{name}_penetration"),)
        ]
    return parts


CLAIMS = (jump_is_a_flat_punch, everything_falls_until_detachment, farther_than_at_constant_speed)
