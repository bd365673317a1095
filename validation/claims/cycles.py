"""Claims of Secs. II and III on the model, on approach-retraction cycles and their surface.

A claim is a generator of parts; its docstring is the paper's statement, paraphrased.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from validation.cases import load
from validation.claims import evidence as sweeps
from validation.claims import measures
from validation.claims.claim import (
    FAILS,
    HOLDS,
    IN_PART,
    LARGER,
    RECOVERED,
    STEADY,
    Part,
    above,
    below,
    claim,
    near,
    over,
    peaks,
)
from validation.claims.evidence import BOTH, Evidence, cycle
from validation.claims.measures import BASE, SOFT, STIFF, elastic, elastic_pull_off, hysteresis, jkr
from validation.measure.events import end_of_approach
from validation.reference.creep_compliance import creep_compliance
from validation.solvers import REFERENCE

FIG2, FIG3 = "Sec. III, Fig. 2", "Sec. III, Fig. 3"
SLOWEST, FASTEST = sweeps.CYCLE_SPEEDS[0], sweeps.CYCLE_SPEEDS[-1]
REVERSAL = 16.0
"""Time at which the cycle of Fig. 3 turns from approach to retraction."""
NEGLIGIBLE = 0.05
"""Largest loss of contact area, relative, that counts as hardly a change."""


@claim("Sec. II, Eq. (closure)", HOLDS)
def closure_is_griffith(runs: Evidence) -> Iterator[Part]:
    """The closure generalises Griffith's criterion; in the elastic case it is JKR."""
    for share in (1.0, 0.1, 0.01):
        law = replace(elastic(SOFT), zone=share * elastic(SOFT).zone)
        yield near(f"zone {law.zone:g} R: elastic F_off/F_JKR", elastic_pull_off(law), 1.0, share * RECOVERED)


@claim("Sec. II, after Eq. (closure)", IN_PART)
def process_zone_only_shifts(runs: Evidence) -> Iterator[Part]:
    """The length of the process zone has no effect on the qualitative behaviour; it only shifts the frequency
    at which the edge is excited."""
    half = runs.pull_offs(lambda v: cycle(v, sweeps.HALF_ZONE), sweeps.HALF_ZONE_SPEEDS)
    whole = np.log(list(runs.pull_offs(cycle, sweeps.CYCLE_SPEEDS).values()))
    yield peaks("half the zone: F_off/F_JKR over V", half, LARGER)
    for v, force in half.items():
        shifted = float(np.exp(np.interp(np.log(2 * v), np.log(sweeps.CYCLE_SPEEDS), whole)))
        yield near(f"half the zone at V = {v:g}, beside the whole at twice the speed:", force, shifted)


@claim("Sec. III, Eqs. (relaxation), (creep2)", HOLDS)
def creep_belongs_to_relaxation(runs: Evidence) -> Iterator[Part]:
    """Relaxation function with time τ and creep function with time τ E∞/E₀ describe the same material."""
    material = load(BASE).scene.material
    stiff, soft = 1.0 / material.glassy_modulus, 1.0 / material.modulus
    time = float(creep_compliance(material).times[0]) / float(material.spectrum[1][0])
    yield near("retardation time over τ", time, soft / stiff, 1e-9)
    w = np.geomspace(1e-3, 1e3, 25)
    stated = stiff + (soft - stiff) / (1.0 + 1j * w * soft / stiff)
    apart = np.abs(stated * material.complex_modulus(w) - 1.0).max()
    yield below("complex compliance times modulus is 1 to", apart, 1e-9)


@claim("Appendix A, Eq. (diffeq)", FAILS)
def appendix_uses_the_same_time(runs: Evidence) -> Iterator[Part]:
    """The differential equation solved has the time τ of the relaxation function."""
    material, w = load(BASE).scene.material, np.geomspace(1e-2, 1e2, 25)
    stiff, soft = material.glassy_modulus, material.modulus

    def off(time: float) -> float:  # of J' = s'/Einf + s/(time E0) - J/time, from the material's compliance
        compliance = (1j * w / stiff + 1.0 / (time * soft)) / (1j * w + 1.0 / time)
        return float(np.abs(compliance * material.complex_modulus(w) - 1.0).max())

    yield below(f"compliance off by {off(stiff / soft):.1e} with τ E∞/E₀, with τ by", off(1.0), 1e-6)


@claim("Sec. III, before Eq. (energybalance)", FAILS)
def plane_modulus_is_multiplied(runs: Evidence) -> Iterator[Part]:
    """The plane modulus is E∞* = E∞ (1 - ν²)."""
    law, poisson = jkr(SOFT), load(BASE).scene.material.poisson
    laws = law, replace(law, plane_modulus=law.plane_modulus * (1.0 - poisson**2) ** 2)
    divided, multiplied = (one.at_penetration(sweeps.DEPTH).contact_radius for one in laws)
    yield near(f"point B: a = {divided:.4f} with E/(1 - ν²), with E (1 - ν²)", multiplied, 0.245, 4e-3)


@claim(FIG2, HOLDS)
def jump_in_is_glassy(runs: Evidence) -> Iterator[Part]:
    """Contact begins at zero penetration by a jump that is elastic with the glassy modulus (JKR), whatever
    the speed."""
    radii = np.array([runs.trace(cycle(v)).contact_radius[0] for v in sweeps.CYCLE_SPEEDS])
    yield below("start radius over V spreads by", np.ptp(radii) / radii.mean(), STEADY)
    exact, finite = (law(STIFF).at_penetration(0.0).contact_radius for law in (jkr, elastic))
    yield near(f"a/R (with the finite process zone {finite:.4f}), JKR with E∞:", radii[0], exact)


@claim(FIG2, IN_PART)
def slow_cycle_is_soft(runs: Evidence) -> Iterator[Part]:
    """At V = 2e-5 the soft elastic JKR response is recovered in approach and retraction, without
    hysteresis."""
    return _is_elastic(runs, 2e-5, SOFT)


@claim(FIG2, HOLDS)
def fast_cycle_is_glassy(runs: Evidence) -> Iterator[Part]:
    """At V >> 1 the glassy elastic JKR response is recovered, with vanishing hysteresis."""
    for v in (10.0, FASTEST):
        yield from _is_elastic(runs, v, STIFF)


def _is_elastic(runs: Evidence, v: float, glassy: bool) -> Iterator[Part]:
    """Force and radius at the end of the approach, pull-off force and hysteresis are those of a limit."""
    trace, law = runs.trace(cycle(v)), elastic(glassy)
    row, known = end_of_approach(trace), law.at_penetration(sweeps.DEPTH)
    largest = max(hysteresis(runs.trace(cycle(one))) for one in sweeps.CYCLE_SPEEDS)
    yield near(
        f"V = {v:g}, over the elastic one: force at the end of approach", trace.force[row] / known.force
    )
    yield near("contact radius there", trace.contact_radius[row] / known.contact_radius)
    yield near("pull-off force", runs.pull_off(cycle(v)) / elastic_pull_off(law))
    yield below("hysteresis over its largest", hysteresis(trace) / largest, RECOVERED)


@claim(FIG2, HOLDS)
def limits_share_the_pull_off_force(runs: Evidence) -> Iterator[Part]:
    """In both elastic limits the pull-off force is the same, independent of the modulus."""
    slow, fast = (runs.pull_off(cycle(v)) for v in (SLOWEST, FASTEST))
    soft, stiff = (elastic_pull_off(elastic(glassy)) for glassy in (SOFT, STIFF))
    why = f"the finite zone alone makes it {soft:.4f} and {stiff:.4f}"
    yield near(f"F_off/F_JKR, fastest against slowest cycle ({why}):", fast, slow)


@claim(FIG2, HOLDS)
def intermediate_cycles_lose_and_hold(runs: Evidence) -> Iterator[Part]:
    """At intermediate speed viscoelastic loss makes a large adhesive hysteresis, and tensile loads are
    significantly larger than elastic ones."""
    losses = {v: hysteresis(runs.trace(cycle(v))) for v in sweeps.CYCLE_SPEEDS}
    largest = max(losses.values())
    yield peaks("hysteresis over V", losses)
    yield below("at the ends, over it", max(losses[SLOWEST], losses[FASTEST]) / largest, 0.5)
    yield peaks("F_off/F_JKR over V", runs.pull_offs(cycle, sweeps.CYCLE_SPEEDS), LARGER)


@claim(FIG2, HOLDS)
def where_pull_off_occurs(runs: Evidence) -> Iterator[Part]:
    """Pull-off can occur farther out than in the elastic case, and at larger speed even at positive
    penetration."""
    soft = jkr(SOFT).pull_off_force_control().penetration
    at = {v: runs.measure(cycle(v), "pull_off_penetration") for v in sweeps.CYCLE_SPEEDS}
    yield above("farthest penetration at pull-off over JKR's with E₀", min(at.values()) / soft, LARGER)
    yield over("positive penetration:", {v: d for v, d in at.items() if d > 0.0}, max(at.values()) > 0.0)


@claim(FIG2, HOLDS)
def reversal_triggers_glass(runs: Evidence) -> Iterator[Part]:
    """Where pull-off comes at positive penetration, the material has not been glassy while approaching; the
    reversal triggers the glassy modulus."""
    soft, stiff = (elastic(glassy).at_penetration(sweeps.DEPTH).force for glassy in (SOFT, STIFF))
    halfway = 0.5 * (1.0 + jkr(SOFT).plane_modulus / jkr(STIFF).plane_modulus)
    for v in (0.02, 0.05, 0.1):
        trace = runs.trace(cycle(v))
        row = end_of_approach(trace)
        share = (trace.force[row] - soft) / (stiff - soft)
        yield below(f"V = {v:g}: share of the way from soft to stiff force at reversal", share, 0.95)
        still = 2.0 * trace.contact_radius[row] * jkr(STIFF).plane_modulus  # tangent of a still edge
        slope = 0.5 * (measures.last_slope(trace) + measures.first_slope(trace))  # relaxation cancels
        yield above("mean slope before and after it over 2 a E∞*", slope / still, halfway)


@claim(FIG2, IN_PART)
def pull_off_inside_is_large(runs: Evidence) -> Iterator[Part]:
    """Pull-off at positive penetration comes with a contact area and a tension much larger than elastic
    ones."""
    exact = jkr(SOFT).pull_off_force_control()
    for v in sweeps.CYCLE_SPEEDS:
        trace = runs.trace(cycle(v))
        row = measures.tension_row(trace)
        if trace.penetration[row] > 0.0:
            area = (trace.contact_radius[row] / exact.contact_radius) ** 2
            shown = f"V = {v:g}: least of area ({area:.2f}) and tension over JKR's with E₀"
            yield above(shown, min(area, runs.pull_off(cycle(v))), LARGER)


@claim(FIG3, HOLDS)
def square_root_at_the_edge(runs: Evidence) -> Iterator[Part]:
    """At the contact edge adhesion makes a square-root singularity of the pressure."""
    for one in runs.profiles(REFERENCE):  # only its points reach into the singularity, narrow on approach
        power = measures.edge_exponent(one)
        yield near(f"Δ/R = {one.penetration:.3f}: power of the distance", power, -0.5, 2 * RECOVERED)


@claim(FIG3, HOLDS)
def approach_has_an_annular_peak(runs: Evidence) -> Iterator[Part]:
    """While approaching, the pressure has a positive annular peak near the advancing edge."""
    return _peaks(runs, approaching=True)


@claim(FIG3, HOLDS)
def withdrawal_has_none(runs: Evidence) -> Iterator[Part]:
    """While withdrawing, the annular peak is gone."""
    return _peaks(runs, approaching=False)


def _peaks(runs: Evidence, approaching: bool) -> Iterator[Part]:
    """Whether surfaces recorded before the reversal have a peak, those after it none; both solvers."""
    for solver in BOTH:
        for profile in runs.profiles(solver):
            if (profile.time <= REVERSAL) == approaching:
                peak, where = measures.annular_peak(profile), "falls from the centre"
                if peak is not None:
                    where = f"largest at r/a = {peak[0]:.2f}, {peak[1]:.2f} of p(0)"
                shown = f"{solver}, Δ/R = {profile.penetration:.3f}: pressure {where}"
                yield Part(shown, (peak is not None) == approaching)


@claim(FIG3, IN_PART)
def area_waits_for_the_largest_tension(runs: Evidence) -> Iterator[Part]:
    """Early in the retraction the contact area hardly changes; it drops only once the largest tension is
    reached."""
    for solver in BOTH:
        trace = runs.trace(sweeps.SURFACES, solver)
        rows = measures.withdrawal(trace)
        kept = trace.contact_radius**2 / trace.contact_radius[rows.start] ** 2
        unloaded = rows.start + int(np.argmax(trace.force[rows] <= 0.0))
        yield below(
            f"{solver}: share of the area lost until the force is zero", 1 - kept[unloaded], NEGLIGIBLE
        )
        yield below("until the largest tension", 1 - kept[measures.tension_row(trace)], NEGLIGIBLE)


@claim(FIG3, HOLDS)
def crack_is_a_trumpet(runs: Evidence) -> Iterator[Part]:
    """While withdrawing, the opening crack has the trumpet shape of de Gennes."""
    for profile in (one for one in runs.profiles(REFERENCE) if one.time > REVERSAL):
        distances = profile.contact_radius * np.geomspace(2e-3, 0.3, 12)
        power = measures.gap_exponents(profile, distances)
        excess = power - measures.elastic_gap_exponents(jkr(SOFT), profile.contact_radius, distances)
        shown = f"Δ/R = {profile.penetration:.3f}: exponent of the gap over the distance at the edge"
        yield near(shown, power[0], 0.575, 0.304)  # 0.4 to 0.75
        yield above("farther off it exceeds an elastic edge's by", excess.max(), 0.1)
