"""Every solver on the built-in scenes of layers, and on a thick layer against itself.

Values are those of a prototype of the front tracking, to the digits shown: 2e-5 of the pull-off force,
1e-3 of its place, 7e-6 of the detachment, 2e-5 of the loop energy.
"""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from functools import cache

import numpy as np
import pytest
from support.closed_forms.layer import growing_force

from contact_scene import (
    Branch,
    FlatPunch,
    Hold,
    Layer,
    Loading,
    Material,
    OutcomeKind,
    Ramp,
    Scene,
    SceneError,
    Sphere,
)
from validation.cases import load
from validation.measure.observables import observe
from validation.reference import prony_integrals
from validation.reference.elastic_layer import ElasticLayer
from validation.solvers import SOLVERS

ZONE = 0.013


def table(text: str) -> dict[str, str]:
    """Rows by their first word."""
    rows = (line.partition(" ") for line in text.strip().splitlines())
    return {name: rest.strip() for name, _, rest in rows}


# start radius and force; largest force and radius; pull-off force, its penetration and radius;
# penetration at detachment; loop energy
VALUES = table("""
cycle 0.0631176 -0.00248943 0.0886228 0.203852 0.00756025 0.008467 0.1065 0.0063522 0.00031873
retraction 0.23119 0.00392846 0.00392846 0.23119 0.0244678 0.01642 0.21229 0.0137656 0.000089168
frictionless 0.0672616 -0.00246853 0.0626462 0.194938 0.00526642 0.0050219 0.094679 0.0020563 0.00021255
thin-retraction 0.181531 0.00585604 0.00585604 0.181531 0.0306767 0.0088184 0.16853 0.00693964 0.000046621
repressed 0.181789 0.00164011 0.0438266 0.185081 0.0249172 0.008165 0.16879 0.00575775 0.00008628
dwell 0.0619302 -0.00257341 0.0671225 0.184389 0.0159557 0.00855 0.15919 -0.00620513 0.00054413
""")
KNOWN = (0, 0, 0, 0, 2e-5, 1e-3, 1e-3, 7e-6, 2e-5)
"""How well they are known beside their rounding."""
# penetration, force, contact radius
RETRACTION = table("""
cycle 0.0173 0.0488072 0.190428, 0.0132 0.00845983 0.163165, 0.00908 -0.00729444 0.116607
retraction 0.0188 -0.00697091 0.223814, 0.0169 -0.0225737 0.218659, 0.015 -0.0180282 0.158219
frictionless 0.0164 0.0296564 0.179888, 0.011 0.00309967 0.148319, 0.00565 -0.00517851 0.101773
thin-retraction 0.00939 -0.0136966 0.172408, 0.00847 -0.0264016 0.147982, 0.00755 -0.0111779 0.0868123
repressed 0.0108 0.0166642 0.182801, 0.00888 -0.0150913 0.171028, 0.00701 -0.0165293 0.121503
dwell 0.0108 -0.0146992 0.170059, 0.0044 -0.0139621 0.134775, -0.00196 -0.00814318 0.0889398
""")
SCENES = {name: load(f"layer-{name}").scene for name in VALUES}
TOLERANCE = {"reference": 1e-5, "bem": 1e-4, "fem": 5e-4}
RESOLUTION = {"reference": 32, "bem": 24, "fem": 24}
CORNER = {"reference": 1e-4}
"""Of the pull-off force of a thin layer, where the curve has a corner."""


def numbers(text: str) -> np.ndarray:
    return np.array(text.split(), float)


def rounding(text: str) -> np.ndarray:
    """Half a unit in the last digit."""
    return np.array([0.5 * 10.0 ** Decimal(one).as_tuple().exponent for one in text.split()])


def samples(name: str) -> list[np.ndarray]:
    return [numbers(row) for row in RETRACTION[name].split(",")]


def time_on_retraction(asked: Scene, depth: float) -> float:
    *_, (_, last) = asked.loading.segments()
    first, rate = last.value(last.start), asked.loading.steps[-1].rate
    return last.start + (first - depth) / rate


@cache
def answer(name: str, solver: str):
    stops = tuple(time_on_retraction(SCENES[name], depth) for depth, *_ in samples(name))
    return SOLVERS[solver].solve(SCENES[name], RESOLUTION[solver], stop_times=stops)


DEFAULT = ("frictionless", "dwell")


def marks(name: str, solver: str):
    """The quick report compares the other solvers with the reference on these scenes."""
    if solver != "reference":
        return pytest.mark.exhaustive
    return () if name in DEFAULT else pytest.mark.slow


both = pytest.mark.parametrize(
    ("name", "solver"),
    [pytest.param(name, solver, marks=marks(name, solver)) for name in SCENES for solver in TOLERANCE],
)


@both
def test_values_of_the_six_scenes(name, solver):
    trace = answer(name, solver)
    seen = observe(trace, ZONE, SCENES[name].loading)
    found = (
        *(seen.start_radius, seen.start_force, trace.force.max(), trace.contact_radius.max()),
        *(abs(seen.pull_off_force), seen.pull_off_penetration, seen.pull_off_radius),
        *(seen.detachment_penetration, seen.loop_energy),
    )
    values = numbers(VALUES[name])
    tolerance = TOLERANCE[solver] + np.array(KNOWN) + rounding(VALUES[name]) / np.abs(values)
    places = [
        SOLVERS[solver].quantity_tolerances.get(f"pull_off_{of}", 0.0) for of in ("penetration", "radius")
    ]
    tolerance[5:7] += places
    if name == "thin-retraction":
        tolerance[4] = max(tolerance[4], CORNER.get(solver, 0.0))
    error = np.array(found) / values - 1.0
    assert np.all(np.abs(error) <= tolerance), error


@both
def test_the_retractions_of_the_six_scenes(name, solver):
    """Forces relative to that of pull-off, as they change their sign."""
    trace = answer(name, solver)
    pull_off = numbers(VALUES[name])[4]
    for depth, force, radius in samples(name):
        rows = np.flatnonzero(np.isclose(trace.time, time_on_retraction(SCENES[name], depth), rtol=1e-12))
        assert rows.size
        assert trace.penetration[rows[0]] == pytest.approx(depth, rel=1e-9)
        error = (trace.force[rows[0]] - force) / pull_off, trace.contact_radius[rows[0]] / radius - 1.0
        assert np.all(np.abs(error) <= TOLERANCE[solver] + 1e-5), (depth, error)


@pytest.mark.parametrize(
    ("solver", "limit", "base"),
    [
        ("reference", 1e-8, "bonded"),
        ("reference", 1e-8, "frictionless"),
        pytest.param("bem", 1e-6, "bonded", marks=pytest.mark.slow),
        pytest.param("fem", 1e-4, "frictionless", marks=pytest.mark.slow),
    ],
)
def test_a_thick_layer_is_a_half_space(solver, limit, base):
    """To first order its base adds ``(2 m0/pi) sqrt(R D)/h`` to the force: 1.6e-9 of it."""
    asked = replace(SCENES["retraction"], body=Layer(1e8, base))
    thick, half_space = (
        SOLVERS[solver].solve(one, RESOLUTION[solver] // 2) for one in (asked, replace(asked, body=None))
    )
    for column, key in (("force", 0), ("force", -2), ("contact_radius", 0)):
        assert getattr(thick, column)[key] == pytest.approx(getattr(half_space, column)[key], rel=limit)
    assert thick.force.min() == pytest.approx(half_space.force.min(), rel=limit)
    assert thick.penetration[-1] == pytest.approx(half_space.penetration[-1], rel=limit)
    assert thick.external_work[-1] == pytest.approx(half_space.external_work[-1], rel=limit)


@pytest.mark.parametrize(
    "solver", ["reference", *(pytest.param(name, marks=pytest.mark.slow) for name in ("bem", "fem"))]
)
def test_a_contact_too_wide_for_its_layer(monkeypatch, solver):
    """It ends the run where it becomes that, here at three thicknesses, or is refused at the start."""
    monkeypatch.setattr(Layer, "largest_contact", property(lambda layer: 3.0 * layer.thickness))
    wide = replace(SCENES["cycle"], adhesion=None, body=Layer(0.05, "frictionless"))
    ramp, start = Loading("relaxed", 0.01, (Ramp(0.03, 0.05),)), Loading("relaxed", 0.03, (Ramp(0.0, 0.05),))
    trace = SOLVERS[solver].solve(replace(wide, loading=ramp), 4)
    ratio = trace.contact_radius / wide.body.thickness
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert "thicknesses" in trace.outcome.reason
    assert ratio[0] < 3.0 < ratio[-1] < 3.2
    with pytest.raises(SceneError, match=r"^body\.thickness: .* thicknesses"):
        SOLVERS[solver].solve(replace(wide, loading=start), 4)


TWO = Material(0.75, 0.3, (Branch(3.0, 0.3), Branch(4.0, 3.0)))
GROWN = [("reference", 1e-7), pytest.param("bem", 1e-4, marks=pytest.mark.slow)]


def pressed(indenter, *steps, at=0.0, base="bonded"):
    """Without adhesion, on a layer of a tenth of the radius."""
    return Scene(TWO, indenter, Loading("jump-in", at, steps), body=Layer(0.1, base))


@pytest.mark.parametrize(("solver", "accuracy"), GROWN)
def test_growing_contact_without_adhesion(solver, accuracy):
    """Lee and Radok on a layer, too; the radius is the elastic one."""
    asked = pressed(Sphere(1.0), Ramp(0.02, 0.02))
    trace, layer = SOLVERS[solver].solve(asked), ElasticLayer(asked.body, 0.3, asked.indenter)
    assert trace.contact_radius[-1] == pytest.approx(layer.radius_at(0.02), rel=accuracy)
    assert trace.force[-1] == pytest.approx(growing_force(TWO, layer, 0.02, 1.0), rel=accuracy)


@pytest.mark.parametrize(("solver", "accuracy"), [("reference", 2e-7), ("bem", 1e-5)])
def test_a_contact_that_stays_relaxes_as_its_material(solver, accuracy):
    for indenter in (Sphere(1.0), FlatPunch(0.2)) if solver == "reference" else (FlatPunch(0.2),):
        trace = SOLVERS[solver].solve(pressed(indenter, Hold(4.0), at=0.02, base="frictionless"))
        relaxed = prony_integrals.relaxation(TWO, trace.time)
        assert np.ptp(trace.contact_radius) == 0.0
        assert trace.force / trace.force[0] == pytest.approx(relaxed / relaxed[0], rel=accuracy)
