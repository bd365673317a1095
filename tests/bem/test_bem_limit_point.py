"""Where an edge runs away: the row at the limit point itself."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem
from support.paper_scenes import cycle

from bem_solver.step import smallest
from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.cases import load


def test_smallest_value_of_a_parabola():
    place = smallest(lambda x: 2.0 + 3.0 * (x - 0.7) ** 2, 0.1, 0.4)
    assert_allclose(place, (0.7, 2.0), rtol=1e-12)
    assert smallest(lambda x: -(x**2), 0.1, 0.4) is None
    assert smallest(lambda x: 2.0 * x, 0.1, 0.4) is None


LOST_AT = {0.002: 0.0633057208, 0.02: 0.0795893386, 0.1: 0.0376330894}
"""Contact radius at the limit point of a cycle at some rates, by front tracking at resolution 20."""


@pytest.mark.parametrize(
    ("rate", "resolution"),
    [
        (0.002, 4),
        (0.02, 12),
        pytest.param(0.1, 4, marks=pytest.mark.slow),
        *(pytest.param(*row, marks=pytest.mark.exhaustive) for row in ((0.002, 12), (0.02, 4), (0.1, 12))),
    ],
)
def test_contact_is_lost_at_the_radius_of_the_limit_point(rate, resolution):
    """Not where the last step before it has ended: 3e-4 to 5e-4 of the radius too far out."""
    radius = bem(cycle(rate), resolution=resolution).contact_radius[-1]
    assert_allclose(radius, LOST_AT[rate], rtol=6e-5)


@pytest.mark.slow
def test_an_old_kink_within_the_zone_does_not_move_the_limit_point():
    """The edge has rested a zone further in, where the residual is uneven: by short steps it was missed."""
    radius = bem(cycle(0.02), resolution=24).contact_radius[-1]
    assert_allclose(radius, LOST_AT[0.02], rtol=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "exact"), [("retraction-v2e-4", 0.019441212), ("force-2", 0.061521170)])
def test_what_creeps_before_a_limit_point_does_not_move_it(name, exact):
    """Under a dead load and in slow retraction the time that is left is long: the edge is to come closer.

    Radius by front tracking at resolutions 20 and 32.
    """
    radius = bem(load(name).scene, resolution=12).contact_radius[-1]
    assert_allclose(radius, exact, rtol=4e-5)


def test_a_limit_point_is_reached_in_few_rows():
    """From where it is a tenth of a zone away no row is shorter than the one before by the root of time."""
    trace = bem(cycle(0.02), resolution=12)
    assert np.sum(trace.contact_radius[-10:] - trace.contact_radius[-1] < 2e-3) <= 4


@pytest.mark.parametrize("resolution", [4, 6])
def test_a_step_within_a_zone_lands_where_the_speed_may_jump(resolution):
    """A contact at rest withdrawn over a zone of 1e-6: passed unseen, its pull-off came 1 and 17 % late."""
    scene = Scene(
        Material(0.75, 0.5, (Branch(6.75, 1.0),)),
        Sphere(1.0),
        Loading("relaxed", 0.01, (Ramp(-0.2, 0.02),)),
        Adhesion(0.0005026548, 1.856658524149511e-07),
    )
    assert_allclose(-bem(scene, resolution=resolution).force.min(), 0.0198237539, rtol=5e-4)
