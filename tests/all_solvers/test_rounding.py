"""What rounding does to an answer: numbers of the scene changed in the last digit. Kernels: ``.ci/run``.

Force and radius of two such runs, relative to what they do in the run, differ by less than 1e-9, or, where a
decision of the solver falls differently, by less than a tenth of what a run half as fine says of the error.
"""

from __future__ import annotations

import dataclasses
from itertools import product

import numpy as np
import pytest
from support.paper_scenes import THREE, cycle, scene

from contact_scene import (
    Adhesion,
    Branch,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    Scene,
    Sphere,
    Trace,
)
from validation.measure.error_estimate import SAFETY
from validation.solvers import solver

ROUNDING = 1e-15
"""Relative change of every number of a scene: a few units in the last place."""
ALIKE = 1e-9
"""Difference relative to the excursion that rounding may cause where no decision falls differently."""
SHARE = 0.1
"""Share of the error estimate that rounding may cause where one does."""
COLUMNS = ("force", "contact_radius")
RESOLUTION = 8  # of the run half as fine: 4, the coarsest
SMALL = Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0)))
SCENES = {
    "cycle": cycle(0.02),
    "hold": scene(Hold(1.0), Ramp(0.02, 0.01), at=0.01, adhesion=None, material=THREE),
    "oscillation": Scene(
        SMALL, Sphere(1e-3), Loading("relaxed", 2e-6, (Oscillate(1e-6, 62.8, 0.06),)), Adhesion(0.05, 1e-6)
    ),
    "steps": scene(Ramp(0.01, 0.1), Hold(0.1), Force(-5e-4, 0.05), Ramp(-0.5, 0.3), material=THREE),
}
LONGEST = ("fem", "hold")
"""Takes ten times as long as any other, and is left out."""
PAIRS = [pair for pair in product(("reference", "bem", "fem"), SCENES) if pair != LONGEST]
DEFAULT = [("reference", "hold")]
RARELY = [("reference", "cycle"), ("bem", "cycle"), ("bem", "steps"), ("fem", "cycle"), ("fem", "steps")]
"""Of long cycles; reports with cycles are compared between two kernels."""


def marks(pair):
    if pair in DEFAULT:
        return ()
    return pytest.mark.exhaustive if pair in RARELY else pytest.mark.slow


def perturbed(value, generator: np.random.Generator):
    """A scene with every number changed by rounding."""
    if isinstance(value, float) and value != 0.0:
        changed = value * (1.0 + ROUNDING * generator.choice((-1.0, 1.0)))
        return min(changed, value) if value == 0.5 else changed  # the largest Poisson's ratio
    if isinstance(value, tuple):
        return tuple(perturbed(item, generator) for item in value)
    if dataclasses.is_dataclass(value):
        kept = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
        return type(value)(**{name: perturbed(item, generator) for name, item in kept.items()})
    return value


def apart(one: Trace, other: Trace, column: str) -> float:
    """Root mean square of the difference over the common time, relative to the second run's excursion."""
    times = np.linspace(0.0, min(one.time[-1], other.time[-1]), 2001)[:-1]
    first, second = (np.interp(times, run.time, getattr(run, column)) for run in (one, other))
    return float(np.sqrt(np.mean((first - second) ** 2)) / np.ptp(second))


@pytest.mark.parametrize(("name", "case"), [pytest.param(*pair, marks=marks(pair)) for pair in PAIRS])
def test_last_digits_of_a_scene(name, case):
    method, moved = solver(name), perturbed(SCENES[case], np.random.default_rng(1))
    whole, changed = (method.solve(asked, RESOLUTION) for asked in (SCENES[case], moved))
    for column in COLUMNS:
        difference = apart(changed, whole, column)
        if difference > ALIKE:
            coarse = apart(method.solve(SCENES[case], RESOLUTION // 2), whole, column)
            estimate = SAFETY * coarse / (2.0**method.order - 1.0)
            assert difference < SHARE * estimate, (column, difference, estimate)
