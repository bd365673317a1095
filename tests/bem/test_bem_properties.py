"""What must hold for any material, any speed and any unit; few examples of a coarse solver."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from support.bem_runs import GLASSY, bem
from support.paper_scenes import ELASTIC, ONE, WORK, ZONE, cycle, scene

from bem_solver import Options, solve
from contact_scene import Adhesion, Branch, Material, OutcomeKind, Ramp, Scene, Sphere, Table

COARSE = Options(resolution=4)
few = settings(max_examples=4)
DECADES = st.floats(-3.0, 3.0).map(lambda k: 10.0**k)
SPECTRA = st.lists(
    st.builds(Branch, st.floats(0.1, 5.0), st.floats(-2.0, 1.0).map(lambda k: 10.0**k)),
    min_size=1,
    max_size=4,
).map(tuple)


def approach(material, rate=0.05, depth=0.02, adhesion=None, **others):
    return scene(Ramp(depth, rate), start="relaxed", at=0.005, material=material, adhesion=adhesion, **others)


@few
@given(DECADES, DECADES, DECADES, st.floats(0.0, 0.5))
def test_units_do_not_matter(length, modulus, time, poisson):
    plane = 1.0 - poisson**2
    material = Material(modulus * plane, poisson, (Branch(9.0 * modulus * plane, time),))
    scaled = Scene(
        material,
        Sphere(length),
        scene(Ramp(0.02 * length, 0.05 * length / time), start="relaxed", at=0.005 * length).loading,
        Adhesion(WORK * modulus * length, ZONE * length),
    )
    plain = bem(approach(ONE, adhesion=Adhesion(WORK, ZONE)), resolution=4)
    other = solve(scaled, COARSE)
    assert other.counters.steps == plain.counters.steps
    units = {"force": modulus * length**2, "contact_radius": length, "dissipated_energy": modulus * length**3}
    for name, unit in units.items():
        column = plain.columns()[name]
        assert_allclose(other.columns()[name] / unit, column, atol=1e-8 * np.abs(column).max(), err_msg=name)


@pytest.mark.slow  # by default the invariant "no weight" asks it of every solver
@few
@given(SPECTRA, st.floats(-6.0, 6.0))
def test_branch_of_zero_modulus_changes_nothing(branches, decade):
    """Of no modulus, or of one that is lost in rounding, whatever its time."""
    plain = solve(approach(Material(1.0, 0.4, branches)), COARSE)
    for modulus in (0.0, 1e-13):
        more = (*branches, Branch(modulus, 10.0**decade))
        other = solve(approach(Material(1.0, 0.4, more)), COARSE)
        assert_allclose(other.force[-1], plain.force[-1], rtol=1e-6)
        assert_allclose(other.dissipated_energy[-1], plain.dissipated_energy[-1], rtol=1e-5)


@few
@given(st.floats(0.05, 20.0), st.floats(0.05, 20.0), st.floats(0.05, 10.0))
def test_branches_of_one_time_add_up(one, two, time):
    split = solve(approach(Material(1.0, 0.4, (Branch(one, time), Branch(two, time)))), COARSE)
    joined = solve(approach(Material(1.0, 0.4, (Branch(one + two, time),))), COARSE)
    assert_allclose(split.force, joined.force, rtol=1e-11)


@pytest.mark.slow
@few
@given(SPECTRA)
def test_slow_is_relaxed_and_fast_is_glassy(branches):
    material = Material(1.0, 0.3, branches)
    relaxed = solve(approach(Material(1.0, 0.3)), COARSE).force[-1]
    slow = solve(approach(material, rate=1e-7), COARSE)
    assert_allclose(slow.force[-1], relaxed, rtol=2e-3)
    jump = scene(Ramp(0.02, 1e7), at=0.005, material=material, adhesion=None)
    glassy = scene(Ramp(0.02, 1e7), at=0.005, material=Material(material.glassy_modulus, 0.3), adhesion=None)
    assert_allclose(solve(jump, COARSE).force[-1], solve(glassy, COARSE).force[-1], rtol=2e-3)


@pytest.mark.slow
def test_adhesive_cycle_between_its_elastic_limits():
    """Slower than anything relaxes, and faster: the pull-off of the two elastic half-spaces."""
    slow = solve(cycle(2e-8, depth=0.005), COARSE).force.min()
    assert_allclose(slow, solve(cycle(2e-8, depth=0.005, material=ELASTIC), COARSE).force.min(), rtol=0.01)
    fast = solve(cycle(1e6, depth=0.005), COARSE).force.min()
    assert_allclose(fast, solve(cycle(1e6, depth=0.005, material=GLASSY), COARSE).force.min(), rtol=0.01)


@few
@given(SPECTRA, st.floats(0.01, 0.3), st.booleans())
def test_closed_path_of_the_penetration_costs_energy(branches, rate, sticky):
    """From a relaxed state around and back: the work done is positive, and so is the loss."""
    adhesion = Adhesion(WORK, ZONE) if sticky else None
    question = scene(
        Table((0.0, 0.01 / rate, 0.02 / rate), (0.02, 0.03, 0.02)),
        start="relaxed",
        at=0.02,
        material=Material(1.0, 0.4, branches),
        adhesion=adhesion,
    )
    trace = solve(question, COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.penetration[-1] == trace.penetration[0]
    assert trace.external_work[-1] > 0.0
    assert trace.dissipated_energy[-1] > 0.0
    assert np.all(np.diff(trace.extra["branch_dissipation"]) >= -1e-4 * trace.dissipated_energy[-1])


@few
@given(SPECTRA, st.floats(0.01, 0.3))
def test_stiffer_is_never_softer(branches, rate):
    """Adding a branch raises the force at every instant of an adhesionless approach."""
    times = np.linspace(0.0, 0.015 / rate, 20)
    forces = []
    for spectrum in (branches, (*branches, Branch(2.0, 0.3))):
        trace = solve(approach(Material(1.0, 0.4, spectrum), rate=rate), COARSE)
        forces.append(np.interp(times, trace.time, trace.force))
    assert np.all(forces[1] >= forces[0] * (1.0 - 1e-3))
    assert forces[1][-1] > forces[0][-1]
