"""Axis of the machine: springs from a millionth to a million times the stiffness of the contact."""

from __future__ import annotations

import math
from dataclasses import replace

from contact_scene import Loading, Machine, Material, OutcomeKind, Ramp, Scene
from validation.reference.spring import SpringContact
from validation.stability import base, closed_forms
from validation.stability.case import (
    ClosedForm,
    EquivalentScene,
    ReferenceRuns,
    StabilityCase,
    Tolerance,
    Value,
)
from validation.stability.materials import SAME
from validation.stability.measure import CURVE

SHARES = (1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6)
"""Stiffness of the spring, in those of the elastic contact where its tension is largest."""
ELASTIC = Tolerance({"reference": 1e-4}, "elastic limit points at the coarse resolutions", other=5e-3)
BEYOND = 0.5
"""Path of the stage beyond the limit point, relative to that from the start to it."""
SPEED = 0.02
"""Speed of the indenter where force and penetration of the contact change as they would without adhesion."""
LEVEL = 4.0 / 3.0 * base.TOP**1.5
"""Force at which the approach of a cycle ends: of the relaxed contact at ``TOP``, without adhesion."""


def springs() -> list[StabilityCase]:
    """Limit points of an elastic contact, the viscoelastic cycle, and a rigid machine."""
    elastic = base.material(contrast=1.0)
    law = closed_forms.zone_law(base.scene(elastic, ()), elastic.relaxed_plane_modulus)
    unit = 2.0 * law.plane_modulus * law.pull_off_force_control().contact_radius
    cases = [_limit_point(elastic, share, share * unit) for share in SHARES]
    plain = base.scene(base.material(), base.press_and_pull(SPEED))
    rigid = replace(plain, loading=replace(plain.loading, machine=Machine(math.inf)))
    cases.append(StabilityCase("spring", "rigid", rigid, EquivalentScene(plain), SAME))
    for share in (1e-3, 0.1, 1.0, 10.0, 1e3):
        runs = ReferenceRuns(("pull_off_force", "stage_at_detachment", "loop_energy", CURVE))
        cases.append(StabilityCase("spring", f"cycle, k = {share:g}", _cycle(plain, share, unit), runs))
    return cases


def _limit_point(material: Material, share: float, stiffness: float) -> StabilityCase:
    law = closed_forms.zone_law(base.scene(material, ()), material.relaxed_plane_modulus)
    spring = SpringContact(law, stiffness)
    lost, first = spring.pull_off(), spring.stage(law.at_penetration(base.TOP))
    last = spring.stage(lost)
    pull = Ramp(last - BEYOND * (first - last), 1.0)
    plain = base.scene(material, (pull,), "relaxed", base.TOP)
    pulled = replace(plain, loading=replace(plain.loading, machine=Machine(stiffness)))
    values = (
        Value("pull_off_force", -spring.largest_tension().force),
        Value("stage_at_detachment", last, first - last),
        Value("instability_loss", spring.lost_in_snap(), spring.energy(lost)),
    )
    expected = ClosedForm(values, "elastic closure of finite zone, least stage", (OutcomeKind.DETACHED,))
    return StabilityCase("spring", f"elastic, k = {share:g}", pulled, expected, ELASTIC)


def _cycle(plain: Scene, share: float, unit: float) -> Scene:
    """Press to a force and pull off, at a speed of the stage that moves the indenter as without a spring."""
    speed, stiffness = SPEED * (1.0 + 1.0 / share), share * unit
    farthest = 10.0 * (base.TOP + LEVEL / stiffness)
    steps = (Ramp(farthest, speed, until_force=LEVEL), Ramp(-farthest, speed))
    return replace(plain, loading=Loading("jump-in", 0.0, steps, Machine(stiffness)))
