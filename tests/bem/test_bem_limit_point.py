"""Where an edge runs away: the row at the limit point itself."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem, front
from support.paper_scenes import cycle

from bem_solver.limit_point import smallest
from validation.cases import load


def test_smallest_value_of_a_parabola():
    place = smallest(lambda x: 2.0 + 3.0 * (x - 0.7) ** 2, 0.1, 0.4)
    assert_allclose(place, (0.7, 2.0), rtol=1e-12)
    assert smallest(lambda x: -(x**2), 0.1, 0.4) is None
    assert smallest(lambda x: 2.0 * x, 0.1, 0.4) is None


@pytest.mark.parametrize("rate", [0.002, 0.02, 0.1])
@pytest.mark.parametrize("resolution", [4, 12])
def test_contact_is_lost_at_the_radius_of_the_limit_point(rate, resolution):
    """Not where the last step before it has ended: 3e-4 to 5e-4 of the radius too far out."""
    radius = bem(cycle(rate), resolution=resolution).contact_radius[-1]
    assert_allclose(radius, front(cycle(rate), None).contact_radius[-2], rtol=6e-5)


@pytest.mark.slow
def test_an_old_kink_within_the_zone_does_not_move_the_limit_point():
    """The edge has rested a zone further in, where the residual is uneven: by short steps it was missed."""
    radius = bem(cycle(0.02), resolution=48).contact_radius[-1]
    assert_allclose(radius, front(cycle(0.02), None).contact_radius[-2], rtol=4e-5)


def test_what_creeps_before_a_limit_point_does_not_move_it():
    """Under a dead load and in slow retraction the time that is left is long: the edge is to come closer."""
    for name in ("retraction-v2e-4", "force-2"):
        question = load(name).scene
        radius = bem(question, resolution=12).contact_radius[-1]
        assert_allclose(radius, front(question, None).contact_radius[-2], rtol=4e-5)


def test_a_limit_point_is_reached_in_few_rows():
    """From where it is a tenth of a zone away no row is shorter than the one before by the root of time."""
    trace = bem(cycle(0.02), resolution=12)
    assert np.sum(trace.contact_radius[-10:] - trace.contact_radius[-1] < 2e-3) <= 4
