"""Axes of the material: contrast, relaxation times, spectra, Poisson's ratio."""

from __future__ import annotations

import numpy as np

from contact_scene import Branch, Hold, Material
from validation.solvers import REFERENCE
from validation.solvers.finite_elements import FiniteElements
from validation.stability import base, closed_forms
from validation.stability.case import EquivalentScene, Expectation, ReferenceRuns, StabilityCase, Tolerance
from validation.stability.measure import CURVE

CYCLE = ReferenceRuns(
    ("approach_force", "pull_off_force", "loop_energy", CURVE), of_largest=("approach_force",)
)
CONTRASTS = (1.0, 10.0, 1e3, 1e6, 1e9)
"""``Einf/E0``."""
TIMES = (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12)
"""Relaxation time over the duration of the approach."""
PULLED = Tolerance(
    {FiniteElements.name: 4e-2},
    "the edge recedes all the way, and elements round it down by part of one: 1.4 % of the force at 4 a zone",
)
SAME = Tolerance({}, "the same question: round-off only, amplified where contact is lost", other=1e-9)
STEPPED = Tolerance(
    {REFERENCE: 2e-4},
    "the same answer, but a further time may change the steps: their error, as F(t) RMS or row by row",
    other=2e-3,
)
RATIOS = (0.0, 0.3, 0.49, 0.4999, 0.5)
"""Poisson's ratios."""
PUSH = 0.01
"""Speed of adhesionless cycles, ``R`` per relaxation time."""


def contrast() -> list[StabilityCase]:
    """``Einf/E0``: an adhesionless cycle, a cycle slow against creep, and a relaxed contact pulled off.

    The slow cycle takes ``1e7`` retardation times. The pull has ``V tau_c = da``: the edge feels the creep.
    """
    cases = []
    for ratio in CONTRASTS:
        material = base.material(ratio)
        creep = ratio  # retardation time, in relaxation times
        label = f"Einf/E0 = {ratio:g}"
        adhesionless = base.scene(material, base.press_and_pull(PUSH), adhesion=None)
        expected = closed_forms.adhesionless_cycle(material, base.SPHERE, PUSH, base.TOP)
        cases.append(
            StabilityCase(
                "contrast",
                f"{label}, adhesionless",
                adhesionless,
                expected,
                series="adhesionless cycle" if ratio > 1.0 else "",
                stiffness=ratio,
            )
        )
        slow = base.scene(material, base.press_and_pull(1e-7 / creep), start="relaxed")
        elastic = closed_forms.elastic_cycle(slow, material.relaxed_plane_modulus, "E0", at_once=ratio == 1.0)
        cases.append(
            StabilityCase(
                "contrast",
                f"{label}, slow",
                slow,
                elastic,
                series="slow cycle" if ratio > 1.0 else "",
                stiffness=ratio,
            )
        )
        pull = base.scene(
            material, base.press_and_pull(base.ZONE / creep, away=-20.0)[1:], "relaxed", base.TOP
        )
        cases.append(
            StabilityCase(
                "contrast",
                f"{label}, V tau_c = da",
                pull,
                _pull(),
                PULLED,
                series="pull" if ratio > 1.0 else "",
                stiffness=ratio,
            )
        )
    return cases


def _pull() -> ReferenceRuns:
    return ReferenceRuns(("start_force", "pull_off_force", "loop_energy", CURVE))


def times() -> list[StabilityCase]:
    """Relaxation time over the duration of the loading, from a relaxed start and from a glassy one."""
    cases = []
    speed = base.TOP  # the approach takes one unit of time
    for ratio in TIMES:
        material = base.material(time=ratio)
        label = f"tau/T = {ratio:g}"
        stiffness = max(ratio, 1.0 / ratio)
        side = "slow response" if ratio > 1.0 else "fast response"
        timed = stiffness > 1.0  # neither slow nor fast at one
        cycle = base.scene(material, base.press_and_pull(speed))
        expected: Expectation
        if ratio <= 1e-6:
            expected = closed_forms.elastic_cycle(cycle, material.relaxed_plane_modulus, "E0", at_once=False)
        elif ratio >= 1e6:
            expected = closed_forms.elastic_cycle(cycle, material.glassy_plane_modulus, "Einf")
        else:
            expected = CYCLE
        cases.append(
            StabilityCase(
                "relaxation time",
                f"{label}, glassy start",
                cycle,
                expected,
                series=f"cycle, {side}" if timed else "",
                stiffness=stiffness,
            )
        )
        pull = base.scene(material, base.press_and_pull(speed)[1:], "relaxed", base.TOP)
        cases.append(
            StabilityCase(
                "relaxation time",
                f"{label}, pulled from rest",
                pull,
                _pull(),
                PULLED,
                series=f"pull, {side}" if timed else "",
                stiffness=stiffness,
            )
        )
    return cases


def spectra() -> list[StabilityCase]:
    """Many branches, spread, nearly equal, or of no weight."""
    share = base.MODULUS * (base.CONTRAST - 1.0)
    cases = []
    for count, decades in ((1, 0), (2, 6), (7, 6), (7, 15), (30, 8), (30, 15)):
        spread = np.logspace(-0.5 * decades, 0.5 * decades, count)
        material = Material(base.MODULUS, base.POISSON, tuple(Branch(share / count, t) for t in spread))
        label = f"{count} branch{'es' if count > 1 else ''}" + (f", {decades} decades" if decades else "")
        cases += _both(label, material)
    near = Material(base.MODULUS, base.POISSON, (Branch(share / 2, 1.0), Branch(share / 2, 1.0 + 1e-9)))
    plain = base.scene(base.material(), base.press_and_pull(0.02))
    pairs = [("two times within 1e-9", near, STEPPED)]
    for weight, tolerance in ((1e-12, STEPPED), (1e-40, SAME)):
        for time in (1e-9, 1e3):
            extra = Material(base.MODULUS, base.POISSON, (Branch(share, 1.0), Branch(weight, time)))
            pairs.append((f"a branch of weight {weight:g} at {time:g} tau", extra, tolerance))
    for label, material, tolerance in pairs:
        cycle = base.scene(material, base.press_and_pull(0.02))
        cases.append(StabilityCase("spectrum", label, cycle, EquivalentScene(plain), tolerance))
    return cases


def _both(label: str, material: Material) -> list[StabilityCase]:
    adhesionless = base.scene(material, base.press_and_pull(PUSH), adhesion=None)
    expected = closed_forms.adhesionless_cycle(material, base.SPHERE, PUSH, base.TOP)
    cycle = base.scene(material, (*base.press_and_pull(0.02)[:1], Hold(1.0), *base.press_and_pull(0.02)[1:]))
    return [
        StabilityCase("spectrum", f"{label}, adhesionless", adhesionless, expected),
        StabilityCase("spectrum", f"{label}, with a hold", cycle, CYCLE),
    ]


def poisson() -> list[StabilityCase]:
    """Poisson's ratio at the same plane modulus: the answer does not depend on it."""
    cases = []
    for ratio in RATIOS:
        material = base.material(poisson=ratio)
        cycle = base.scene(material, base.press_and_pull(0.02))
        cases.append(StabilityCase("Poisson's ratio", f"nu = {ratio:g}", cycle, CYCLE))
        adhesionless = base.scene(material, base.press_and_pull(PUSH), adhesion=None)
        expected = closed_forms.adhesionless_cycle(material, base.SPHERE, PUSH, base.TOP)
        cases.append(
            StabilityCase("Poisson's ratio", f"nu = {ratio:g}, adhesionless", adhesionless, expected)
        )
    return cases
