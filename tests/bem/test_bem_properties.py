"""What must hold for any material, any speed and any unit; few examples of a coarse solver."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from support.bem_runs import GLASSY
from support.paper_scenes import ELASTIC, cycle, scene

from bem_solver import Options, solve
from contact_scene import Branch, Material, Ramp

COARSE = Options(resolution=4)
few = settings(max_examples=4)
SPECTRA = st.lists(
    st.builds(Branch, st.floats(0.1, 5.0), st.floats(-2.0, 1.0).map(lambda k: 10.0**k)),
    min_size=1,
    max_size=4,
).map(tuple)


def approach(material, rate=0.05, depth=0.02, adhesion=None, **others):
    return scene(Ramp(depth, rate), start="relaxed", at=0.005, material=material, adhesion=adhesion, **others)


@few
@given(st.floats(0.05, 20.0), st.floats(0.05, 20.0), st.floats(0.05, 10.0))
def test_branches_of_one_time_add_up(one, two, time):
    split = solve(approach(Material(1.0, 0.4, (Branch(one, time), Branch(two, time)))), COARSE)
    joined = solve(approach(Material(1.0, 0.4, (Branch(one + two, time),))), COARSE)
    assert_allclose(split.force, joined.force, rtol=1e-11)


@pytest.mark.slow
def test_adhesive_cycle_between_its_elastic_limits():
    """Slower than anything relaxes, and faster: the pull-off of the two elastic half-spaces."""
    slow = solve(cycle(2e-8, depth=0.005), COARSE).force.min()
    assert_allclose(slow, solve(cycle(2e-8, depth=0.005, material=ELASTIC), COARSE).force.min(), rtol=0.01)
    fast = solve(cycle(1e6, depth=0.005), COARSE).force.min()
    assert_allclose(fast, solve(cycle(1e6, depth=0.005, material=GLASSY), COARSE).force.min(), rtol=0.01)


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
