"""Claims of Secs. II, III and the appendix on the model itself: closed forms, and a shorter process zone."""

from __future__ import annotations

import numpy as np

from validation.cases import load
from validation.claims import elastic
from validation.claims.claim import FAILS, HOLDS, IN_PART, Part, claim
from validation.claims.evidence import CYCLE_SPEEDS, DEPTH, HALF_ZONE_SPEEDS, Evidence, cycle
from validation.claims.measures import LARGER, RECOVERED
from validation.measure.scaling import unit_sizes
from validation.reference.creep_compliance import creep_compliance
from validation.reference.finite_zone import FiniteZone

SCENE = "cycle-v0.02"


@claim(
    "Sec. II, Eq. (closure)",
    "The closure generalises Griffith's criterion; in the elastic case it is JKR.",
    HOLDS,
)
def closure_is_griffith(evidence: Evidence) -> list[Part]:
    """Pull-off of the elastic contact under the closure as its zone shrinks, against JKR's."""
    finite = elastic.finite(glassy=False)
    size = unit_sizes(load(SCENE).scene)["jkr-force"]
    parts = []
    for part in (1.0, 0.1, 0.01):
        law = FiniteZone(finite.radius, finite.plane_modulus, finite.work, part * finite.zone)
        ratio = -law.pull_off_force_control().force / size
        parts.append(
            Part(
                f"zone {law.zone:g} R: elastic pull-off {ratio:.5f} F_JKR",
                abs(ratio - 1.0) <= RECOVERED * part,
                {f"zone_{part:g}": ratio},
            )
        )
    return parts


@claim(
    "Sec. III, Eqs. (relaxation), (creep2)",
    "Relaxation function with time τ and creep function with time τ E∞/E₀ describe the same material.",
    HOLDS,
)
def creep_belongs_to_relaxation(evidence: Evidence) -> list[Part]:
    """Retardation time by its eigenproblem, and the complex modulus times the stated compliance."""
    material = load(SCENE).scene.material
    ratio = material.glassy_modulus / material.modulus
    time = float(creep_compliance(material).times[0]) / float(material.spectrum[1][0])
    w = np.geomspace(1e-3, 1e3, 25)
    stated = 1.0 / material.glassy_modulus + (1.0 / material.modulus - 1.0 / material.glassy_modulus) / (
        1.0 + 1j * w * ratio
    )
    apart = float(np.abs(stated * material.complex_modulus(w) - 1.0).max())
    return [
        Part(f"retardation time {time:.12g} τ, stated {ratio:g} τ", abs(time / ratio - 1.0) < 1e-9),
        Part(f"complex compliance times modulus is 1 to {apart:.1e}", apart < 1e-9),
    ]


@claim(
    "Appendix A, Eq. (diffeq)",
    "The differential equation solved has the time τ of the relaxation function.",
    FAILS,
)
def appendix_uses_the_same_time(evidence: Evidence) -> list[Part]:
    """Complex compliance of the equation with either time, against that of the material."""
    material = load(SCENE).scene.material
    stiff, soft = material.glassy_modulus, material.modulus
    w = np.geomspace(1e-2, 1e2, 25)
    exact = 1.0 / material.complex_modulus(w)

    def compliance(time: float) -> np.ndarray:
        """Of ``J' = s'/Einf + s/(time E0) - J/time``."""
        return (1j * w / stiff + 1.0 / (time * soft)) / (1j * w + 1.0 / time)

    same = float(np.abs(compliance(1.0) / exact - 1.0).max())
    longer = float(np.abs(compliance(stiff / soft) / exact - 1.0).max())
    return [
        Part(
            f"its compliance is off by up to {same:.2f} with τ, by {longer:.1e} with the retardation "
            "time τ E∞/E₀",
            same <= 1e-6,
            {"with_relaxation_time": same, "with_retardation_time": longer},
        )
    ]


@claim("Sec. III, before Eq. (energybalance)", "The plane modulus is E∞* = E∞ (1 - ν²).", FAILS)
def plane_modulus_is_multiplied(evidence: Evidence) -> list[Part]:
    """Point B of the paper tells which: its dimensionless numbers follow only from E/(1 - nu^2)."""
    law = elastic.vanishing(glassy=False)
    poisson = load(SCENE).scene.material.poisson
    multiplied = type(law)(law.indenter, law.plane_modulus * (1.0 - poisson**2) ** 2, law.work)
    radii = [one.at_penetration(DEPTH).contact_radius for one in (law, multiplied)]
    return [
        Part(
            f"point B: a = {radii[0]:.4f} with E/(1 - ν²), {radii[1]:.4f} with E (1 - ν²); the paper "
            "says 0.245",
            abs(radii[1] - 0.245) <= 1e-3,
            {"divided": radii[0], "multiplied": radii[1]},
        )
    ]


@claim(
    "Sec. II, after Eq. (closure)",
    "The length of the process zone has no effect on the qualitative behaviour; it only shifts the "
    "frequency at which the edge is excited.",
    IN_PART,
)
def process_zone_only_shifts(evidence: Evidence) -> list[Part]:
    """Pull-off with half the zone, against the whole zone at twice the speed."""
    half = [evidence.pull_off(cycle(v, zone=0.0065)) for v in HALF_ZONE_SPEEDS]
    whole = np.log([evidence.pull_off(cycle(v)) for v in CYCLE_SPEEDS])
    shifted = [float(np.exp(np.interp(np.log(2 * v), np.log(CYCLE_SPEEDS), whole))) for v in HALF_ZONE_SPEEDS]
    parts = [
        Part(
            f"half the zone: pull-off still largest at intermediate speed, {max(half):.2f} F_JKR "
            f"(whole zone {float(np.exp(whole.max())):.2f})",
            int(np.argmax(half)) not in (0, len(half) - 1) and max(half) > LARGER,
            {"half": max(half), "whole": float(np.exp(whole.max()))},
        )
    ]
    for v, a, b in zip(HALF_ZONE_SPEEDS, half, shifted, strict=True):
        parts.append(
            Part(
                f"half the zone at V = {v:g}: {a:.3f} F_JKR; whole zone at twice the speed: {b:.3f} "
                "(interpolated)",
                abs(a / b - 1.0) <= RECOVERED,
                {f"half_{v:g}": a, f"whole_{2 * v:g}": b},
            )
        )
    return parts


CLAIMS = (
    closure_is_griffith,
    process_zone_only_shifts,
    creep_belongs_to_relaxation,
    appendix_uses_the_same_time,
    plane_modulus_is_multiplied,
)
