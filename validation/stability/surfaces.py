"""Axes of the surface: work of adhesion, process zone, shape of the indenter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contact_scene import (
    Adhesion,
    Cone,
    FlatPunch,
    Hold,
    Indenter,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    TabulatedProfile,
)
from validation.reference import sneddon
from validation.solvers import solvers
from validation.stability import base, closed_forms
from validation.stability.case import (
    ClosedForm,
    NoSolution,
    ReferenceRuns,
    StabilityCase,
    Value,
    scene_or_refusal,
)
from validation.stability.materials import PULLED
from validation.stability.measure import CURVE

PULL = ReferenceRuns(("start_force", "pull_off_force", "loop_energy", CURVE))
PEELED = ReferenceRuns(("start_force", "pull_off_force", "loop_energy", CURVE), fine=8, coarse=4)
SHARES = (1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0 / 3.0, 0.5)
"""Process zone over contact radius, ``da/a``."""
ANGLES = (89.9, 85.0, 45.0, 10.0)
"""Half-angles of the cones, in degrees."""
REACH = 0.1
"""Contact radius of adhesionless indenters at the largest penetration, over the sphere's ``R``."""
SEED = 7
"""Of the noise on tabulated profiles."""
WIDE_BEYOND = 0.3
"""``da/a`` above which the contact shrinks to the zone before it detaches."""
NOT_COMPARED_WIDE = ("approach_force", "approach_radius", "final_penetration", "dissipated_energy")
"""Observables that are not compared for zones beyond ``WIDE_BEYOND``."""
WIDE = ReferenceRuns(("start_force", "pull_off_force"), fine=40, coarse=20)
PACE = 0.3
"""Speed of the penetration at the shortest zone, ``V tau/da``: the edge moves a few zones in a relaxation
time, and what it takes up depends on its speed; at a speed given in radii it opens as a glass does."""


def adhesion() -> list[StabilityCase]:
    """``gamma~`` from none to strong; zones from a millionth of the contact radius to beyond it."""
    material = base.material()
    none = base.scene(material, base.press_and_pull(0.01), adhesion=Adhesion(0.0, base.ZONE))
    cases = [
        StabilityCase(
            "adhesion",
            "gamma~ = 0",
            none,
            closed_forms.adhesionless_cycle(material, base.SPHERE, 0.01, base.TOP),
        )
    ]
    faint = base.scene(
        base.material(1.0), (Ramp(base.AWAY, 1.0),), "relaxed", base.TOP, Adhesion(math.pi * 1e-12, 2e-3)
    )
    cases.append(StabilityCase("adhesion", "gamma~ = 1e-12, elastic", faint, _faint(faint)))
    for gamma, zone in ((1e-12, 2e-3), (1.6e-4, 0.013), (1e-2, 0.02)):
        adhering = base.scene(
            material, (Hold(1.0), Ramp(-2.0, 0.02)), "relaxed", base.TOP, Adhesion(math.pi * gamma, zone)
        )
        cases.append(StabilityCase("adhesion", f"gamma~ = {gamma:g}", adhering, PULL, PULLED))
    strong = base.scene(material, base.press_and_pull(1e6), adhesion=Adhesion(math.pi * 1e-2, 0.02))
    cases.append(
        StabilityCase(
            "adhesion",
            "gamma~ = 1e-2, fast",
            strong,
            closed_forms.elastic_cycle(strong, material.glassy_plane_modulus, "Einf"),
        )
    )
    return cases + _zones()


def _faint(scene: Scene) -> ClosedForm:
    """Nearly Hertz: lost where the penetration is back at zero."""
    state = closed_forms.zone_law(scene, scene.material.relaxed_plane_modulus).at_penetration(base.TOP)
    values = (
        Value("start_force", state.force),
        Value("start_radius", state.contact_radius),
        Value("detachment_penetration", 0.0, base.TOP),
    )
    return ClosedForm(values, "elastic closure of finite zone, nearly Hertz", (OutcomeKind.DETACHED,))


def _zones() -> list[StabilityCase]:
    soft, material = base.material(1.0), base.material()
    radius = closed_forms.zone_law(base.scene(soft, ()), 1.0).at_penetration(base.TOP).contact_radius
    cases = []
    for share in SHARES:
        law = Adhesion(base.WORK, share * radius)
        observables, more = _compared_at(share)
        elastic = base.scene(soft, (Ramp(base.AWAY, 1.0),), "relaxed", base.TOP, law)
        expected = closed_forms.elastic_cycle(elastic, 1.0, "E0")
        left_out = NOT_COMPARED_WIDE if share > WIDE_BEYOND else ("approach_force", "approach_radius")
        values = tuple(value for value in expected.values if value.name not in left_out)
        expected = ClosedForm(values, expected.source, expected.endings)
        viscoelastic = base.scene(material, (Ramp(base.AWAY, 0.02),), "relaxed", base.TOP, law)
        label = f"da/a = {share:.3g}"
        cases += [
            StabilityCase("process zone", f"{label}, elastic", elastic, expected, PULLED, **more),
            StabilityCase(
                "process zone", f"{label}, V tau/R = 0.02", viscoelastic, observables, PULLED, **more
            ),
        ]
    shortest = min(SHARES)
    law = Adhesion(base.WORK, shortest * radius)
    slow = base.scene(material, (Ramp(base.AWAY, PACE * law.zone),), "relaxed", base.TOP, law)
    label = f"da/a = {shortest:.3g}, V tau/da = {PACE:g}"
    cases.append(StabilityCase("process zone", label, slow, PEELED, PULLED))
    for share in (1.5, 100.0):
        law = Adhesion(base.WORK, share * radius)
        longer = base.scene(material, (Ramp(base.AWAY, 0.02),), "relaxed", base.TOP, law)
        why = "a process zone longer than the contact"
        cases.append(StabilityCase("process zone", f"da/a = {share:.3g}", longer, NoSolution(why)))
    return cases


def _compared_at(share: float) -> tuple[ReferenceRuns, dict[str, Any]]:
    """Observables to compare, and resolutions.

    The longest zones take more divisions each, and beyond the pull-off the contact shrinks to the zone, where
    the model ends and nothing is compared.
    """
    if share > WIDE_BEYOND:
        finer = {one.name: 3 * one.coarse_resolution(adhesive=True) for one in solvers()}
        return WIDE, {"resolutions": finer}
    return PEELED, {}


def indenters() -> list[StabilityCase]:
    """Punch, cones, a steep power law, tables with noise; without and with adhesion."""
    material = base.material()
    punch = base.scene(material, (Ramp(base.TOP, 0.01),), adhesion=None, indenter=FlatPunch(0.2))
    cases = [
        StabilityCase(
            "indenter",
            "flat punch, adhesionless",
            punch,
            closed_forms.punch_ramp(material, 0.2, 0.01, base.TOP),
        )
    ]
    shapes: list[tuple[str, Indenter]] = [(f"cone {angle:g}°", Cone(angle)) for angle in ANGLES]
    shapes += [("power law 8", PowerLaw(8.0, 1.0)), ("table, noise 0.1 %", _table(1e-3))]
    for label, shape in shapes:
        top = float(sneddon.depth(shape, REACH))
        adhesionless = base.scene(
            material, base.press_and_pull(top, top, -10.0 * top), adhesion=None, indenter=shape
        )
        expected = closed_forms.adhesionless_cycle(material, shape, top, top)
        cases.append(StabilityCase("indenter", f"{label}, adhesionless", adhesionless, expected))
    held: list[tuple[str, Indenter, float]] = [
        ("flat punch", FlatPunch(0.2), 0.0),
        ("cone 85°", Cone(85.0), 0.01),
        ("cone 45°", Cone(45.0), 0.001),
        ("power law 8", PowerLaw(8.0, 1.0), 0.0),
        ("table, noise 0.1 %", _table(1e-3), base.TOP),
    ]
    for label, shape, top in held:
        law = Adhesion(base.WORK, 1e-4) if label == "cone 45°" else base.ADHESION  # contact is lost at 3e-4
        pulled = base.scene(material, (Ramp(top - 1.0, 0.02),), "relaxed", top, law, shape)
        cases.append(StabilityCase("indenter", label, pulled, PULL, PULLED))
    falling = scene_or_refusal(lambda: base.scene(material, base.press_and_pull(0.02), indenter=_table(0.3)))
    cases.append(
        StabilityCase("indenter", "table that falls, noise 30 %", falling, NoSolution("a profile that falls"))
    )
    return cases


def _table(noise: float) -> TabulatedProfile:
    """The sphere at 41 radii, relative noise of this size on every height."""
    radii = np.linspace(0.0, 0.6, 41)
    scatter = 1.0 + noise * np.random.default_rng(SEED).standard_normal(radii.size)
    heights = 0.5 * radii**2 / base.RADIUS * scatter
    return TabulatedProfile(tuple(radii.tolist()), tuple(heights.tolist()))
