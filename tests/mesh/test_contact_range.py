"""The largest contact a finite-element mesh has to hold, against closed forms."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from support.paper_scenes import ONE, STICKY, WORK, ZONE

from contact_scene import (
    Adhesion,
    Approach,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Layer,
    Loading,
    Machine,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Table,
    TabulatedProfile,
)
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR
from validation.reference.path import Options, solve
from validation.solvers.contact_range import SPARE, largest_contact_radius
from validation.solvers.finite_elements import LEAST_DIVISIONS, FiniteElements


def scene(*steps, indenter=None, adhesion=None, depth=0.0):
    return Scene(ONE, indenter or Sphere(1.0), Loading("relaxed", depth, steps), adhesion)


ROWS = (0.0, 1.0, 2.0, 3.0), (0.01, 0.03, 0.09, 0.01)
LAW = JKR(Sphere(1.0), 1.0, WORK)
CLOSED_FORMS = {
    "Hertz": (scene(Ramp(0.04, 1.0), Hold(3.0), Ramp(-1.0, 1.0)), 0.2),
    "cone": (scene(indenter=Cone(70.0), depth=0.1), 0.1 / (0.5 * np.pi * np.tan(np.radians(20.0)))),
    "JKR": (scene(depth=0.03, adhesion=STICKY), LAW.at_penetration(0.03).contact_radius),
    "JKR, force": (
        scene(Force(0.05, 1.0), depth=0.001, adhesion=STICKY),
        LAW.at_force(0.05).contact_radius,
    ),
    "linear table": (scene(Table(*ROWS, interpolation="linear"), depth=0.01), 0.3),
    "cubic table": (scene(Table(*ROWS, interpolation="cubic"), depth=0.01), 0.3),
    "amplitude": (scene(Oscillate(0.01, 3.0, 100.0), depth=0.03), 0.2),
    "negative amplitude": (scene(Oscillate(-0.01, 3.0, 100.0), depth=0.03), 0.2),
    "sinking": (scene(Oscillate(0.01, 3.0, 100.0, -1e-4), depth=0.03), np.sqrt(0.05)),
    "rising": (scene(Oscillate(0.01, 3.0, 100.0, 1e-4), depth=0.03), 0.2),
    "punch": (scene(indenter=FlatPunch(0.7), depth=0.1), 0.7 / SPARE),
}


@pytest.mark.parametrize("base", ["bonded", "frictionless"])
def test_the_largest_contact_on_a_layer(base):
    """At a penetration it is larger than on a half-space, under a force smaller."""
    film = Layer(0.1, base)
    deep, pressed = scene(depth=0.03, adhesion=STICKY), scene(Force(0.05, 1.0), depth=1e-3, adhesion=STICKY)
    closed = ElasticLayer(film, 0.5, Sphere(1.0))
    for asked, value in ((deep, ("penetration", 0.03)), (pressed, ("force", 0.05))):
        found = largest_contact_radius(dataclasses.replace(asked, body=film))
        state = closed.state(found / SPARE, WORK)
        assert getattr(state, value[0]) == pytest.approx(value[1], rel=1e-9)
        assert (found > largest_contact_radius(asked)) == (asked is deep)
        thick = largest_contact_radius(dataclasses.replace(asked, body=Layer(1e7, base)))
        assert thick == largest_contact_radius(asked)


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_the_largest_contact_is_that_of_the_closed_form(name):
    asked, radius = CLOSED_FORMS[name]
    assert largest_contact_radius(asked) == pytest.approx(SPARE * radius)


@pytest.mark.parametrize("start", ["relaxed", "jump-in"])
def test_a_soft_spring_presses_on_with_the_force_of_the_start(start):
    """The stage stays where the first contact puts it, ``X = D + F/k``, while the half-space relaxes."""
    moduli = {"relaxed": ONE.relaxed_plane_modulus, "jump-in": ONE.glassy_plane_modulus}
    stage = 0.02 + 4.0 / 3.0 * moduli[start] * 0.02**1.5 / 0.2
    asked = Scene(ONE, Sphere(1.0), Loading(start, 0.02, (Hold(50.0),), Machine(0.2)))
    a = largest_contact_radius(asked) / SPARE
    assert a**2 + 4.0 / 3.0 * ONE.relaxed_plane_modulus * a**3 / 0.2 == pytest.approx(stage)


def test_force_ramp_begins_with_the_force_it_finds():
    """Relaxed at a relaxed start, which is the contact of that depth; else at most the glassy one."""
    still = scene(depth=0.03)
    assert largest_contact_radius(scene(ForceRamp(0.0, 1.0), depth=0.03)) == pytest.approx(
        largest_contact_radius(still)
    )
    glassy = dataclasses.replace(still, loading=Loading("jump-in", 0.03, (ForceRamp(0.0, 1.0),)))
    assert largest_contact_radius(glassy) == pytest.approx(10.0 ** (1 / 3) * largest_contact_radius(still))


REACHED = Ramp(0.04, 1e-2, until_force=1e-3)
"""Its end is known only after the run."""


DEEPER, PRESSED = Ramp(0.09, 1.0), ForceRamp(0.02, 1e-2)
SWING = Oscillate(1e-4, 3.0, 10.0)


@pytest.mark.parametrize(
    ("later", "alone"),
    [
        ((DEEPER,), DEEPER),
        ((SWING, DEEPER), DEEPER),
        ((Ramp(0.09, 1.0, until_force=0.02),), PRESSED),
        ((PRESSED,), PRESSED),
        ((SWING, PRESSED), PRESSED),
    ],
    ids=["deeper", "oscillation, deeper", "next level", "force", "oscillation, force"],
)
@pytest.mark.parametrize("indenter", [Sphere(1.0), TabulatedProfile((0.0, 0.2, 0.6), (0.0, 0.02, 0.18))])
def test_what_comes_after_a_level_counts(indenter, later, alone):
    """The mesh was made for the first level, and a profile ended in a traceback."""
    least = largest_contact_radius(scene(alone, indenter=indenter))
    assert largest_contact_radius(scene(REACHED, *later, indenter=indenter)) >= least


def test_a_ramp_that_waits_for_less_than_it_begins_with_goes_to_its_end():
    passed = scene(Ramp(0.09, 1.0, until_force=1e-6), depth=0.03)
    assert largest_contact_radius(passed) == largest_contact_radius(scene(Ramp(0.09, 1.0)))


def test_an_oscillation_about_where_a_force_has_led():
    a = largest_contact_radius(scene(ForceRamp(0.01, 1.0))) / SPARE
    asked = scene(ForceRamp(0.01, 1.0), Oscillate(0.01, 3.0, 100.0))
    assert 1.0 <= largest_contact_radius(asked) / (SPARE * np.sqrt(a**2 + 0.01)) < 1.07


def test_same_scene_in_other_units():
    first = scene(Ramp(0.03, 1.0), adhesion=Adhesion(5e-4, 0.013))
    unit = 1e-9
    second = dataclasses.replace(
        first,
        indenter=Sphere(unit),
        loading=Loading("relaxed", 0.0, (Ramp(0.03 * unit, unit),)),
        adhesion=Adhesion(5e-4 * unit, 0.013 * unit),
    )
    assert largest_contact_radius(second) == pytest.approx(
        unit * largest_contact_radius(first), rel=1e-12, abs=0.0
    )


def test_no_contact_is_said():
    with pytest.raises(SceneError, match="never brings a contact about"):
        largest_contact_radius(scene(depth=-0.1))


def fine_size(asked, resolution):
    fem = FiniteElements()
    return fem.parameters(asked, resolution or fem.default_resolution(asked)).fine_size


@pytest.mark.parametrize("zone", [1e-4, 0.02])
def test_a_refused_mesh_advises_the_finest_one_that_is_not(zone, monkeypatch):
    sticky = scene(Ramp(0.03, 1.0), adhesion=Adhesion(5e-4, zone))
    monkeypatch.setattr("validation.solvers.finite_elements.installed_memory", lambda: None)
    with pytest.raises(SceneError, match="coarser resolution, at most") as refused:
        FiniteElements().check(sticky, 10_000)
    advised = int(refused.value.allowed.split()[-1])
    assert fine_size(sticky, advised) == pytest.approx(1.0 / advised)  # in zones
    FiniteElements().check(sticky, advised)
    with pytest.raises(SceneError):
        FiniteElements().check(sticky, advised + 1)


def test_resolutions_mean_finer_meshes_from_the_coarsest_offered_on():
    """With and without adhesion; the default is among those a user may choose."""
    for adhesion in (None, Adhesion(5e-4, 0.013)):
        asked = scene(Ramp(0.03, 1.0), adhesion=adhesion)
        sizes = [fine_size(asked, resolution) for resolution in range(LEAST_DIVISIONS, 40)]
        assert np.all(np.diff(sizes) < 0.0)
        default = FiniteElements().default_resolution(asked)
        assert default >= LEAST_DIVISIONS
        assert fine_size(asked, None) == sizes[default - LEAST_DIVISIONS]


def test_a_process_zone_holds_on_where_a_sharp_edge_has_let_go():
    law = FiniteZone(1.0, 1.0, WORK, ZONE)
    limit = law.pull_off_penetration_control().penetration
    assert limit < JKR(Sphere(1.0), 1.0, WORK).pull_off_penetration_control().penetration
    beyond = dataclasses.replace(scene(adhesion=STICKY, depth=0.995 * limit), material=Material(1.0, 0.0))
    assert largest_contact_radius(beyond) > law.at_penetration(0.995 * limit).contact_radius


def powers_of_ten(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@pytest.mark.slow
@settings(max_examples=10, deadline=None, database=None)
@given(
    st.sampled_from([Sphere(1.0), Cone(80.0), PowerLaw(3.0, 1.0)]),
    st.builds(Layer, powers_of_ten(-1.5, 0.0), st.sampled_from(["bonded", "frictionless"])),
    st.sampled_from([0.0, 0.3, 0.45, 0.5]),
    st.builds(Branch, powers_of_ten(-1.0, 1.3), powers_of_ten(-2.0, 1.0)),
    st.builds(Approach, powers_of_ten(-4.0, 0.0), powers_of_ten(-4.0, -1.5)),
    st.sampled_from([None, Adhesion(1e-5, 1e-4), Adhesion(1e-4, 1e-3)]),
    st.sampled_from([None, Machine(1.0)]),
)
def test_no_run_goes_beyond_what_ends_at_a_force(
    indenter, layer, poisson, branch, approach, adhesion, machine
):
    """On a layer the force is reached before the bound of its approach, in a contact as foreseen."""
    loading = Loading("jump-in", 0.0, (approach,), machine)
    asked = Scene(Material(1.0, poisson, (branch,)), indenter, loading, adhesion, body=layer)
    press = dataclasses.replace(loading, steps=asked.loading.steps[:1])
    try:
        trace = solve(dataclasses.replace(asked, loading=press), Options(resolution=1))
    except SceneError:  # the contact at first touch is shorter than its zone
        reject()
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.contact_radius.max() <= largest_contact_radius(asked)
