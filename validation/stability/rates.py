"""Axes of time: speeds, and steps forced far below and above every relaxation time."""

from __future__ import annotations

import numpy as np

from contact_scene import Hold, Table
from validation.stability import base, closed_forms
from validation.stability.case import Expectation, StabilityCase
from validation.stability.materials import CYCLE

SPEEDS = (1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)
"""``V tau/R``."""
SLOW, FAST = 1e-8, 1e4
"""``V tau/R`` below and above which the cycle is elastic to a thousandth, relaxed and glassy."""
ROWS = 21
"""Rows of a table from zero to the largest penetration."""


def speeds() -> list[StabilityCase]:
    """``V tau/R``, approach and retraction."""
    material = base.material()
    cases = []
    for speed in SPEEDS:
        cycle = base.scene(material, base.press_and_pull(speed))
        expected: Expectation
        if speed <= SLOW:
            expected = closed_forms.elastic_cycle(cycle, material.relaxed_plane_modulus, "E0", at_once=False)
        elif speed >= FAST:
            expected = closed_forms.elastic_cycle(cycle, material.glassy_plane_modulus, "Einf")
        else:
            expected = CYCLE
        series = "slow cycle" if speed < 1e-5 else "fast cycle" if speed >= 1.0 else ""
        cases.append(
            StabilityCase(
                "speed",
                f"V tau/R = {speed:g}",
                cycle,
                expected,
                series=series,
                stiffness=max(speed, 1.0 / speed),
            )
        )
    return cases


def steps() -> list[StabilityCase]:
    """Tables whose rows force the step: rows of ``1e-9`` and ``1e9`` relaxation times, also
    tiny ones after long ones."""
    material = base.material()
    soft, hard = material.relaxed_plane_modulus, material.glassy_plane_modulus
    up = np.linspace(0.0, base.TOP, ROWS)
    down = np.linspace(base.TOP, -0.05, 2 * ROWS)
    there = np.concatenate((up, down[1:]))

    def table(step: float, values: np.ndarray) -> Table:
        return Table(tuple(step * np.arange(values.size)), tuple(values))

    small = base.scene(material, (table(1e-9, there),))
    large = base.scene(material, (table(1e9, there),))
    settled = base.scene(material, (table(1e-9, up), Hold(1e4)))
    stairs = np.repeat(up, 2)[1:]
    pace = np.tile((1e-9, 1e4), stairs.size)[: stairs.size]
    pace[0] = 0.0
    climb = base.scene(material, (Table(tuple(np.cumsum(pace)), tuple(stairs)), Hold(1e4)))
    return [
        StabilityCase("step", "dt/tau = 1e-9", small, closed_forms.elastic_cycle(small, hard, "Einf")),
        StabilityCase(
            "step", "dt/tau = 1e9", large, closed_forms.elastic_cycle(large, soft, "E0", at_once=False)
        ),
        StabilityCase(
            "step",
            "dt/tau = 1e-9, then a hold of 1e4",
            settled,
            closed_forms.rest(settled, base.TOP, soft, "E0"),
        ),
        StabilityCase(
            "step", "dt/tau = 1e-9 and 1e4 by turns", climb, closed_forms.rest(climb, base.TOP, soft, "E0")
        ),
    ]
