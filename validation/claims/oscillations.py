"""Claims of Sec. III on oscillating penetration (Fig. 6)."""

from __future__ import annotations

import numpy as np

from validation.cases import load
from validation.claims import elastic
from validation.claims.claim import HOLDS, Part, claim
from validation.claims.evidence import FREQUENCIES, Evidence
from validation.claims.measures import LARGER, RECOVERED, bell
from validation.measure.observables import CycleLoss, cycle_losses
from validation.measure.scaling import unit_sizes
from validation.measure.windows import cycle_times

PLACE = "Sec. III, Fig. 6"


@claim(PLACE, "The initial penetration 5.7e-5 is that of the relaxed JKR contact without load.", HOLDS)
def starts_without_load(evidence: Evidence) -> list[Part]:
    """Force of the first row, and the penetration at which JKR carries none."""
    trace, size = evidence.trace("sweep"), unit_sizes(load("sweep").scene)["jkr-force"]
    free = elastic.vanishing(False, "sweep").at_force(0.0).penetration
    force = float(trace.force[0] / size)
    return [
        Part(
            f"F = {force:.3f} F_JKR there; without load JKR has Δ/R = {free:.3e}",
            abs(force) <= RECOVERED and abs(trace.penetration[0] / free - 1.0) <= RECOVERED,
            {"force": force, "free_penetration": free},
        )
    ]


def losses(evidence: Evidence) -> tuple[CycleLoss, ...]:
    """Loss of every cycle of the sweep."""
    return cycle_losses(evidence.trace("sweep"), cycle_times(load("sweep").scene.loading))


def stiffness(evidence: Evidence) -> list[float]:
    """Slope of force over penetration in every cycle of the sweep: regression, ``cov(F, D)/var(D)``."""
    trace = evidence.trace("sweep")
    slopes = []
    for one in losses(evidence):
        rows = (trace.time >= one.start) & (trace.time <= one.end)
        depth, force = trace.penetration[rows], trace.force[rows]
        slopes.append(float(np.polyfit(depth - depth.mean(), force, 1)[0]))
    return slopes


@claim(
    PLACE, "As the frequency rises the slope of force over penetration rises: the material stiffens.", HOLDS
)
def stiffens_with_frequency(evidence: Evidence) -> list[Part]:
    """Regression slopes of force over penetration, averaged over six stretches of the sweep."""
    slopes = stiffness(evidence)
    smooth = [float(np.mean(group)) for group in np.array_split(slopes, 6)]
    shown = ", ".join(f"{s / smooth[0]:.2f}" for s in smooth)
    return [
        Part(
            f"mean slopes of six stretches of the sweep, relative: {shown}; last cycle "
            f"{slopes[-1] / slopes[0]:.2f} times the first",
            smooth == sorted(smooth) and slopes[-1] > LARGER * slopes[0],
            {"last_over_first": slopes[-1] / slopes[0]},
        )
    ]


@claim(PLACE, "Energy lost per cycle is roughly the area of the loop.", HOLDS)
def loss_is_the_loop(evidence: Evidence) -> list[Part]:
    """Loop integral and loss from the balance, cycle by cycle."""
    cycles = losses(evidence)[1:]  # the first one starts from rest
    top = max(one.loop for one in cycles)
    apart = max(abs(one.dissipated - one.loop) for one in cycles) / top
    return [
        Part(
            f"loop and loss differ by at most {apart:.3f} of the largest loop", apart <= 0.1, {"apart": apart}
        )
    ]


@claim(
    PLACE,
    "Loss per cycle over frequency is bell-shaped, vanishes at very low and very high frequency, and is "
    "largest at ωτ of about 1.",
    HOLDS,
)
def loss_peaks_at_one(evidence: Evidence) -> list[Part]:
    """Loop integral over the mean frequency of each cycle; beyond the sweep the loss modulus."""
    cycles = losses(evidence)[1:]
    loop = np.array([one.loop for one in cycles])
    size = unit_sizes(load("sweep").scene)["energy"]
    top = int(loop.argmax())
    far = load("sweep").scene.material.loss_modulus([0.01, 1.0, 100.0])
    return [
        Part(
            f"largest, L = {loop[top] / size:.4g}, at ωτ = {cycles[top].angular_frequency:.3f}",
            abs(cycles[top].angular_frequency - 1.0) <= 0.1,
            {"frequency": cycles[top].angular_frequency, "loss": float(loop[top] / size)},
        ),
        Part(
            f"{loop[0] / loop[top]:.2f} of it at ωτ = {cycles[0].angular_frequency:.2f}, "
            f"{loop[-1] / loop[top]:.2f} at {cycles[-1].angular_frequency:.2f}",
            bell(loop),
            {"first": float(loop[0] / loop[top]), "last": float(loop[-1] / loop[top])},
        ),
        Part(
            f"beyond the sweep: loss modulus at ωτ = 0.01 and 100 is {far[0] / far[1]:.3f} and "
            f"{far[2] / far[1]:.3f} of that at 1",
            bool(far[0] < RECOVERED * far[1] and far[2] < RECOVERED * far[1]),
        ),
    ]


@claim(
    "Sec. III, Fig. 6(d)",
    "Oscillations riding on a slow retraction raise the largest tension significantly above that of the "
    "steady one.",
    HOLDS,
)
def oscillation_holds_more(evidence: Evidence) -> list[Part]:
    """Largest tension with the oscillation and without."""
    steady = evidence.pull_off("retraction-steady")
    parts = []
    for frequency in FREQUENCIES:
        value = evidence.pull_off(f"oscillation-w{frequency}")
        parts.append(
            Part(
                f"ωτ = {frequency}: {value:.3f} F_JKR, steady {steady:.3f}",
                value > LARGER * steady,
                {f"w_{frequency}": value, "steady": steady},
            )
        )
    return parts


CLAIMS = (
    starts_without_load,
    stiffens_with_frequency,
    loss_is_the_loop,
    loss_peaks_at_one,
    oscillation_holds_more,
)
