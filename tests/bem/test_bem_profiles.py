"""Surface profiles at requested times (paper, Fig. 3)."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem
from support.paper_scenes import SPHERE, cycle, scene

from bem_solver import Options, solve
from contact_scene import Branch, Force, ForceRamp, Material, Ramp
from validation.reference import path as reference

TIMES = (0.0, 0.3, 0.7, 1.6, 2.0, 2.4)
CYCLE = cycle(0.02)


def force_of(profile):
    """``int p 2 pi r dr`` with the edge's square root taken out: ``r = a sin(t)``."""
    inside = profile.radius < profile.contact_radius
    angle = np.arcsin(profile.radius[inside] / profile.contact_radius)
    density = profile.pressure[inside] * np.cos(angle) * 2.0 * np.pi * profile.radius[inside]
    density = np.append(density, density[-1] + (density[-1] - density[-2]) * 0.5)
    return profile.contact_radius * np.trapezoid(density, np.append(angle, 0.5 * np.pi))


def asked():
    """The cycle with its profiles; two of the times lie outside the run."""
    return bem(CYCLE, profile_times=(-1.0, *TIMES, 1e9), resolution=6)


@pytest.fixture(scope="module")
def profiles():
    return asked().profiles


def test_times_are_stepped_onto(profiles):
    trace = asked()
    assert tuple(p.time for p in profiles) == TIMES
    for profile in profiles:
        rows = np.flatnonzero(trace.time == profile.time)
        assert rows.size
        assert profile.force == trace.force[rows[-1]]
        assert profile.contact_radius == trace.contact_radius[rows[-1]]
        assert profile.penetration == trace.penetration[rows[-1]]
        depth = 0.02 * profile.time if profile.time <= 1.6 else 0.064 - 0.02 * profile.time
        assert_allclose(profile.penetration, depth, atol=1e-15)


def test_pressure_adds_up_to_the_force(profiles):
    scale = max(abs(p.force) for p in profiles)
    for profile in profiles:
        assert_allclose(force_of(profile), profile.force, atol=2e-3 * scale)


def test_contact_conditions(profiles):
    for p in profiles:
        outside = p.radius > p.contact_radius
        assert np.all(np.diff(p.radius) > 0.0)
        assert p.radius[0] == 0.0
        assert outside.any()
        assert_allclose(p.pressure[outside], 0.0, atol=0.0)
        assert_allclose(p.gap[~outside], 0.0, atol=0.0)
        assert np.all(p.gap >= -1e-6)
        assert_allclose(p.displacement[~outside], p.penetration - SPHERE.height(p.radius[~outside]))
        assert_allclose(p.gap, SPHERE.height(p.radius) - p.penetration + p.displacement, atol=1e-14)
        for column in (p.pressure, p.displacement, p.gap):
            assert np.isfinite(column).all()


def test_profiles_are_those_of_front_tracking(profiles):
    others = reference.solve(CYCLE, reference.Options(resolution=6, profile_times=TIMES)).profiles
    for mine, other in zip(profiles, others, strict=True):
        assert mine.time == other.time
        well_inside = mine.radius < 0.9 * mine.contact_radius
        pressure = np.interp(mine.radius[well_inside], other.radius, other.pressure)
        assert_allclose(mine.pressure[well_inside], pressure, atol=0.02 * np.abs(pressure).max())
        beyond = (mine.radius > 1.02 * mine.contact_radius) & (mine.radius < other.radius[-1])
        gap = np.interp(mine.radius[beyond], other.radius, other.gap)
        assert_allclose(mine.gap[beyond], gap, atol=2e-3 * gap.max())


def test_times_outside_the_run_are_ignored_and_none_changes_the_answer():
    plain = bem(CYCLE, resolution=6)
    assert tuple(p.time for p in asked().profiles) == TIMES
    assert plain.profiles == ()
    assert_allclose(asked().force.min(), plain.force.min(), rtol=2e-4)


def test_surface_after_detachment_and_before_contact():
    waiting = scene(Ramp(0.01, 0.01), at=-0.01, adhesion=None)
    early, late = solve(waiting, Options(resolution=4, profile_times=(0.5, 1.5))).profiles
    assert early.contact_radius == early.force == 0.0
    assert_allclose(early.pressure, 0.0)
    assert_allclose(early.gap[1:], SPHERE.height(early.radius[1:]) + 0.005)
    assert late.contact_radius > 0.0


def test_profile_without_contact_or_length_scale():
    question = scene(Ramp(-0.01, 0.1), start="relaxed", adhesion=None)
    profile = solve(question, Options(resolution=4, profile_times=(0.0,))).profiles[0]
    assert profile.radius.tolist() == profile.pressure.tolist() == profile.gap.tolist() == [0.0]


@pytest.mark.slow
def test_released_surface_keeps_its_indentation():
    """Profile at the moment an adhesionless contact is lost: nowhere inside the indenter."""
    question = scene(
        ForceRamp(0.0015, 0.096),
        Force(-0.0024, 0.7),
        start="relaxed",
        at=-0.0017,
        adhesion=None,
        material=Material(0.75, 0.5, (Branch(0.75, 0.01),)),
    )
    lost = 0.0015 / 0.096
    profile = solve(question, Options(resolution=4, profile_times=(lost,))).profiles[-1]
    assert profile.contact_radius == 0.0
    assert profile.gap.min() > -1e-3 * profile.penetration
    assert_allclose(profile.displacement.max(), profile.penetration, rtol=1e-3)
