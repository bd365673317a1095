"""What is refused or warned of before anything is solved, at both sides of every limit."""

from __future__ import annotations

import dataclasses
import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.scene_strategies import scenes
from support.synthetic_traces import by_hand

import contact_scene as cs
from validation.reference.jkr import JKR
from validation.solvers import SOLVERS, out_of_range, scene_warnings, trace_warnings
from validation.solvers.base import step_budget
from validation.solvers.contact_range import contact_bounds, largest_contact_radius, start_radius

MATERIAL = cs.Material(0.75, 0.5, (cs.Branch(6.75, 1.0),))
PULL = cs.Ramp(-0.1, 0.01)


def scene(
    *steps, material=MATERIAL, indenter=None, work=1e-3, zone=0.01, start="relaxed", depth=0.02
) -> cs.Scene:
    loading = cs.Loading(start, depth, steps or (PULL,))
    return cs.Scene(material, indenter or cs.Sphere(1.0), loading, cs.Adhesion(work, zone) if work else None)


def rows(count: int) -> cs.Table:
    return cs.Table(tuple(range(count)), (0.0,) * count)


TABLE = cs.TabulatedProfile((0.0, 0.1, 0.2, 0.4), (0.0, 0.005, 0.02, 0.08))
JUST_IN = {
    "a million cycles": scene(cs.Oscillate(1e-3, 2.0 * math.pi, 1e6 - 1.0), work=0),
    "ten thousand branches": scene(material=cs.Material(1.0, 0.5, (cs.Branch(1.0, 1.0),) * 10_000)),
    "a short step after a long one": scene(cs.Hold(1e11), cs.Hold(1.0)),
    "a contact of 999 indenters": scene(indenter=cs.Sphere(1e-3), depth=900.0, work=0),
    "never in contact": scene(cs.Ramp(-1.0, 1.0), work=0, depth=-0.5),
    "no units like these": scene(
        material=cs.Material(1e50, 0.5), indenter=cs.Sphere(1e-20), depth=1e-22, work=0
    ),
}
REFUSED = {
    "cycles": (scene(cs.Oscillate(1e-3, 1.0, 1e12), work=0), "loading.steps", "1e+06"),
    "rows": (scene(*(2 * [rows(60_000)]), work=0), "loading.steps", "100000"),
    "contrast": (
        scene(material=cs.Material(1e-13, 0.5, (cs.Branch(1.0, 1.0),))), "material.branches", "1e+12",
    ),
    "branches": (
        scene(material=cs.Material(1.0, 0.4, (cs.Branch(1.0, 1.0),) * 10_001)), "material.branches", "10000",
    ),
    "a step lost after a long one": (scene(cs.Hold(1e17), cs.Hold(1.0)), "loading.steps[1]", "1e-12"),
    "pressed beyond the indenter": (scene(depth=1e9), "loading", "1000 times"),
    "beyond the table": (scene(indenter=TABLE, depth=1e9), "loading", "1000 times"),
    "zone of 1e9": (scene(zone=1e9), "adhesion.zone", "shorter"),
    "zone of nothing": (scene(zone=1e-12), "adhesion.zone", "1e+09"),
    "thin layer": (dataclasses.replace(scene(work=0), body=cs.Layer(5e-3, "bonded")), "body.thickness", "30"),
    "energies": (
        scene(material=cs.Material(1e60, 0.5), indenter=cs.Sphere(1e30), depth=1e20),
        "adhesion.zone",
        "1e+09",
    ),
    "energies without adhesion": (
        scene(material=cs.Material(1e60, 0.5), indenter=cs.Sphere(1e30), depth=1e20, work=0),
        "material.modulus",
        "units",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", JUST_IN)
def test_what_can_be_computed_is_not_refused(name):
    assert out_of_range(JUST_IN[name]) is None


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_solver_can_compute_is_refused_in_one_line(name):
    asked, key, allowed = REFUSED[name]
    error = out_of_range(asked)
    assert error.key == key
    assert allowed in error.allowed
    for solver in SOLVERS.values():
        with pytest.raises(cs.SceneError, match=key.replace("[", r"\[").replace("]", r"\]")):
            solver.solve(asked)


def trace(start: float, largest: float) -> cs.Trace:
    return by_hand(np.arange(3.0), contact_radius=[start, largest, start])


@pytest.mark.parametrize(("zone", "warned"), [(0.19, False), (0.21, True)])
def test_a_zone_that_is_no_small_part_of_the_contact_is_warned_of(zone, warned):
    """JKR: the start radius of an elastic contact at the penetration of the relaxed one of radius 0.2."""
    elastic = JKR(cs.Sphere(1.0), MATERIAL.relaxed_plane_modulus, 1e-3)
    asked = scene(zone=zone * 0.2, depth=float(elastic.penetration(0.2)))
    assert start_radius(asked) == pytest.approx(0.2, rel=1e-9)
    assert any("process zone" in text for text in scene_warnings(asked)) is warned
    assert any("process zone" in text for text in trace_warnings(asked, trace(0.2, 0.2))) is warned
    assert not any("zone" in text for text in scene_warnings(dataclasses.replace(asked, adhesion=None)))


def test_the_start_radius_is_that_of_the_modulus_it_starts_with():
    for start, modulus in (("relaxed", 1.0), ("jump-in", 10.0)):
        elastic = JKR(cs.Sphere(1.0), modulus, 1e-3)
        assert elastic.penetration(start_radius(scene(start=start))) == pytest.approx(0.02)
    assert start_radius(scene(depth=-1.0)) == 0.0
    assert start_radius(scene(indenter=cs.FlatPunch(0.3))) == 0.3


def test_a_contact_that_outgrows_the_half_space_is_warned_of():
    """Hertz, D = a^2/R: at half the radius of the sphere."""
    for depth, warned in ((0.24, False), (0.26, True)):
        assert bool(scene_warnings(scene(cs.Hold(1.0), work=0, depth=depth))) is warned
    for radius, warned in ((0.49, False), (0.51, True)):
        found = trace_warnings(scene(work=0), trace(0.1, radius))
        assert bool(found) is warned
        assert not warned or "t = 1" in found[0]
    assert scene_warnings(scene(indenter=cs.Cone(70.0), work=0)) == ()
    assert "slope" in scene_warnings(scene(indenter=cs.Cone(30.0), work=0))[0]
    assert "last row" in trace_warnings(scene(indenter=TABLE, work=0), trace(0.1, 0.41))[0]
    assert trace_warnings(scene(indenter=TABLE, work=0), trace(0.1, 0.39)) == ()
    assert trace_warnings(scene(indenter=cs.FlatPunch(1.0), work=0), trace(1.0, 1.0)) == ()


def layer(thickness, base="bonded", poisson=0.3, **keys):
    asked = scene(material=cs.Material(0.75, poisson), depth=1e-3, **{"work": 1e-7, "zone": 1e-3} | keys)
    return dataclasses.replace(asked, body=cs.Layer(thickness, base))


@pytest.mark.parametrize(
    ("below", "above", "words"),
    [
        (layer(4e-3, work=0), layer(2.8e-3, work=0), "penetration reaches 0.36"),
        (layer(5.2e-3), layer(4.8e-3), "zone is 0.21 of the thickness"),
        (layer(5e-3, "frictionless", work=0), layer(4e-3, "frictionless", work=0), "times the thickness"),
        (layer(0.03, poisson=0.48, work=0), layer(0.014, poisson=0.48, work=0), "third digit"),
        (layer(0.014, poisson=0.5, work=0), layer(0.014, poisson=0.48, work=0), "third digit"),
        (layer(0.014, "frictionless", 0.48, work=0), layer(0.014, poisson=0.48, work=0), "third digit"),
    ],
)
def test_what_makes_the_answer_of_a_layer_doubtful(below, above, words):
    assert not any(words in text for text in scene_warnings(below))
    assert any(words in text for text in scene_warnings(above))
    radius = largest_contact_radius(above)
    run = dataclasses.replace(trace(radius, radius), penetration=np.full(3, 1e-3))
    assert any(words in text for text in trace_warnings(above, run))
    assert not any(words in text for text in trace_warnings(dataclasses.replace(above, body=None), run))


@pytest.mark.parametrize("force", [-0.5, 0.5])
def test_a_test_that_ends_under_the_largest_tension_is_warned_of(force):
    asked = scene(cs.Ramp(0.1, 1.0, until_force=0.5), cs.Ramp(-0.1, 1.0))
    ended = dataclasses.replace(trace(0.1, 0.1), force=np.array([0.0, 1.0, force]))
    found = trace_warnings(asked, ended)
    assert any("`away` of an approach" in text for text in found) == (force < 0.0)
    assert trace_warnings(scene(PULL), ended) == trace_warnings(scene(PULL), trace(0.1, 0.1))


def can_be_told(asked: cs.Scene) -> bool:
    """Whether all that is told without solving is told, the step budget too; no warning is allowed."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        out_of_range(asked)
        scene_warnings(asked)
        return step_budget(asked) > 0


@pytest.mark.parametrize(
    ("depth", "rate", "warned"),
    [(0.0, 10.0, False), (0.1, 10.0, True), (0.1, 1e-4, False), (-0.01, 10.0, False)],
)
def test_a_punch_that_was_pressed_in_and_is_torn_off_is_warned_of(depth, rate, warned):
    asked = scene(cs.Ramp(-1.0, rate), indenter=cs.FlatPunch(1.0), depth=depth)
    trace = SOLVERS["reference"].solve(asked)
    assert any("fresh crack" in line for line in trace_warnings(asked, trace)) == warned
    none = dataclasses.replace(asked, adhesion=cs.Adhesion(0.0, 0.01))
    assert not any("fresh crack" in line for line in trace_warnings(none, trace))


@settings(max_examples=20)
@given(scenes.filter(lambda asked: not isinstance(asked.indenter, cs.TabulatedProfile)))
def test_telling_never_fails_and_never_warns(asked):
    assert can_be_told(asked)
    bounds = contact_bounds(asked)
    assert bounds is None or bounds[0] <= largest_contact_radius(asked) <= bounds[1]


def test_the_largest_radius_of_what_is_pressed_in_needs_no_search(monkeypatch):
    least, most = contact_bounds(scene())
    assert least < largest_contact_radius(scene()) < most < 3.0 * least
    monkeypatch.delattr("validation.solvers.model_range.largest_contact_radius")
    assert out_of_range(scene()) is None


ends = st.sampled_from([1e-60, 1e-31, 1e-12, 1e-3, 1.0, 1e3, 1e9, 1e31, 1e60])
signed = st.builds(lambda size, sign: sign * size, ends, st.sampled_from([-1.0, 0.0, 1.0]))
branches = st.builds(cs.Branch, ends.filter(lambda modulus: modulus < 1e60), ends)  # a sum is 1e60 at most
materials = st.builds(cs.Material, ends, st.just(0.3), st.lists(branches, max_size=1).map(tuple))
exponents = st.sampled_from([1.0, 2.5, 100.0])
shapes = st.one_of(
    st.builds(cs.Sphere, ends),
    st.builds(cs.FlatPunch, ends),
    st.builds(cs.Cone, st.sampled_from([1e-6, 45.0, 89.99999])),
    st.builds(cs.PowerLaw, exponents, ends | st.sampled_from([1e-300, 1e300])),
)
steps = st.one_of(
    st.builds(cs.Ramp, signed, ends),
    st.builds(cs.Hold, ends),
    st.builds(cs.Force, signed, ends),
    st.builds(cs.ForceRamp, signed, ends),
    st.builds(cs.Oscillate, ends, ends, ends),
    st.builds(cs.Sweep, ends, ends, ends),
)


@given(materials, shapes, ends, ends, signed, st.lists(steps, max_size=3), st.booleans())
def test_numbers_at_the_ends_of_their_ranges(material, shape, work, zone, depth, steps, relaxed):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            loading = cs.Loading("relaxed" if relaxed else "jump-in", depth, tuple(steps))
            asked = cs.Scene(material, shape, loading, cs.Adhesion(work, zone))
        except cs.SceneError:
            return
    assert can_be_told(asked)
