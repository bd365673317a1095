"""Axes of the loading: degenerate steps, jumps, many cycles, dead loads, starts without equilibrium."""

from __future__ import annotations

import math
from typing import Any

from scipy.optimize import brentq

from contact_scene import FlatPunch, Force, Hold, Oscillate, OutcomeKind, Scene, Table
from validation.reference import punch_oscillation
from validation.solvers import REFERENCE, SOLVERS
from validation.solvers.boundary_elements import BoundaryElements
from validation.stability import base, closed_forms
from validation.stability.case import (
    ClosedForm,
    EquivalentScene,
    NoSolution,
    ReferenceRuns,
    StabilityCase,
    Tolerance,
    Value,
)
from validation.stability.materials import SAME
from validation.stability.measure import CURVE

CYCLES = 1000
"""Cycles of the long oscillations."""
MARGINS = (0.3, 0.1, 0.03, 0.01, 3e-3)
"""Distances of dead loads from the slow pull-off force, relative to it."""
DELAY = ReferenceRuns(("detachment_time",))
FORCE_ERROR = 1e-3
"""Relative error of the slow pull-off force at the coarse resolutions; of the front tracking, a tenth."""


def loading() -> list[StabilityCase]:
    """Holds of no length, reversals within a step, jumps, many cycles, starts without equilibrium."""
    material = base.material()
    hard, soft = material.glassy_plane_modulus, material.relaxed_plane_modulus
    up, down = base.press_and_pull(0.02)
    plain = base.scene(material, (up, down))
    with_holds = base.scene(material, (Hold(0.0), up, Hold(0.0), Hold(0.0), down))
    cases = [StabilityCase("loading", "holds of no length", with_holds, EquivalentScene(plain), SAME)]

    flick = Table((0.0, 0.2, 0.2 + 1e-6, 0.2 + 2e-6, 0.5), (0.0, 0.004, 0.006, 0.004, base.TOP))
    spike = base.scene(material, (flick, down))
    names = ("approach_force", "pull_off_force", "loop_energy", CURVE)
    cases.append(StabilityCase("loading", "reversal within 1e-6 tau", spike, ReferenceRuns(names)))

    period = 2.0 * math.pi / 1e6
    swing = base.scene(material, (Oscillate(0.002, 1e6, 1.25 * period),))
    turned = closed_forms.rest(swing, 0.002, hard, "Einf")
    cases.append(StabilityCase("loading", "oscillation far faster than tau", swing, turned))

    jumped = base.scene(material, (Table((0.0, 1e-9), (base.TOP, base.TOP)),))
    cases.append(
        StabilityCase(
            "loading", "jump of the penetration", jumped, closed_forms.rest(jumped, base.TOP, hard, "Einf")
        )
    )
    settled = base.scene(material, (Table((0.0, 1e5), (base.TOP, base.TOP)),))
    cases.append(
        StabilityCase("loading", "jump, then rest", settled, closed_forms.rest(settled, base.TOP, soft, "E0"))
    )
    return cases + _cycles() + _starts()


def _cycles() -> list[StabilityCase]:
    """Small oscillations, then a rest: of a punch, and of a sphere that sticks."""
    material = base.material()
    duration, size, radius = 2.0 * math.pi * CYCLES, 1e-4, 0.2
    quarter = 0.5 * math.pi
    shaken = base.scene(
        material, (Oscillate(size, 1.0, duration + quarter),), "relaxed", base.TOP, None, FlatPunch(radius)
    )
    swing = float(punch_oscillation.force(material, radius, 1.0, size, duration + quarter))
    force = 2.0 * radius * material.relaxed_plane_modulus * base.TOP + swing
    loss = CYCLES * punch_oscillation.loss_per_cycle(material, radius, 1.0, size)
    expected = ClosedForm(
        (Value("final_force", force), Value("dissipated_energy", loss)), "punch under the complex modulus"
    )
    adhering = base.scene(material, (Oscillate(size, 1.0, duration), Hold(1e4)), "relaxed", 0.0)
    final = ReferenceRuns(("final_force", "final_radius", "loop_energy"), fine=8, coarse=4)
    coarse = Tolerance(
        {BoundaryElements.name: 0.1},
        "energies of a swing of a hundredth of the load, to whose size steps are controlled: ten a cycle",
    )
    many: dict[str, Any] = {"max_steps": 200_000, "seconds": 600.0}
    return [
        StabilityCase("loading", f"{CYCLES} cycles of a punch", shaken, expected, coarse, **many),
        StabilityCase(
            "loading",
            f"{CYCLES} cycles of a sphere, then rest",
            adhering,
            final,
            coarse,
            resolutions=dict.fromkeys(SOLVERS, 4),
            **many,
        ),
    ]


def _starts() -> list[StabilityCase]:
    """Starts around the limit of stability."""
    material = base.material()
    cases = []
    for start, modulus in (
        ("relaxed", material.relaxed_plane_modulus),
        ("jump-in", material.glassy_plane_modulus),
    ):
        law = closed_forms.zone_law(base.scene(material, ()), modulus)
        limit = law.pull_off_penetration_control().penetration
        for factor in (0.99, 1.01, 100.0):
            depth = factor * limit
            started = base.scene(material, (Hold(0.0),), start, depth)
            label = f"{start} start at {factor:g} of the last stable penetration"
            expected = NoSolution("no contact is stable there")
            if factor < 1.0:
                state = law.at_penetration(depth)
                values = (Value("start_force", state.force), Value("start_radius", state.contact_radius))
                equilibrium = ClosedForm(values, "elastic closure of finite zone")
                near = Tolerance({}, "next to the limit the radius moves like a square root", other=5e-2)
                cases.append(StabilityCase("loading", label, started, equilibrium, near))
            else:
                cases.append(StabilityCase("loading", label, started, expected))
    return cases


def pull_off() -> list[StabilityCase]:
    """Dead loads around the slow pull-off force: held for ever below, lost after a delay above.

    The delay grows without bound towards the limit, like the root of the margin: the error of the limit
    itself, divided by twice the margin, is the error of the delay.
    """
    material = base.material()
    law = closed_forms.zone_law(base.scene(material, ()), material.relaxed_plane_modulus)
    limit = law.pull_off_force_control()
    cases = []
    for margin in MARGINS:
        tolerance = Tolerance(
            {REFERENCE: 1e-2 + 0.1 * FORCE_ERROR / (2.0 * margin)},
            "1 % and the error of the slow pull-off force over twice the margin",
            other=1e-2 + FORCE_ERROR / (2.0 * margin),
        )
        above = _dead_load(-limit.force * (1.0 + margin), 1e6)
        cases.append(
            StabilityCase("dead load", f"{1.0 + margin:g} of slow pull-off", above, DELAY, tolerance)
        )
        below = -limit.force * (1.0 - margin)
        radius = brentq(
            lambda a, load=below: law.state(a).force + load, limit.contact_radius, 2.0 * limit.contact_radius
        )
        state = law.state(float(radius))
        values = (
            Value("final_force", state.force),
            Value("final_radius", state.contact_radius),
            Value("final_penetration", state.penetration, -state.penetration),
        )
        held = ClosedForm(values, "elastic closure of finite zone, E0")
        cases.append(
            StabilityCase(
                "dead load", f"{1.0 - margin:g} of slow pull-off", _dead_load(below, 1e6), held, tolerance
            )
        )
    at_once = ClosedForm(
        (Value("detachment_time", 0.0, 1.0),), "beyond the glassy limit", (OutcomeKind.DETACHED,)
    )
    cases.append(
        StabilityCase("dead load", "30 times slow pull-off", _dead_load(-30.0 * limit.force, 1e6), at_once)
    )
    return cases


def _dead_load(tension: float, duration: float) -> Scene:
    return base.scene(base.material(), (Force(-tension, duration),), "relaxed", base.TOP)
