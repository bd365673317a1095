"""Claims of Sec. III on retraction from the fully relaxed contact (Fig. 4)."""

from __future__ import annotations

import numpy as np

from validation.claims import elastic
from validation.claims.claim import HOLDS, IN_PART, Part, claim
from validation.claims.evidence import (
    DEPTH,
    RETRACTION_SPEEDS,
    SOLVER,
    Evidence,
    retraction,
)
from validation.claims.measures import (
    LARGER,
    RECOVERED,
    first_slope,
    on_line,
    release_rate,
    rising,
    tension_row,
    withdrawal,
)
from validation.reference.frozen import FrozenRetraction
from validation.solvers import REFERENCE

FAST, SLOW = 10.0, 2e-4
PLACE = "Sec. III, Fig. 4"


@claim(PLACE, "Point B, Δ = 0.032: soft elastic JKR gives a = 0.245 and F = 1.87e-3.", HOLDS)
def point_b(evidence: Evidence) -> list[Part]:
    """First row of a retraction from the relaxed contact, against the paper's digits."""
    row = evidence.trace(retraction(FAST))
    force = float(row.force[0] / np.pi)
    exact, finite = (law(False).at_penetration(DEPTH) for law in (elastic.vanishing, elastic.finite))
    return [
        Part(
            f"a = {row.contact_radius[0]:.5f} (exact JKR {exact.contact_radius:.5f}, finite zone "
            f"{finite.contact_radius:.5f})",
            abs(row.contact_radius[0] - 0.245) <= 5e-4,
            {"radius": float(row.contact_radius[0]), "jkr": exact.contact_radius},
        ),
        Part(
            f"F = {force:.4e} (exact JKR {exact.force / np.pi:.4e}, finite zone {finite.force / np.pi:.4e})",
            abs(force - 1.87e-3) <= 5e-6,
            {"force": force, "jkr_force": exact.force / np.pi},
        ),
    ]


@claim(
    PLACE,
    "At first the response is elastic with the glassy modulus, the contact area stands still, and force "
    "falls linearly with penetration like a flat punch's, whatever the speed.",
    IN_PART,
)
def flat_punch_line_at_any_speed(evidence: Evidence) -> list[Part]:
    """First slope over that of the glassy punch, and how far towards pull-off the force follows that line."""
    parts = []
    for speed in RETRACTION_SPEEDS:
        trace = evidence.trace(retraction(speed))
        slope = first_slope(trace, 1e-3)
        ratio = slope / (2.0 * trace.contact_radius[0] * elastic.modulus(glassy=True))
        share = on_line(trace, slope)
        parts.append(
            Part(
                f"V = {speed:g}: first slope {ratio:.3f} of 2 a E∞*, straight to 5 % over {share:.2f} of "
                "the way to pull-off",
                share >= 0.1 and abs(ratio - 1.0) <= 2 * RECOVERED,
                {f"slope_{speed:g}": ratio, f"share_{speed:g}": share},
            )
        )
    return parts


@claim(PLACE, "At high speed the pull-off force is much larger than the JKR value.", HOLDS)
def fast_pull_off_is_large(evidence: Evidence) -> list[Part]:
    """Pull-off force of one fast retraction."""
    value = evidence.pull_off(retraction(FAST))
    return [Part(f"{value:.3f} F_JKR at V = {FAST:g}", value > 2.0, {"pull_off": value})]


@claim(
    PLACE,
    "At fast pull-off the material is glassy: G = K²/(2E∞*) equals the work of adhesion; nothing is tougher.",
    HOLDS,
)
def fast_edge_is_griffith(evidence: Evidence) -> list[Part]:
    """At the largest tension: stress intensity, and slope of the loss over the area, both solvers."""
    parts = []
    for solver in (SOLVER, REFERENCE):
        trace = evidence.trace(retraction(FAST), solver)
        row = tension_row(trace)
        work = elastic.vanishing(True).work
        tip = trace.extra["stress_intensity_factor"][row] ** 2 / (2.0 * elastic.modulus(True) * work)
        rate = release_rate(trace, row, work) / work
        parts += [
            Part(f"{solver}: K²/(2E∞*) = {tip:.4f} Δγ at "
            "pull-off", abs(tip - 1) <= RECOVERED, {f"tip_{solver}": tip}),
            Part(f"{solver}: G = {rate:.3f} Δγ from the energy balance", abs(rate - 1) <= 2 * RECOVERED,
                 {f"rate_{solver}": rate}),
        ]  # fmt: skip
    return parts


@claim(
    PLACE,
    "In fast retraction force-penetration and force-area curves differ significantly from JKR's, and JKR "
    "does not predict the pull-off force.",
    HOLDS,
)
def fast_curves_are_not_jkr(evidence: Evidence) -> list[Part]:
    """Largest distance of F(a) from JKR with either modulus, over the largest force."""
    trace = evidence.trace(retraction(FAST))
    rows = withdrawal(trace)
    a, force = trace.contact_radius[rows], trace.force[rows]
    parts = []
    for glassy, name in ((False, "E₀"), (True, "E∞")):
        apart = float(np.abs(force - elastic.vanishing(glassy).force(a)).max() / np.abs(force).max())
        parts.append(
            Part(f"F(a) up to {apart:.2f} of the largest force off JKR with {name}", apart > LARGER - 1)
        )
    value = evidence.pull_off(retraction(FAST))
    return [*parts, Part(f"pull-off {value:.2f} F_JKR", value > LARGER, {"pull_off": value})]


@claim(
    PLACE,
    "The pull-off force falls monotonically with falling speed, to the elastic JKR value for extremely slow "
    "retraction.",
    HOLDS,
)
def pull_off_falls_with_speed(evidence: Evidence) -> list[Part]:
    """Pull-off over all speeds of the sweep, and its lowest against the elastic value."""
    values = [evidence.pull_off(retraction(speed)) for speed in RETRACTION_SPEEDS]
    bottom = values[0] / elastic.pull_off(glassy=False)
    return [
        Part(f"from {values[-1]:.3f} F_JKR monotonically to {values[0]:.4f}", rising(values)),
        Part(
            f"at V = {RETRACTION_SPEEDS[0]:g}: {bottom:.4f} of the elastic value",
            abs(bottom - 1.0) <= RECOVERED,
            {"slowest": values[0], "fastest": values[-1]},
        ),
    ]


@claim(
    PLACE,
    "Very slow retraction has the soft elastic elongation before pull-off; at intermediate speed it is "
    "significantly larger.",
    HOLDS,
)
def elongation_is_largest_between(evidence: Evidence) -> list[Part]:
    """Penetration where contact ends, over all speeds, against the elastic one.

    At the lowest speeds it ends at the length of the process zone: creep slows the final instability down.
    """
    soft = elastic.finite(False).pull_off_penetration_control().penetration
    least = [evidence.measure(retraction(v), "final_penetration") for v in RETRACTION_SPEEDS]
    far = int(np.argmin(least))
    return [
        Part(
            f"contact ends at Δ/R = {least[0]:.5f} at V = {RETRACTION_SPEEDS[0]:g}, elastically {soft:.5f}",
            abs(least[0] / soft - 1.0) <= 2 * RECOVERED,
            {"slowest": least[0], "elastic": soft},
        ),
        Part(
            f"farthest at V = {RETRACTION_SPEEDS[far]:g}: {least[far]:.5f}, {least[far] / soft:.2f} "
            "times as far",
            0 < far < len(least) - 1 and least[far] / soft > LARGER,
            {"farthest": least[far], "speed": RETRACTION_SPEEDS[far]},
        ),
    ]


@claim(
    PLACE,
    "In the small-scale regime (slow, bulk relaxed) load-penetration and load-area curves are well "
    "approximated by JKR with the work of adhesion replaced by G.",
    IN_PART,
)
def small_scale_is_effective_jkr(evidence: Evidence) -> list[Part]:
    """About pull-off: radii from 0.8 to 1.25 of that there, with G as it is there."""
    parts = []
    law = elastic.vanishing(False)
    for speed in (5e-5, SLOW, 5e-4):
        trace = evidence.trace(retraction(speed))
        row = tension_row(trace)
        effective = release_rate(trace, row, law.work)
        adapted = type(law)(law.indenter, law.plane_modulus, effective)
        a = trace.contact_radius
        near = np.flatnonzero((a > 0.8 * a[row]) & (a < 1.25 * a[row]))
        top, travel = -trace.force[row], trace.penetration[0] - trace.penetration[row]
        force = float(np.abs(adapted.force(a[near]) - trace.force[near]).max() / top)
        depth = float(np.abs(adapted.penetration(a[near]) - trace.penetration[near]).max() / travel)
        known = -adapted.pull_off_force_control().force / top
        parts += [
            Part(
                f"V = {speed:g}, JKR with G = {effective / law.work:.3f} Δγ: largest tension "
                f"{known:.3f} of the one found",
                abs(known - 1.0) <= RECOVERED,
                {f"tension_{speed:g}": known, f"release_rate_{speed:g}": effective / law.work},
            ),
            Part(f"F(a) within {force:.3f} of it", force <= 2 * RECOVERED, {f"force_{speed:g}": force}),
            Part(
                f"Δ(a) within {depth:.3f} of the way to pull-off",
                depth <= 2 * RECOVERED,
                {f"penetration_{speed:g}": depth},
            ),
        ]
    return parts


@claim(
    "Abstract; Sec. III, Fig. 4",
    "Fast retraction after relaxation ends in a flat-punch-like detachment: the contact area is constant "
    "until pull-off.",
    IN_PART,
)
def detachment_at_constant_area(evidence: Evidence) -> list[Part]:
    """Area left at the largest tension: frozen limit without a zone, then runs with the paper's."""
    scene = retraction(FAST).adhesion
    assert scene is not None
    frozen = FrozenRetraction(retraction(FAST).material, retraction(FAST).indenter, scene.work, DEPTH)
    exact = (frozen.pull_off().contact_radius / frozen.relaxed.contact_radius) ** 2
    parts = [
        Part(
            f"infinitely fast, vanishing process zone: {100 * (1 - exact):.1f} % of the area is lost before "
            "the largest tension",
            1.0 - exact <= RECOVERED,
            {"exact_area_kept": exact},
        )
    ]
    for speed in (FAST, RETRACTION_SPEEDS[-1]):
        trace = evidence.trace(retraction(speed))
        area_ratio = float((trace.contact_radius[tension_row(trace)] / trace.contact_radius[0]) ** 2)
        parts.append(
            Part(
                f"V = {speed:g}, process zone of the paper: {100 * (1 - area_ratio):.1f} %",
                1.0 - area_ratio <= RECOVERED,
                {f"area_kept_{speed:g}": area_ratio},
            )
        )
    return parts


CLAIMS = (
    point_b,
    flat_punch_line_at_any_speed,
    fast_pull_off_is_large,
    fast_edge_is_griffith,
    fast_curves_are_not_jkr,
    pull_off_falls_with_speed,
    elongation_is_largest_between,
    small_scale_is_effective_jkr,
    detachment_at_constant_area,
)
