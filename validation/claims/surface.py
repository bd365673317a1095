"""Claims of Sec. III on the surface along one cycle, V = 0.002 (Fig. 3)."""

from __future__ import annotations

import numpy as np

from contact_scene import SurfaceProfile
from validation.cases import load
from validation.claims import elastic
from validation.claims.claim import HOLDS, IN_PART, Part, claim
from validation.claims.evidence import SOLVER, Evidence, MissingRun
from validation.claims.measures import (
    RECOVERED,
    annular_peak,
    edge_exponent,
    gap_exponents,
    tension_row,
    withdrawal,
)
from validation.reference.jkr import JKR
from validation.solvers import REFERENCE

SCENE = "cycle-v0.002"
PLACE = "Sec. III, Fig. 3"
REVERSAL = 16.0
"""Time at which the cycle turns from approach to retraction."""
NEGLIGIBLE = 0.05
"""Largest loss of contact area, relative, that counts as hardly a change."""


def profiles(evidence: Evidence, solver: str = SOLVER) -> list[SurfaceProfile]:
    """Surface at the times the scene names, in order."""
    recorded = evidence.trace(SCENE, solver).profiles
    if len(recorded) < len(load(SCENE).profile_times):
        raise MissingRun(f"{SCENE} by {solver}: no surface at some of the times it names")
    return sorted(recorded, key=lambda profile: profile.time)


@claim(PLACE, "At the contact edge adhesion makes a square-root singularity of the pressure.", HOLDS)
def square_root_at_the_edge(evidence: Evidence) -> list[Part]:
    """By the reference: on approach the singularity is so narrow that only its points reach into it."""
    return [
        Part(
            f"Δ/R = {profile.penetration:.3f}: tension grows with the power "
            f"{edge_exponent(profile):.3f} of the distance",
            abs(edge_exponent(profile) + 0.5) <= RECOVERED,
            {f"exponent_{profile.time:g}": edge_exponent(profile)},
        )
        for profile in profiles(evidence, REFERENCE)
    ]


@claim(PLACE, "While approaching, the pressure has a positive annular peak near the advancing edge.", HOLDS)
def approach_has_an_annular_peak(evidence: Evidence) -> list[Part]:
    """Largest pressure inside the edge in all surfaces recorded before the reversal, both solvers."""
    return [
        _peak(profile, solver, expected=True)
        for solver in (SOLVER, REFERENCE)
        for profile in profiles(evidence, solver)
        if profile.time <= REVERSAL
    ]


@claim(PLACE, "While withdrawing, the annular peak is gone.", HOLDS)
def withdrawal_has_none(evidence: Evidence) -> list[Part]:
    """The same in all surfaces recorded after the reversal."""
    return [
        _peak(profile, solver, expected=False)
        for solver in (SOLVER, REFERENCE)
        for profile in profiles(evidence, solver)
        if profile.time > REVERSAL
    ]


def _peak(profile: SurfaceProfile, solver: str, expected: bool) -> Part:
    peak = annular_peak(profile)
    where = (
        "falls from the centre" if peak is None else f"largest at r/a = {peak[0]:.2f}, {peak[1]:.2f} of p(0)"
    )
    return Part(
        f"{solver}, Δ/R = {profile.penetration:.3f}: pressure {where}", (peak is not None) == expected
    )


@claim(
    PLACE,
    "Early in the retraction the contact area hardly changes; it drops only once the largest tension is "
    "reached.",
    IN_PART,
)
def area_waits_for_the_largest_tension(evidence: Evidence) -> list[Part]:
    """Share of the area lost until the force is zero, and until it is the largest tension."""
    parts = []
    for solver in (SOLVER, REFERENCE):
        trace = evidence.trace(SCENE, solver)
        rows = withdrawal(trace)
        force, area = trace.force[rows], trace.contact_radius[rows] ** 2 / trace.contact_radius[rows][0] ** 2
        free = int(np.argmax(force <= 0.0))
        top = float(trace.contact_radius[tension_row(trace)] ** 2 / trace.contact_radius[rows][0] ** 2)
        parts += [
            Part(
                f"{solver}: {100 * (1 - area[free]):.1f} % of the area lost until the force has fallen "
                "to zero",
                bool(1.0 - area[free] <= NEGLIGIBLE),
                {f"{solver}_lost_unloaded": float(1 - area[free])},
            ),
            Part(
                f"{solver}: {100 * (1 - top):.1f} % lost until the largest tension",
                1.0 - top <= NEGLIGIBLE,
                {f"{solver}_lost_at_pull_off": 1 - top},
            ),
        ]
    return parts


@claim(PLACE, "While withdrawing, the opening crack has the trumpet shape of de Gennes.", HOLDS)
def crack_is_a_trumpet(evidence: Evidence) -> list[Part]:
    """Local exponents of the gap over the distance from the edge, beside those of an elastic edge."""
    parts, sphere = [], elastic.vanishing(glassy=False)
    for profile in profiles(evidence, REFERENCE):
        if profile.time <= REVERSAL:
            continue
        a = profile.contact_radius
        distances = np.geomspace(2e-3 * a, 0.3 * a, 12)
        exponents = gap_exponents(profile, tuple(distances))
        still = _elastic_exponents(sphere, a, distances)
        excess = exponents - still
        most = int(excess.argmax())
        parts += [
            Part(
                f"Δ/R = {profile.penetration:.3f}: gap grows with the power {exponents[0]:.2f} of the "
                f"distance at {distances[0] / a:.3f} a (elastic {still[0]:.2f})",
                bool(0.4 < exponents[0] < 0.75),
                {f"tip_{profile.time:g}": float(exponents[0])},
            ),
            Part(
                f"and with {exponents[most]:.2f} at {distances[most] / a:.3f} a, where an elastic edge has "
                f"{still[most]:.2f}",
                bool(excess[most] > 0.1),
                {
                    f"wide_{profile.time:g}": float(exponents[most]),
                    f"elastic_{profile.time:g}": float(still[most]),
                },
            ),
        ]
    return parts


def _elastic_exponents(law: JKR, a: float, distances: np.ndarray) -> np.ndarray:
    """Exponents of the gap of the elastic contact of the same radius in equilibrium."""
    r = a + distances
    stretch = a**2 - float(law.penetration(a))
    angle = np.arccos(a / r)
    gap = (2.0 * stretch * angle + (r**2 - 2.0 * a**2) * angle + a * np.sqrt(r**2 - a**2)) / np.pi
    return np.diff(np.log(gap)) / np.diff(np.log(distances))


CLAIMS = (
    square_root_at_the_edge,
    approach_has_an_annular_peak,
    withdrawal_has_none,
    area_waits_for_the_largest_tension,
    crack_is_a_trumpet,
)
