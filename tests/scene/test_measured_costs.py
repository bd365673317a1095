"""Forecasts beside runs that were measured once, most of them too long for a test: what a user waits for.

Steps and processor time (s) on the machine of 2026, two cores shared with others.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from contact_scene import (
    Adhesion,
    Branch,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    Oscillate,
    Ramp,
    Scene,
    Sphere,
    read_scene,
)
from crosscontact.commands.forecast import LONG
from validation.scenes import FOLDER
from validation.solvers import SOLVERS

RUBBER = Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0)))
PULL = Scene(RUBBER, Sphere(1e-3), Loading("relaxed", 2e-6, (Ramp(-5e-5, 1e-5),)), Adhesion(0.05, 1e-6))
CYCLE = replace(PULL, loading=Loading("jump-in", 0.0, (Ramp(8e-6, 1e-5), Ramp(-5e-5, 1e-5))))


def branches(number: int, modulus: float, decades: float) -> Material:
    """A spectrum over some decades from 0.1 ms on."""
    series = tuple(Branch(modulus, 10.0 ** (-4.0 + decades * n / number)) for n in range(number))
    return Material(1e6, 0.49, series)


def shaken(cycles: float, amplitude: float) -> Scene:
    """The contact at rest, ten oscillations a second."""
    return replace(PULL, loading=Loading("relaxed", 2e-6, (Oscillate(amplitude, 62.83, 0.1 * cycles),)))


UNIT = Scene(
    Material(0.75, 0.4, (Branch(6.75, 1.0),)),
    Sphere(1.0),
    Loading("jump-in", 0.0, (Ramp(0.032, 0.02), Ramp(-0.5, 0.02))),
    Adhesion(5e-4, 0.013),
)
SCENES = {
    "pull": PULL,
    "cycle": CYCLE,
    "tension": replace(PULL, loading=Loading("relaxed", 2e-6, (ForceRamp(-1e-2, 1e-4),))),
    "ten cycles": shaken(10, 1e-6),
    "a hundred cycles": shaken(100, 5e-7),
    "a thousand small cycles": shaken(1000, 1e-7),
    "cycles with hysteresis": replace(shaken(30, 1e-6), adhesion=Adhesion(0.05, 1e-6, work_closing=0.02)),
    "elastic cycles": replace(shaken(100, 1e-6), material=Material(1e6, 0.49)),
    "drifting off": replace(
        PULL, loading=Loading("relaxed", 2e-6, (Oscillate(2e-7, 62.83, 10.0, drift=1e-6),))
    ),
    "shaken off": replace(shaken(50, 1e-6), adhesion=None),
    "negligible branch": replace(PULL, material=Material(1e6, 0.49, (Branch(1e-60, 1.0),))),
    "20 branches": replace(CYCLE, material=branches(20, 2e5, 6.0)),
    "200 branches": replace(CYCLE, material=branches(200, 2e4, 6.0)),
    "200 branches, no adhesion": replace(
        CYCLE,
        material=branches(200, 2e4, 6.0),
        adhesion=None,
        loading=Loading("relaxed", 2e-6, (Ramp(8e-6, 1e-5), Ramp(0.0, 1e-5))),
    ),
    "400 load steps": replace(
        PULL,
        loading=Loading("relaxed", 2e-6, tuple(Ramp(2e-6 + 1e-8 * (n % 7), 1e-6) for n in range(1, 400))),
    ),
    "hold": replace(PULL, loading=Loading("jump-in", 2e-6, (Hold(100.0),))),
    "weak spring": replace(
        PULL, loading=Loading("jump-in", 0.0, (Ramp(5e-5, 1e-5),), Machine(1e-20)), adhesion=PULL.adhesion
    ),
    "pdms-cycle-10nm": read_scene(FOLDER / "pdms-cycle-10nm.toml"),
    "elastic bulk": replace(UNIT, material=replace(UNIT.material, bulk="elastic")),
}
MEASURED = [
    ("pull", "fem", 98, 2.8),
    ("pull", "bem", 202, 1.3),
    ("pull", "reference", 370, 0.7),
    ("cycle", "fem", 211, 4.2),
    ("cycle", "bem", 421, 3.3),
    ("tension", "bem", 158, 1.4),
    ("ten cycles", "fem", 1170, 7.1),
    ("ten cycles", "bem", 756, 7.8),
    ("a hundred cycles", "fem", 9836, 49.0),
    ("a hundred cycles", "bem", 6917, 59.0),
    ("a hundred cycles", "reference", 15439, 54.0),
    ("a thousand small cycles", "fem", 48000, 219.0),
    ("cycles with hysteresis", "fem", 3618, 17.0),
    ("cycles with hysteresis", "bem", 2155, 19.0),
    ("elastic cycles", "bem", 6432, 4.7),
    ("elastic cycles", "reference", 9803, 15.0),
    ("drifting off", "fem", 2850, 17.0),
    ("drifting off", "bem", 2056, 16.0),
    ("drifting off", "reference", 4447, 14.0),
    ("shaken off", "fem", 253, 0.9),
    ("shaken off", "bem", 351, 1.0),
    ("shaken off", "reference", 572, 0.6),
    ("negligible branch", "fem", 411, 5.8),
    ("20 branches", "fem", 245, 5.3),
    ("20 branches", "bem", 516, 22.0),
    ("200 branches", "fem", 243, 11.0),
    ("200 branches", "bem", 530, 179.0),
    ("200 branches", "reference", 1098, 17.0),
    ("200 branches, no adhesion", "fem", 306, 0.8),
    ("200 branches, no adhesion", "bem", 366, 9.9),
    ("400 load steps", "fem", 3192, 15.0),
    ("400 load steps", "bem", 2916, 29.0),
    ("400 load steps", "reference", 6561, 31.0),
    ("hold", "fem", 115, 1.5),
    ("weak spring", "bem", 136, 2.1),
    ("pdms-cycle-10nm", "fem", 230, 11.0),
    ("elastic bulk", "fem", 1341, 27.0),
]


@pytest.mark.parametrize(("label", "solver", "steps", "seconds"), MEASURED)
def test_what_is_announced_is_what_it_takes(label, solver, steps, seconds):
    """Within a factor of three where it is long, and silence where it is short."""
    forecast = SOLVERS[solver].expected_cost(SCENES[label])
    assert steps / 5.0 <= forecast.steps <= 5.0 * steps
    if seconds > LONG:
        assert seconds / 3.0 <= forecast.seconds <= 3.0 * seconds
    if seconds < 3.0:
        assert forecast.seconds < LONG


def test_memory_follows_the_resolution_of_a_mesh_that_follows_the_edge():
    """Measured: 85, 167, 346, 742 MB at 4, 10, 20 and 40 elements in a process zone."""
    for divisions, megabytes in ((4, 85.0), (10, 167.0), (20, 346.0), (40, 742.0)):
        found = 1e-6 * SOLVERS["fem"].expected_cost(PULL, divisions).bytes
        assert megabytes / 1.5 <= found <= 1.5 * megabytes, divisions
