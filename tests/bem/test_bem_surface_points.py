"""Surface points over a step: the four cases join where one turns into another."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose
from support.paper_scenes import SPHERE, THREE

from bem_solver.creep import Chain
from bem_solver.motion import Motion, Passage, SurfacePoints
from bem_solver.surface_points import (
    advanced,
    along_path,
    covered,
    displacement_outside,
    free,
    load_inside,
    pressed,
    released,
)

CHAIN = Chain(THREE)
RANDOM = np.random.default_rng(3)


def points_inside(radius, penetration):
    """Points in contact with some stress in their branches."""
    variables = 0.01 * RANDOM.normal(size=(len(radius), len(CHAIN)))
    height = SPHERE.height(radius)
    displacement = penetration - height
    return SurfacePoints(radius, height, variables, load_inside(CHAIN, variables, displacement), displacement)


def points_outside(radius):
    """Points under some load, with lags."""
    variables, load = 1e-3 * RANDOM.normal(size=(len(radius), len(CHAIN))), 0.01 / radius
    return SurfacePoints(
        radius, SPHERE.height(radius), variables, load, displacement_outside(CHAIN, variables, load)
    )


def passage(points, motion):
    """Of the edge past points."""
    return Passage(CHAIN, points.radius, motion)


def stayed_outside(points, motion, load):
    """Variables of points outside all the time."""
    begin = np.ones(len(points))
    return free(CHAIN, points, motion, load) + along_path(CHAIN, points, motion, begin)


def let_go(points, motion, load):
    """Variables of points that the edge passes."""
    past = passage(points, motion)
    _, begin = past.shares
    own = released(CHAIN, points, motion, load, past)
    return own + along_path(CHAIN, points, motion, begin)


def test_edge_arriving_at_the_end_is_the_limit_of_staying_outside():
    points = points_outside(np.array([0.2]))
    motion = Motion(0.3, 0.19, 0.2, 0.0, 0.01, singular=0.05)
    state = covered(CHAIN, points, motion, passage(points, motion))
    load = load_inside(CHAIN, state, 0.01 - points.height)
    assert_allclose(stayed_outside(points, motion, load), state, rtol=1e-9, atol=1e-14)
    assert_allclose(displacement_outside(CHAIN, state, load), 0.01 - points.height, rtol=1e-10)


def test_edge_leaving_at_the_start_is_the_limit_of_having_been_outside():
    points = points_inside(np.array([0.2]), 0.01)
    motion = Motion(0.3, 0.2, 0.19, 0.01, 0.005, singular=0.05)
    load = points.load - 0.002
    assert_allclose(
        let_go(points, motion, load),
        stayed_outside(points, motion, load),
        rtol=1e-9,
        atol=1e-14,
    )


def test_edge_passing_at_the_very_end_or_start_is_the_limit_of_staying_inside():
    points = points_inside(np.array([0.19]), 0.01)
    motion = Motion(0.3, 0.2, 0.19, 0.01, 0.005)
    stayed = pressed(CHAIN, points.variables, np.array([-0.005]), 0.3)
    loose = let_go(
        points,
        motion,
        load_inside(CHAIN, stayed, 0.005 - points.height),
    )
    assert_allclose(loose, stayed, rtol=1e-12)


def test_covered_half_way_is_free_then_pressed():
    """The moment of passing splits the step in two that can be taken one after the other."""
    points = points_outside(np.array([0.195]))
    motion = Motion(0.4, 0.19, 0.2, 0.0, 0.01, singular=0.03)
    first = Motion(0.2, 0.19, 0.195, 0.0, 0.005, singular=0.03)
    met = covered(CHAIN, points, first, passage(points, first))
    then = pressed(CHAIN, met, np.array([0.005]), 0.2)
    assert_allclose(covered(CHAIN, points, motion, passage(points, motion)), then, rtol=1e-10, atol=1e-15)


def test_released_half_way_is_pressed_then_free():
    points = points_inside(np.array([0.195]), 0.01)
    motion = Motion(0.4, 0.2, 0.19, 0.01, 0.006, singular=0.03)
    load = points.load - 0.004
    half = pressed(CHAIN, points.variables, np.array([-0.002]), 0.2)
    at_release = SurfacePoints(
        points.radius,
        points.height,
        half,
        load_inside(CHAIN, half, 0.008 - points.height),
        0.008 - points.height,
    )
    second = Motion(0.2, 0.195, 0.19, 0.008, 0.006, singular=0.03)
    assert_allclose(
        let_go(points, motion, load),
        stayed_outside(at_release, second, load),
        rtol=1e-9,
        atol=1e-15,
    )


def test_without_time_a_covered_point_answers_glassy():
    points = points_outside(np.array([0.195]))
    motion = Motion(0.0, 0.19, 0.2, 0.0, 0.01, singular=0.05)
    state = covered(CHAIN, points, motion, passage(points, motion))
    wanted = 0.01 - points.height
    rise = load_inside(CHAIN, state, wanted) - points.load
    assert_allclose(rise, CHAIN.glassy * (wanted - points.displacement), rtol=1e-10)


def test_after_ages_everything_has_relaxed():
    motion = Motion(1e9, 0.19, 0.2, 0.01, 0.01)
    for points in (points_inside(np.array([0.1]), 0.01), points_outside(np.array([0.195]))):
        assert_allclose(advanced(CHAIN, points, motion, None), 0.0, atol=1e-9)
    points = points_outside(np.array([0.3]))
    crept = advanced(CHAIN, points, motion, points.load)
    assert_allclose(displacement_outside(CHAIN, crept, points.load), points.load / CHAIN.relaxed, rtol=1e-7)


def test_every_point_gets_its_case():
    """Advancing, receding and resting edges; each point as if it were alone."""
    radius = np.array([0.1, 0.19, 0.195, 0.2, 0.3])
    for start, end in ((0.19, 0.2), (0.2, 0.19), (0.195, 0.195)):
        motion = Motion(0.3, start, end, 0.01, 0.008, singular=0.02)
        inside = radius <= start
        points = points_outside(radius)
        points = replace(points, displacement=np.where(inside, 0.01 - points.height, points.displacement))
        load = 0.012 / radius
        together = advanced(CHAIN, points, motion, load)
        for index in range(len(radius)):
            alone = points[np.arange(len(radius)) == index]
            stays_in, stays_out = radius[index] <= min(start, end), radius[index] > max(start, end)
            if stays_in:
                expected = pressed(CHAIN, alone.variables, 0.008 - alone.height - alone.displacement, 0.3)
            elif stays_out:
                expected = stayed_outside(alone, motion, load[index : index + 1])
            elif end > start:
                expected = covered(CHAIN, alone, motion, passage(alone, motion))
            else:
                expected = let_go(alone, motion, load[index : index + 1])
            assert_allclose(together[index], expected[0], rtol=1e-12)


def test_speed_of_passing():
    motion = Motion(2.0, 0.1, 0.3, 0.0, 1.0)
    assert_allclose(motion.passing(np.array([0.05, 0.1, 0.15, 0.3, 0.4]))[0], [0.0, 0.0, 0.25, 1.0, 1.0])
    assert_allclose(motion.penetration_at(np.array([0.25])), 0.25)
