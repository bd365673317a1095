"""Claims of Sec. III on retraction from the relaxed contact, rests, constant tension, oscillations and loss.

A claim is a generator of parts; its docstring is the paper's statement, paraphrased.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

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
    Part,
    above,
    bell,
    below,
    claim,
    near,
    over,
    peaks,
    rises,
    rising,
)
from validation.claims.evidence import BOTH, Evidence, cycle, retraction
from validation.claims.measures import BASE, SOFT, STIFF, elastic, elastic_pull_off, jkr, sweep_cycles
from validation.measure.events import end_of_approach
from validation.measure.scaling import unit_sizes
from validation.reference.frozen import FrozenRetraction
from validation.reference.steady_crack import opening
from validation.solvers import REFERENCE

FIG4, PRELOADED, RESTS = "Sec. III, Fig. 4", "Sec. III, Fig. 4(c)", "Sec. III, dwell-time figure"
FIG5, FIG6, FIG7 = "Sec. III, Fig. 5", "Sec. III, Fig. 6", "Sec. III.A, Fig. 7"
SLOWEST, FASTEST = sweeps.RETRACTION_SPEEDS[0], sweeps.RETRACTION_SPEEDS[-1]
FAST = 10.0
MOST = 10.0
"""``Einf/E0``, the limit of the pull-off force over ``F_JKR``."""
RESTED_SPEED = 0.1
"""Speed of the cycles whose rest varies."""
RELAXED = 0.9
"""Share of the relaxed contact's pull-off force at which a rest counts as complete."""
SAME_APPROACH = 5e-4
"""Relative difference within which two approaches are the same: the solver's accuracy, since the annuli are
chosen for the scene and finer where it rests."""
DEPTHS = (0.008, 0.016, 0.024)
"""Penetrations of Fig. 7(b), over R; the paper does not state them in the text."""
SETTING_OUT = 0.1
"""Speed beyond which the tension is largest where the edge sets out from the relaxed contact."""
QUOTED = 5e-4
"""Largest speed at which, in the paper, the JKR formula gives the energy release rate."""


@claim(FIG4, HOLDS)
def point_b(runs: Evidence) -> Iterator[Part]:
    """Point B, Δ = 0.032: soft elastic JKR gives a = 0.245 and F = 1.87e-3."""
    trace, exact = runs.trace(retraction(FAST)), jkr(SOFT).at_penetration(sweeps.DEPTH)
    yield near(f"a (exact JKR {exact.contact_radius:.5f})", trace.contact_radius[0], 0.245, 5e-4 / 0.245)
    force = trace.force[0] / np.pi
    yield near(f"F (exact JKR {exact.force / np.pi:.4e})", force, 1.87e-3, 5e-6 / 1.87e-3)


@claim(FIG4, IN_PART)
def flat_punch_line_at_any_speed(runs: Evidence) -> Iterator[Part]:
    """At first the response is elastic with the glassy modulus, the contact area stands still, and force
    falls linearly with penetration like a flat punch's, whatever the speed."""
    for v in sweeps.RETRACTION_SPEEDS:
        trace = runs.trace(retraction(v))
        slope = measures.first_slope(trace, 1e-3)
        ratio = slope / (2.0 * trace.contact_radius[0] * jkr(STIFF).plane_modulus)
        share = measures.on_line(trace, slope)
        part = near(
            f"V = {v:g}: straight over {share:.2f}, first slope over 2 a E∞*", ratio, 1.0, 2 * RECOVERED
        )
        yield replace(part, holds=part.holds and share >= 0.1, values=part.values | {"share": share})


@claim(FIG4, HOLDS)
def fast_pull_off_is_large(runs: Evidence) -> Iterator[Part]:
    """At high speed the pull-off force is much larger than the JKR value."""
    yield above(f"F_off/F_JKR at V = {FAST:g}", runs.pull_off(retraction(FAST)), 2.0)


@claim(FIG4, HOLDS)
def fast_edge_is_griffith(runs: Evidence) -> Iterator[Part]:
    """At fast pull-off the material is glassy: G = K²/(2E∞*) equals the work of adhesion; nothing is
    tougher."""
    for solver in BOTH:
        trace = runs.trace(retraction(FAST), solver)
        intensity = trace.extra["stress_intensity_factor"][measures.tension_row(trace)]
        tip = intensity**2 / (2.0 * jkr(STIFF).plane_modulus * jkr(STIFF).work)
        yield near(f"{solver}: K²/(2E∞* Δγ) at pull-off", tip)
        yield near(f"{solver}: G/Δγ of the balance", at_pull_off(runs, FAST, solver), 1.0, 2 * RECOVERED)


@claim(FIG4, HOLDS)
def fast_curves_are_not_jkr(runs: Evidence) -> Iterator[Part]:
    """In fast retraction force-penetration and force-area curves differ significantly from JKR's, and JKR
    does not predict the pull-off force."""
    trace = runs.trace(retraction(FAST))
    rows = measures.withdrawal(trace)
    a, force = trace.contact_radius[rows], trace.force[rows]
    for glassy, name in ((SOFT, "E₀"), (STIFF, "E∞")):
        apart = np.abs(force - jkr(glassy).force(a)).max() / np.abs(force).max()
        yield above(f"F(a) off JKR with {name}, over the largest force", apart, LARGER - 1)
    yield above("F_off/F_JKR", runs.pull_off(retraction(FAST)), LARGER)


@claim(FIG4, HOLDS)
def pull_off_falls_with_speed(runs: Evidence) -> Iterator[Part]:
    """The pull-off force falls monotonically with falling speed, to the elastic JKR value for extremely slow
    retraction."""
    curve = runs.pull_offs(retraction, sweeps.RETRACTION_SPEEDS)
    yield rises("F_off/F_JKR over V", curve)
    yield near("slowest, elastic:", curve[SLOWEST], elastic_pull_off(elastic(SOFT)))


@claim(FIG4, HOLDS)
def elongation_is_largest_between(runs: Evidence) -> Iterator[Part]:
    """Very slow retraction has the soft elastic elongation before pull-off; at intermediate speed it is
    significantly larger."""
    soft = elastic(SOFT).pull_off_penetration_control().penetration
    curve = {v: runs.measure(retraction(v), "final_penetration") / soft for v in sweeps.RETRACTION_SPEEDS}
    # slowest: it ends at the length of the process zone, as creep slows the final instability down
    yield near("Δ where contact ends over the elastic one: slowest", curve[SLOWEST], 1.0, 2 * RECOVERED)
    yield peaks("over V", curve, LARGER)


@claim(FIG4, IN_PART)
def small_scale_is_effective_jkr(runs: Evidence) -> Iterator[Part]:
    """In the small-scale regime (slow, bulk relaxed) load-penetration and load-area curves are well
    approximated by JKR with the work of adhesion replaced by G."""
    for v in (5e-5, 2e-4, 5e-4):
        trace = runs.trace(retraction(v))
        row, a = measures.tension_row(trace), trace.contact_radius
        law = replace(jkr(SOFT), work=at_pull_off(runs, v) * jkr(SOFT).work)
        near_it = (a > 0.8 * a[row]) & (a < 1.25 * a[row])  # radii about that at pull-off, G as there
        top, travel = -trace.force[row], trace.penetration[0] - trace.penetration[row]
        force = np.abs(law.force(a) - trace.force)[near_it].max() / top
        depth = np.abs(law.penetration(a) - trace.penetration)[near_it].max() / travel
        yield near(
            f"V = {v:g}: JKR's tension with G over that found", -law.pull_off_force_control().force / top
        )
        yield below("F(a) off by, over it,", force, 2 * RECOVERED)
        yield below("Δ(a) off by, over the way to pull-off,", depth, 2 * RECOVERED)


@claim("Abstract; Sec. III, Fig. 4", IN_PART)
def detachment_at_constant_area(runs: Evidence) -> Iterator[Part]:
    """Fast retraction after relaxation ends in a flat-punch-like detachment: the contact area is constant
    until pull-off."""
    frozen = frozen_edge()
    exact = (frozen.pull_off().contact_radius / frozen.relaxed.contact_radius) ** 2
    yield near("share of the area kept at pull-off: infinitely fast, without process zone", exact)
    for v in (FAST, FASTEST):
        trace = runs.trace(retraction(v))
        kept = (trace.contact_radius[measures.tension_row(trace)] / trace.contact_radius[0]) ** 2
        yield near(f"V = {v:g}, process zone of the paper", kept)


def frozen_edge() -> FrozenRetraction:
    """An infinitely fast retraction from point B, with a vanishing process zone."""
    scene = retraction(FAST)
    assert scene.adhesion is not None
    return FrozenRetraction(scene.material, scene.indenter, scene.adhesion.work, sweeps.DEPTH)


@claim(PRELOADED, HOLDS)
def preload_plateau(runs: Evidence) -> Iterator[Part]:
    """With growing initial penetration the enhancement reaches a plateau, F_off/F_JKR ≈ E∞/E₀ at very high
    speed."""
    curve = runs.pull_offs(lambda depth: retraction(sweeps.PRELOAD_SPEEDS[-1], depth), sweeps.PRELOADS)
    *_, before, last = curve.values()
    yield rises(f"F_off/F_JKR at V = {sweeps.PRELOAD_SPEEDS[-1]:g} over the penetration", curve, 0.01)
    yield near("last two alike:", last, before)
    yield near("E∞/E₀ at the end:", last, MOST, 2 * RECOVERED)


@claim(PRELOADED, HOLDS)
def preload_lower_speed_is_weaker(runs: Evidence) -> Iterator[Part]:
    """At every preload a lower speed gives a lower pull-off force."""
    for depth in sweeps.PRELOADS:
        curve = runs.pull_offs(partial(retraction, depth=depth), sweeps.PRELOAD_SPEEDS)
        yield rises(f"Δ_B = {depth:g}: F_off/F_JKR over V", curve)


@claim("Abstract; Sec. III", HOLDS)
def relaxing_first_holds_more(runs: Evidence) -> Iterator[Part]:
    """Retraction after full relaxation enhances the pull-off force even more than approach-retraction cycles
    do."""
    for v in (2e-3, 6e-3, 2e-2, 0.1, 10.0):
        ratio = runs.pull_off(retraction(v)) / runs.pull_off(cycle(v))
        yield above(f"V = {v:g}: pull-off force over that of the cycle", ratio, 1.001)


@claim(RESTS, HOLDS)
def approach_does_not_know(runs: Evidence) -> Iterator[Part]:
    """The approach is not affected by the rest that follows."""
    traces = [runs.trace(cycle(RESTED_SPEED, dwell=rest)) for rest in sweeps.DWELLS]
    force = np.array([trace.force[end_of_approach(trace)] for trace in traces])
    yield below("force at its end over the rests spreads by", np.ptp(force) / force.mean(), SAME_APPROACH)


@claim(RESTS, HOLDS)
def longer_rest_holds_more(runs: Evidence) -> Iterator[Part]:
    """At V = 0.1 a rest longer than τ raises the pull-off force, the more the longer."""
    curve = runs.pull_offs(lambda rest: cycle(RESTED_SPEED, dwell=rest), sweeps.DWELLS)
    beyond = [force for rest, force in curve.items() if rest >= 1.0]
    yield over("F_off/F_JKR over the rest:", curve, rising(beyond) and beyond[-1] > beyond[0])


@claim(RESTS, HOLDS)
def long_rest_is_relaxed(runs: Evidence) -> Iterator[Part]:
    """After a rest much longer than τ the retraction approaches that of the relaxed contact (flat punch),
    with very large pull-off force."""
    last, none = (runs.pull_off(cycle(RESTED_SPEED, dwell=rest)) for rest in (sweeps.DWELLS[-1], 0.0))
    relaxed = runs.pull_off(retraction(RESTED_SPEED))
    yield near(
        f"F_off/F_JKR after {sweeps.DWELLS[-1]:g} τ against that of the relaxed contact:", last, relaxed
    )
    yield above("over that without rest", last / none, 2.0)


@claim(RESTS, IN_PART)
def faster_needs_longer_rest(runs: Evidence) -> Iterator[Part]:
    """The faster the approach and retraction, the longer the rest it takes to relax and to enter the
    flat-punch regime."""
    needed = {}
    for v in sweeps.DWELL_SPEEDS:
        held = np.array([runs.pull_off(cycle(v, dwell=rest)) for rest in sweeps.DWELLS[1:]])
        reached = held / runs.pull_off(retraction(v))
        needed[v] = measures.crossing(sweeps.DWELLS[1:], reached, RELAXED)
    for slow, fast in pairwise(sweeps.DWELL_SPEEDS):
        both = {v: rest for v, rest in needed.items() if v in (slow, fast) and rest is not None}
        holds = len(both) == 2 and both[fast] > 1.1 * both[slow]
        yield over(f"rest over τ for {RELAXED:.0%} of the relaxed pull-off force, over V:", both, holds)


@claim(FIG5, IN_PART)
def jump_is_a_flat_punch(runs: Evidence) -> Iterator[Part]:
    """The jump of the load is answered by the glassy flat punch: F0 = F_B - 2 a_B E∞* (Δ_B - Δ0)."""
    exact = -frozen_edge().release().force / unit_sizes(load("force-2").scene)["jkr-force"]
    yield above(
        "vanishing process zone: exact until the frozen edge lets go, at F/F_JKR", exact, max(sweeps.FORCES)
    )
    for force in sweeps.FORCES:
        trace = runs.trace(f"force-{force}")
        jump = int(np.flatnonzero(trace.time <= 0.0)[-1])
        line = (trace.force[0] - trace.force[jump]) / (
            2.0 * trace.contact_radius[0] * jkr(STIFF).plane_modulus
        )
        moved = (trace.penetration[0] - trace.penetration[jump]) / line
        yield near(f"process zone of the paper, {force} F_JKR: jump of the penetration over that", moved)


@claim(FIG5, IN_PART)
def everything_falls_until_detachment(runs: Evidence) -> Iterator[Part]:
    """After the jump contact area, penetration and retraction speed fall monotonically, until the contact
    becomes unstable and detaches."""
    for force in sweeps.FORCES:
        trace = runs.trace(f"force-{force}")
        first, last = np.flatnonzero(trace.time <= 0.0)[-1], np.flatnonzero(trace.contact_radius > 0.0)[-1]
        rows = slice(first, last + 1)
        t, depth = trace.time[rows], trace.penetration[rows]
        moving = np.diff(t) > 0.0
        speed = -np.diff(depth)[moving] / np.diff(t)[moving]
        slowest = float(t[1:][moving][speed.argmin()] / t[-1])
        yield Part(f"{force} F_JKR: area falls", rising(-trace.contact_radius[rows], 1e-4))
        yield Part("penetration falls", rising(-depth, 1e-4))
        shown = f"speed falls until t = {slowest:.2f} of the time of detachment, {t[-1]:.3g} τ"
        yield Part(shown, rising(-speed, 0.01), {"slowest": slowest, "detachment": float(t[-1])})
        yield Part("contact is lost", str(trace.outcome.kind) == "detached")


@claim(FIG5, IN_PART)
def farther_than_at_constant_speed(runs: Evidence) -> Iterator[Part]:
    """Contact is lost at significantly larger elongation than in the retraction at constant speed that has
    the same pull-off force."""
    for force, v in sweeps.MATCHED.items():
        drawn = sweeps.DEPTH - runs.measure(f"force-{force}", "detachment_penetration")
        for name, where in (("pull_off", "the largest tension"), ("detachment", "detachment")):
            way = sweeps.DEPTH - runs.measure(retraction(v), f"{name}_penetration")
            shown = f"{force} F_JKR: withdrawn by {drawn:.4f} R, over that until {where} at V = {v:g}"
            yield above(shown, drawn / way, LARGER)


@claim(FIG6, HOLDS)
def starts_without_load(runs: Evidence) -> Iterator[Part]:
    """The initial penetration 5.7e-5 is that of the relaxed JKR contact without load."""
    trace, size = runs.trace("sweep"), unit_sizes(load("sweep").scene)["jkr-force"]
    yield below("|F|/F_JKR there", abs(trace.force[0] / size), RECOVERED)
    yield near("Δ, without load JKR's:", trace.penetration[0], jkr(SOFT, "sweep").at_force(0.0).penetration)


@claim(FIG6, HOLDS)
def stiffens_with_frequency(runs: Evidence) -> Iterator[Part]:
    """As the frequency rises the slope of force over penetration rises: the material stiffens."""
    trace, slopes = runs.trace("sweep"), []
    for one in sweep_cycles(runs):
        rows = (trace.time >= one.start) & (trace.time <= one.end)
        depth = trace.penetration[rows]
        slopes.append(float(np.polyfit(depth - depth.mean(), trace.force[rows], 1)[0]))
    stretches = enumerate(np.array_split(slopes, 6), 1)
    smooth = {float(n): float(np.mean(group)) / slopes[0] for n, group in stretches}
    yield rises("mean slopes of six stretches of the sweep", smooth, 0.0)
    yield above("last cycle over the first", slopes[-1] / slopes[0], LARGER)


@claim(FIG6, HOLDS)
def loss_is_the_loop(runs: Evidence) -> Iterator[Part]:
    """Energy lost per cycle is roughly the area of the loop."""
    cycles = sweep_cycles(runs)[1:]  # the first one starts from rest
    apart = max(abs(one.dissipated - one.loop) for one in cycles) / max(one.loop for one in cycles)
    yield below("loop and loss differ, over the largest loop, by", apart, 0.1)


@claim(FIG6, HOLDS)
def loss_peaks_at_one(runs: Evidence) -> Iterator[Part]:
    """Loss per cycle over frequency is bell-shaped, vanishes at very low and very high frequency, and is
    largest at ωτ of about 1."""
    cycles = sweep_cycles(runs)[1:]
    loop = np.array([one.loop for one in cycles])
    shares = {one.angular_frequency: one.loop / loop.max() for one in (cycles[0], cycles[-1])}
    yield near("largest at ωτ =", cycles[int(loop.argmax())].angular_frequency, 1.0, 0.1)
    yield over("bell over ωτ; over its largest:", shares, bell(loop))
    low, middle, high = load("sweep").scene.material.loss_modulus([0.01, 1.0, 100.0])
    shown = "beyond the sweep: loss modulus at ωτ = 0.01 and 100 over that at 1, at most"
    yield below(shown, max(low, high) / middle, RECOVERED)


@claim("Sec. III, Fig. 6(d)", HOLDS)
def oscillation_holds_more(runs: Evidence) -> Iterator[Part]:
    """Oscillations riding on a slow retraction raise the largest tension significantly above that of the
    steady one."""
    steady = runs.pull_off("retraction-steady")
    for w in sweeps.FREQUENCIES:
        yield above(f"ωτ = {w}: over the steady one", runs.pull_off(f"oscillation-w{w}") / steady, LARGER)


def at_pull_off(runs: Evidence, speed: float, solver: str = BOTH[0]) -> float:
    """``G/dg`` at the largest tension of the retraction from the relaxed contact."""
    trace, work = runs.trace(retraction(speed), solver), jkr(SOFT).work
    return measures.release_rate(trace, measures.tension_row(trace), work) / work


def approaching(runs: Evidence, speed: float, depth: float) -> float:
    """``G/dg`` at a penetration of the approach."""
    trace, work = runs.trace(cycle(speed)), jkr(SOFT).work
    return measures.release_rate(trace, measures.approach_row(trace, depth), work) / work


@claim("Sec. III.A, Eqs. (energybalance), (dissipated energy)", FAILS)
def loss_is_the_branch_integral(runs: Evidence) -> Iterator[Part]:
    """The loss of the energy balance is the integral of the branches' dissipation over the surface."""
    # a sharp edge sets free only K^2/(2 Einf*) of dg at its tip; the integral holds the rest
    for v in sweeps.CHECKED_SPEEDS:
        trace = runs.trace(retraction(v), REFERENCE)
        row = int(np.flatnonzero(trace.contact_radius > 0.0)[-1])
        opened = np.pi * (trace.contact_radius[0] ** 2 - trace.contact_radius[row] ** 2)
        apart = trace.extra["branch_dissipation"][row] - trace.dissipated_energy[row]
        shown = f"V = {v:g}: they differ, over Δγ times the area that opened, by"
        yield below(shown, abs(apart) / (jkr(SOFT).work * opened), RECOVERED)


@claim(FIG7, IN_PART)
def release_rate_lies_on_the_right_side(runs: Evidence) -> Iterator[Part]:
    """Loss is positive, so G is below the work of adhesion while the area grows and above it while it
    shrinks."""
    least = min(at_pull_off(runs, v) for v in sweeps.RETRACTION_SPEEDS)
    most = max(approaching(runs, v, depth) for v in sweeps.CYCLE_SPEEDS for depth in DEPTHS)
    bias = elastic(STIFF).energy_release_rate(0.15) / elastic(STIFF).work
    yield above("smallest G/Δγ at pull-off over V:", least, 1.0 - RECOVERED)
    shown = (
        f"largest G/Δγ on approach (an elastic contact with this process zone has {bias:.3f} at a = 0.15 R)"
    )
    yield below(shown, most, 1.0 + RECOVERED)


@claim(FIG7, HOLDS)
def release_rate_at_the_ends(runs: Evidence) -> Iterator[Part]:
    """Loss vanishes at very low and very high speed: there G tends to the work of adhesion, retracting and
    approaching."""
    for v in (SLOWEST, FASTEST):
        yield near(f"V = {v:g}: G/Δγ at pull-off", at_pull_off(runs, v), 1.0, 2 * RECOVERED)
        yield near("on approach", approaching(runs, v, DEPTHS[1]), 1.0, 2 * RECOVERED)


@claim(FIG7, IN_PART)
def release_rate_is_a_bell(runs: Evidence) -> Iterator[Part]:
    """Between, G at pull-off rises to a maximum and falls again: bell-shaped over speed."""
    curve = {v: at_pull_off(runs, v) for v in sweeps.RETRACTION_SPEEDS}
    slower = [rate for v, rate in curve.items() if v <= SETTING_OUT]
    later = max(rate for v, rate in curve.items() if v > SETTING_OUT)
    part = peaks(f"one maximum up to V = {SETTING_OUT:g}: G/Δγ", curve, later * LARGER)
    yield replace(part, holds=part.holds and bell(slower))
    falling = {v: rate for v, rate in reversed(curve.items()) if v >= part.values["at"]}
    yield rises("from there G/Δγ falls with V, or backwards", falling)


@claim(FIG7, HOLDS)
def release_rate_can_be_negative(runs: Evidence) -> Iterator[Part]:
    """Pressed in at intermediate speed, G can be negative: the loss exceeds the work of adhesion."""
    for depth in DEPTHS:
        yield peaks(
            f"Δ/R = {depth:g}: -G/Δγ", {v: -approaching(runs, v, depth) for v in sweeps.CYCLE_SPEEDS}, 0.0
        )


@claim(FIG7, HOLDS)
def infinite_crack_has_a_plateau(runs: Evidence) -> Iterator[Part]:
    """Opening a semi-infinite crack, the loss rises monotonically with speed to a plateau."""
    scene, speeds = load(BASE).scene, np.geomspace(1e-6, 1e4, 101)
    assert scene.adhesion is not None
    rates = opening(scene.material, scene.adhesion.zone, speeds)
    ends = {speeds[n]: float(rates[n]) for n in (0, -1)}
    yield over("exact G/Δγ of the same closure rises over V:", ends, rising(rates, 0.0))
    yield near("from five sixths of the decades on as at the end:", rates[-1], rates[-20], 0.01)


@claim(FIG7, HOLDS)
def pull_off_rises_to_its_limit(runs: Evidence) -> Iterator[Part]:
    """Though G is bell-shaped, the pull-off force rises with speed throughout, to about E∞/E₀."""
    curve = runs.pull_offs(retraction, sweeps.RETRACTION_SPEEDS)
    yield rises("F_off/F_JKR over V", curve)
    yield near("E∞/E₀ at the end (frozen limit of a vanishing zone 9.914):", curve[FASTEST], MOST)


@claim(FIG7, HOLDS)
def jkr_gives_the_release_rate_only_when_slow(runs: Evidence) -> Iterator[Part]:
    """Only at low speed, V up to about 5e-4, is G/Δγ about equal to F_off/F_JKR, so that the JKR formula
    gives G."""
    curve = {v: runs.pull_off(retraction(v)) / at_pull_off(runs, v) for v in sweeps.RETRACTION_SPEEDS}
    worst = max(abs(ratio - 1.0) for v, ratio in curve.items() if v <= QUOTED)
    yield over(
        f"at most {worst:.2f} off 1 up to {QUOTED:g}: (F_off/F_JKR)/(G/Δγ) over V:", curve, worst <= 0.15
    )
    beyond = min(ratio for v, ratio in curve.items() if v >= 10 * QUOTED)
    yield above(f"from {10 * QUOTED:g} on at least", beyond, LARGER)


@claim("Sec. III.A and Conclusions", HOLDS)
def jkr_overestimates_when_fast(runs: Evidence) -> Iterator[Part]:
    """At high speed JKR strongly overestimates G from the pull-off force, as G falls back to the work of
    adhesion."""
    for solver in BOTH:
        rate = at_pull_off(runs, FAST, solver)
        yield near(f"{solver}, V = {FAST:g}: G/Δγ", rate, 1.0, 2 * RECOVERED)
        yield above("F_off/F_JKR over it", runs.pull_off(retraction(FAST), solver) / rate, 2.0)


@claim("Abstract and Conclusions", IN_PART)
def cycles_gain_by_release_rate(runs: Evidence) -> Iterator[Part]:
    """In cycles at intermediate speed the loss near the contact's edge (small-scale) raises G and with it the
    pull-off force."""
    for v in (5e-4, 2e-3, 6e-3, 2e-2):
        trace, work = runs.trace(cycle(v)), jkr(SOFT).work
        rate = measures.release_rate(trace, measures.tension_row(trace), work) / work
        part = near(
            f"V = {v:g}: G = {rate:.2f} Δγ, F_off/F_JKR over that", runs.pull_off(cycle(v)) / rate, 1.0, 0.15
        )
        yield replace(part, holds=part.holds and rate > LARGER, values=part.values | {"rate": rate})
