"""Everything a scene can say, put to the front tracking: answers known in closed form, ends and refusals."""

import math
from functools import cache

import numpy as np
import pytest
from support.paper_scenes import ELASTIC, STICKY, WORK
from support.paper_scenes import ONE as RUBBER
from support.paper_scenes import PULL as F_JKR

from contact_scene import (
    Adhesion,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Step,
    SurfaceProfile,
    Table,
    TabulatedProfile,
    Trace,
)
from validation.measure.observables import observe
from validation.reference.path.solver import Options, solve
from validation.reference.ting import Ting

PUNCH = FlatPunch(0.2)
COARSE = Options(resolution=4)


def _scene(steps, depth=0.0, start="jump-in", shape=None, material=RUBBER, adhesion=STICKY):  # type: ignore[no-untyped-def]
    return Scene(material, shape or Sphere(1.0), Loading(start, depth, tuple(steps)), adhesion)


def _finite(trace: Trace) -> bool:
    return all(bool(np.isfinite(column).all()) for column in trace.columns().values())


def _at(trace: Trace, time: float) -> int:
    row = int(np.argmin(np.abs(trace.time - time)))
    assert trace.time[row] == pytest.approx(time, rel=1e-12)
    return row


def _after_jump(trace: Trace) -> int:
    """The last row at time zero."""
    return int(np.searchsorted(trace.time, 0.0, side="right")) - 1


def test_contact_that_begins_later() -> None:
    """Nothing happens until the indenter is there; from then on the same curve, shifted in time."""
    late = solve(_scene((Ramp(0.03, 0.05),), depth=-0.01, adhesion=None), COARSE)
    prompt = solve(_scene((Ramp(0.03, 0.05),), adhesion=None), COARSE)
    assert late.contact_radius[late.time < 0.2].max() == 0.0
    assert late.force[-1] == pytest.approx(prompt.force[-1], rel=1e-6)
    never = solve(_scene((Ramp(-0.03, 0.05),), depth=-0.01, adhesion=None))
    assert never.outcome.kind is OutcomeKind.COMPLETED
    assert not never.contact_radius.any()


@pytest.mark.slow
def test_adhesionless_force_back_to_zero() -> None:
    question = _scene((ForceRamp(0.01, 0.01), ForceRamp(-0.01, 0.01)), depth=-0.02, adhesion=None)
    trace = solve(question, Options(resolution=4))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(2.0)
    assert 0.0 < trace.penetration[-1] < 0.02
    assert trace.force.min() >= 0.0


@pytest.mark.parametrize("start", ["jump-in", pytest.param("relaxed", marks=pytest.mark.slow)])
def test_adhesionless_cone_follows_the_elastic_radius_on_approach(start: str) -> None:
    cone = Cone(80.0)
    trace = solve(_scene((Ramp(0.02, 0.01),), shape=cone, start=start, adhesion=None))
    expected = 2.0 * trace.penetration / (math.pi * cone.cotangent)
    np.testing.assert_allclose(trace.contact_radius, expected, rtol=1e-6, atol=1e-9)


def test_jkr_force_control() -> None:
    trace = solve(
        _scene((ForceRamp(-2.0 * F_JKR, 0.01),), 0.032, "relaxed", material=ELASTIC), Options(resolution=8)
    )
    assert trace.outcome.kind is OutcomeKind.DETACHED
    # The fold under force control comes at the largest tension; the same bias as under displacement control.
    assert observe(trace).pull_off_force == pytest.approx(1.02693 * F_JKR, rel=5e-6)
    assert observe(trace).detachment_radius == pytest.approx(0.1217, abs=2e-4)
    assert observe(trace).detachment_penetration > -0.006


@pytest.mark.slow
def test_constant_tension_detaches_with_delay() -> None:
    trace = solve(_scene((Force(-3.0 * F_JKR, 1000.0),), 0.032, "relaxed"))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(56.52096844, rel=5e-5)  # by twice the resolution
    assert trace.force[_after_jump(trace)] == pytest.approx(-3.0 * F_JKR, rel=1e-9)


@pytest.mark.slow
def test_long_hold_relaxes_to_the_soft_equilibrium() -> None:
    """Advance stops short of it: a closing crack stops where the closure does, so compare after a retreat."""
    trace = solve(_scene((Force(F_JKR, 500.0),), 0.032, "relaxed"))
    elastic = solve(_scene((Force(F_JKR, 1.0),), 0.032, "relaxed", material=ELASTIC))
    assert trace.contact_radius[-1] == pytest.approx(elastic.contact_radius[-1], rel=1e-4)
    assert trace.penetration[-1] == pytest.approx(elastic.penetration[-1], rel=1e-4)


def test_fast_oscillation_is_glassy_and_the_loop_closes() -> None:
    """At omega tau = 1e4 the answer is a glassy JKR contact: somewhat softer than a fixed edge, no loss."""
    trace = solve(_scene((Oscillate(1e-6, 1e4, 2.0 * math.pi * 1e-4),), 0.032, "relaxed"))
    a = trace.contact_radius[0]
    swing = np.ptp(trace.force) / np.ptp(trace.penetration)
    assert 0.9 < swing / (2.0 * a * 10.0) < 1.0
    assert trace.force[-1] == pytest.approx(trace.force[0], abs=1e-2 * np.ptp(trace.force))


@pytest.mark.slow
def test_flat_punch_under_oscillation() -> None:
    """``F = 2 a E*(omega) D`` once the transient is gone; the edge cannot move."""
    omega, amplitude = 1.5, 1e-3
    trace = solve(
        _scene((Oscillate(amplitude, omega, 24.0),), 0.0, "relaxed", PUNCH, adhesion=Adhesion(1.0, 0.01)),
        Options(resolution=40),
    )
    assert (trace.contact_radius == 0.2).all()
    modulus = complex(RUBBER.complex_modulus(omega)) / 0.75
    late = trace.time > 16.0
    expected = (2.0 * 0.2 * amplitude * modulus * np.exp(1j * omega * trace.time)).imag
    np.testing.assert_allclose(trace.force[late], expected[late], atol=1e-6 * np.abs(expected).max())


def test_flat_punch_pulled_off() -> None:
    """Kendall: ``F = -sqrt(8 pi a^3 E* dg)``, but for the finite zone; lost from the full radius."""
    forces = []
    for zone in (0.008, 0.004, 0.002):
        trace = solve(_scene((Ramp(-0.5, 0.01),), 0.01, "relaxed", PUNCH, ELASTIC, Adhesion(WORK, zone)))
        assert trace.outcome.kind is OutcomeKind.DETACHED
        assert (trace.contact_radius[:-1] == 0.2).all()
        forces.append(observe(trace).pull_off_force)
    kendall = math.sqrt(8.0 * math.pi * 0.2**3 * WORK)
    assert 2.0 * forces[2] - forces[1] == pytest.approx(kendall, rel=1e-4)
    assert forces[0] > forces[1] > forces[2] > kendall


def test_flat_punch_without_adhesion() -> None:
    trace = solve(_scene((Ramp(0.01, 0.01), Ramp(-0.01, 0.01)), shape=PUNCH, adhesion=None))
    row = _at(trace, 1.0)
    # F = 2 a int E*(t - s) V ds
    assert trace.force[row] == pytest.approx(0.4 * 0.01 * (1.0 + 9.0 * -math.expm1(-1.0)), rel=1e-6)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    # int_0^1 E - int_1^T E = 0 with E = 1 + 9 exp(-t): F = 0
    T = trace.time[-1]
    force = 2.0 - T + 9.0 * (2.0 * math.exp(-(T - 1.0)) - math.exp(-T) - 1.0)
    assert force == pytest.approx(0.0, abs=1e-6)
    assert trace.counters.closure_evaluations < 20_000


@pytest.mark.slow
@pytest.mark.parametrize(
    "shape",
    [Cone(80.0), PowerLaw(4.0, 1.0), TabulatedProfile((0.0, 0.1, 0.2, 0.6), (0.0, 0.004, 0.02, 0.19))],
    ids=lambda s: s.shape,
)
def test_other_profiles_run_through(shape) -> None:  # type: ignore[no-untyped-def]
    scene = _scene((Ramp(0.02, 0.1), Ramp(-0.5, 0.1)), shape=shape, adhesion=Adhesion(WORK, 0.006))
    trace = solve(scene)
    # the cone's contact shrinks steadily to its process zone, where the model ends
    assert trace.outcome.kind is (OutcomeKind.BELOW_ZONE if shape == Cone(80.0) else OutcomeKind.DETACHED)
    assert _finite(trace)
    coarse = solve(scene, Options(resolution=10))
    assert observe(trace).pull_off_force == pytest.approx(observe(coarse).pull_off_force, rel=2e-4)


@pytest.mark.slow
def test_tabulated_sphere_is_the_sphere() -> None:
    r = np.linspace(0.0, 0.6, 25)
    steps = (Ramp(0.032, 0.1), Ramp(-0.5, 0.1))
    table = solve(_scene(steps, shape=TabulatedProfile(tuple(r), tuple(r * r / 2.0))), COARSE)
    sphere = solve(_scene(steps), COARSE)
    assert observe(table).pull_off_force == pytest.approx(observe(sphere).pull_off_force, rel=1e-6)
    assert observe(table).loop_energy == pytest.approx(observe(sphere).loop_energy, rel=1e-6)


def test_load_jumps_are_glassy() -> None:
    trace = solve(_scene((Table((0.0, 1.0), (0.031, 0.031)),), 0.032, "relaxed"), COARSE)
    row, a = _after_jump(trace), trace.contact_radius[0]
    assert row > 0
    assert 0.9 < (trace.force[0] - trace.force[row]) / (2.0 * a * 10.0 * 0.001) < 1.0


@pytest.mark.slow
def test_a_load_jump_ends_the_contact_at_once() -> None:
    jumped = solve(_scene((Table((0.0, 1.0), (-0.2, -0.2)),), 0.032, "relaxed"), COARSE)
    assert jumped.outcome.kind is OutcomeKind.DETACHED
    assert jumped.time[-1] == 0.0


@pytest.mark.slow
def test_a_ledge_makes_the_edge_snap() -> None:
    """A profile with a gentle inner part, a steep rise and a terrace beyond: the edge jumps the rise."""
    radii = (0.0, 0.05, 0.1, 0.12, 0.14, 0.2, 0.26, 0.3, 0.6)
    heights = (0.0, 0.0005, 0.002, 0.004, 0.0062, 0.0063, 0.0064, 0.02, 0.2)
    shape = TabulatedProfile(radii, heights)
    trace = solve(
        _scene(
            (Ramp(0.02, 0.001), Ramp(-0.5, 0.001)), 0.0, "relaxed", shape, ELASTIC, Adhesion(WORK / 16, 0.004)
        )
    )
    kinds = [event.kind for event in trace.events]
    assert "snap-in" in kinds
    assert kinds[-1] == "pull-off"
    event = trace.events[kinds.index("snap-in")]
    rows = np.flatnonzero(trace.time == event.time)
    assert np.ptp(trace.contact_radius[rows]) > 0.02


def test_refusals() -> None:
    for wrong in ({"resolution": 0}, {"resolution": 4.5}, {"tolerance": 0.0}, {"tolerance": math.nan}):
        with pytest.raises(SceneError):
            Options(**wrong)


@pytest.mark.parametrize(
    ("steps", "force", "penetration", "radius"),
    [
        ((Hold(50.0),), -3.687039228e-4, 0.01, 0.1800381741),
        pytest.param(
            (Force(2.0 * F_JKR, 20.0), Force(-F_JKR, 20.0)), -F_JKR, 0.008339471159, 0.1892616929,
            marks=pytest.mark.slow,
        ),
        ((Oscillate(0.004, 1.0, 6.0, drift=1e-3),), -4.736601996e-4, 0.002882338007, 0.1374725703),
    ],
    ids=["hold", "force", "oscillate"],
)  # fmt: skip
def test_other_controls_agree_with_a_finer_run(
    steps: tuple[Step, ...], force: float, penetration: float, radius: float
) -> None:
    """Last row by twice the default resolution."""
    usual = solve(_scene(steps, 0.01))
    assert usual.outcome.kind is OutcomeKind.COMPLETED
    assert _finite(usual)
    assert usual.force[-1] == pytest.approx(force, abs=2e-5 * np.abs(usual.force).max())
    assert usual.penetration[-1] == pytest.approx(penetration, rel=2e-5)
    assert usual.contact_radius[-1] == pytest.approx(radius, rel=2e-5)


@cache
def _profiles(scene: Scene, *times: float) -> dict[float, SurfaceProfile]:
    trace = solve(scene, Options(resolution=32, profile_times=(*times, 1e9)))
    found = {profile.time: profile for profile in trace.profiles}
    assert set(found) == set(times)
    return found


def _profile(scene: Scene, time: float = 0.0) -> SurfaceProfile:
    return _profiles(scene, time)[time]


def test_profile_of_hertz() -> None:
    profile = _profile(_scene((Ramp(0.04, 0.01),), 0.032, material=ELASTIC, adhesion=None), 0.5)
    a, r = profile.contact_radius, profile.radius
    within = r < a
    assert profile.radius[0] == 0.0
    np.testing.assert_allclose(
        profile.pressure[within], 2.0 / math.pi * np.sqrt(a * a - r[within] ** 2), atol=2e-6 * a
    )
    s = r[~within]
    outside = ((2.0 * a * a - s * s) * np.arcsin(a / s) + a * np.sqrt(s * s - a * a)) / math.pi
    np.testing.assert_allclose(profile.displacement[~within], outside, atol=1e-7 * profile.penetration)
    assert not profile.pressure[~within].any()
    assert not profile.gap[within].any()


def test_profile_of_jkr() -> None:
    profile = _profile(_scene((), 0.032, "relaxed", material=ELASTIC))
    a = profile.contact_radius
    r = profile.radius[profile.radius < a]
    root = np.sqrt(a * a - r * r)
    expected = (2.0 * root + (0.032 - a * a) / root) / math.pi
    np.testing.assert_allclose(profile.pressure[: len(r)], expected, rtol=1e-8, atol=1e-8)
    assert profile.gap.min() >= 0.0


PROFILED = (0.0, 0.8, 1.6, 1.9)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [Sphere(1.0), Cone(80.0), PUNCH], ids=lambda s: s.shape)
@pytest.mark.parametrize("time", PROFILED)
def test_profiles_carry_the_force(shape, time: float) -> None:  # type: ignore[no-untyped-def]
    """``2 pi int p r dr = F``, by a quadrature that knows of the root at the edge."""
    scene = _scene(
        (Ramp(0.032, 0.02), Ramp(0.0, 0.02)), 0.0, "jump-in", shape, adhesion=Adhesion(WORK, 0.004)
    )
    profile = _profiles(scene, *PROFILED)[time]
    a, within = profile.contact_radius, profile.radius < profile.contact_radius
    angle = np.arcsin(profile.radius[within] / a)
    density = profile.pressure[within] * profile.radius[within] * a * np.cos(angle)
    edge = 3.0 * density[-1] - 3.0 * density[-2] + density[-3]
    total = 2.0 * math.pi * np.trapezoid(np.append(density, edge), np.append(angle, 0.5 * math.pi))
    scale = max(abs(profile.force), 1e-3)
    assert total == pytest.approx(profile.force, abs=2e-3 * scale)
    assert np.isfinite(profile.displacement).all()
    assert np.all(np.diff(profile.radius) > 0.0)


@pytest.mark.slow
def test_a_flat_profile_is_left_although_its_radius_vanishes_faster_than_time_resolves() -> None:
    """Radius like the sixth root of the time left: down to 1e-3 of its largest that is 1e-18 of the run."""
    steps = (Ramp(0.03, 0.1), Ramp(-0.5, 0.1))
    flat = PowerLaw(5.9, 0.5)
    trace = solve(_scene(steps, start="relaxed", shape=flat, adhesion=None), COARSE)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    exact = Ting(RUBBER, flat, rise=0.1, peak=0.3, fall=0.1)
    assert trace.time[-1] == pytest.approx(exact.detachment(), rel=1e-5)
    assert trace.counters.steps + trace.counters.rejected_steps < 2000
