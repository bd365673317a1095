"""Whole runs of the finite-element solver against closed forms, check values and itself."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from support.closed_forms import lee_radok
from support.paper_scenes import ELASTIC as SOFT
from support.paper_scenes import ONE as RUBBER
from support.paper_scenes import PULL as JKR
from support.paper_scenes import STICKY as ADHESION
from support.paper_scenes import WORK, ZONE
from support.paper_scenes import cycle as cycle_scene
from support.paper_scenes import scene as scene_of

from contact_scene import (
    Branch,
    BulkRelaxation,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    SceneError,
    Sphere,
)
from fem_solver import Options, solve
from meshes import EdgeMeshes
from validation.cases import load
from validation.fields.moments import FieldRequest, record_fields
from validation.measure.curves import distance
from validation.measure.windows import windows
from validation.reference import punch_oscillation, sneddon
from validation.solvers import SOLVERS
from validation.solvers.base import RunOptions


@cache
def mesh(divisions=2, reach=0.26):
    return EdgeMeshes(ZONE, divisions, reach)


def pressed(reach, divisions=4, **more):
    """Places without adhesion."""
    return EdgeMeshes(0.05 * reach, divisions, reach, **more)


def run(*steps, start="relaxed", penetration=0.02, material=RUBBER, indenter=None, **options):
    scene = scene_of(*steps, start=start, at=penetration, material=material, indenter=indenter or Sphere(1.0))
    return solve(scene, mesh(), Options(**options))


@cache
def cycle(speed, divisions=2, tolerance=1e-3):
    return solve(cycle_scene(speed), mesh(divisions), Options(tolerance))


def is_finite(trace):
    return all(np.isfinite(column).all() for column in trace.columns().values())


def loop(trace):
    return float(np.sum(0.5 * (trace.force[1:] + trace.force[:-1]) * np.diff(trace.penetration))) / np.pi


# speed: a and F~ at the end of approach, pull-off force in F_JKR, penetration at detachment, loop integral
CHECKS = {
    0.002: (0.21116, 4.2685e-3, 4.5242, -0.02277, 1.8872e-4),
    0.02: (0.20183, 1.47721e-2, 4.3000, 0.013264, 1.5104e-4),
    0.1: (0.20092, 2.13035e-2, 1.7023, 0.0042386, 7.469e-5),
}


def cycle_errors(speed, divisions=2, tolerance=1e-3):
    trace = cycle(speed, divisions, tolerance)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    top = int(np.argmax(trace.penetration))
    found = (
        trace.contact_radius[top],
        trace.force[top] / np.pi,
        -trace.force.min() / JKR,
        trace.penetration[-1],
        loop(trace),
    )
    return np.array([a / b - 1.0 for a, b in zip(found, CHECKS[speed], strict=True)])


def test_a_cycle_at_two_elements_per_process_zone():
    assert np.abs(cycle_errors(0.02)).max() < 1e-2
    trace = cycle(0.02)
    assert is_finite(trace)
    assert len(trace.time) > 100
    assert np.all(np.diff(trace.time) >= 0.0)
    work = np.abs(trace.external_work).max()
    assert np.abs(trace.extra["balance_residual"]).max() < 5e-4 * work
    assert np.all(np.diff(trace.extra["branch_dissipation"]) >= -1e-12 * work)
    # contact gained and lost again: the loss is the work done plus what adhesion gave
    assert trace.dissipated_energy[-1] > 0.0
    assert trace.extra["zone_excess"][-1] > 0.0


@pytest.mark.parametrize("target", [0.02, 0.045], ids=["opening", "closing"])
def test_branch_integral_of_a_sharp_edge_slow_against_the_branch(target):
    """An element takes hundreds of the branch's times to open or close, a sharp tip none."""
    fast = Material(0.75, 0.5, (Branch(0.2, 1e-3),))
    scene = scene_of(Ramp(target, 0.01), start="relaxed", at=0.032, material=fast)
    trace = solve(scene, mesh(reach=0.31))
    expected = SOLVERS["reference"].solve(scene, 4).extra["branch_dissipation"][-1]
    assert trace.extra["branch_dissipation"][-1] == pytest.approx(expected, rel=0.05)
    assert np.all(np.diff(trace.extra["branch_dissipation"]) >= 0.0)


@pytest.mark.exhaustive
@pytest.mark.parametrize("speed", CHECKS)
def test_cycles_at_default_and_twice_the_resolution(speed):
    assert np.abs(cycle_errors(speed, 10)).max() < 2e-3
    assert np.abs(cycle_errors(speed, 20)).max() < 1e-3
    work = np.abs(cycle(speed, 10).external_work).max()
    assert np.abs(cycle(speed, 10).extra["balance_residual"]).max() < 1e-4 * work


@pytest.mark.slow
def test_order_of_convergence_over_three_doublings():
    """The singular edge cancels in the closure; curvature in space and time remains, refined together."""
    errors = np.abs([cycle_errors(0.002, n, None)[2] for n in (2, 4, 8)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 1.5) & (orders < 2.6))
    assert errors[-1] < 6e-4


def test_elastic_bulk_relaxes_a_punch_as_the_correspondence_principle_says():
    material = Material(1.0, 0.3, (Branch(9.0, 1.0),), bulk="elastic")
    scene = Scene(material, FlatPunch(1.0), Loading("jump-in", 0.01, (Hold(3.0),)))
    trace = solve(scene, pressed(1.0))
    soft, branch, bulk = 1.0 / 2.6, 9.0 / 2.6, 1.0 / 1.2
    # E* = 4G(3K + G)/(3K + 4G) with s G(s) = soft + branch s/(1 + s): a pole each at 1 and at p
    p = (3 * bulk + 4 * soft) / (3 * bulk + 4 * soft + 4 * branch)
    s = np.array([0.1, 1.0, 10.0])
    shear = soft + branch * s / (1 + s)
    basis = np.stack([np.ones(3), s / (1 + s), s / (p + s)], axis=1)
    a, b, c = np.linalg.solve(basis, 4 * shear * (3 * bulk + shear) / (3 * bulk + 4 * shear))
    expected = 0.02 * (a + b * np.exp(-trace.time) + c * np.exp(-p * trace.time))
    assert np.abs(trace.force / expected - 1.0).max() < 1.5e-3
    assert np.ptp(trace.force / expected) < 5e-4
    assert expected[0] / expected[-1] > 3.0
    lost = trace.extra["branch_dissipation"][-1]
    assert lost == pytest.approx(trace.stored_energy[0] - trace.stored_energy[-1], rel=1e-3)


def test_loop_of_a_swinging_punch_is_that_of_its_force():
    """``int F dD`` along the exact force of one branch; the polygon through the rows misses it by 1.5e-3."""
    scene = Scene(RUBBER, FlatPunch(1.0), Loading("relaxed", 0.1, (Oscillate(0.01, 1.0, 2.0 * math.tau),)))
    trace = solve(scene, pressed(1.0))
    soft, branch = (2.0 * modulus / 0.75 for modulus in (RUBBER.modulus, RUBBER.branches[0].modulus))
    fresh = 0.5 * branch * 0.01  # of the branch, at unit frequency and relaxation time

    def power(time):
        stress = fresh * (np.cos(time) + np.sin(time) - np.exp(-time))
        return (soft * (0.1 + 0.01 * np.sin(time)) + stress) * 0.01 * np.cos(time)

    ratio = trace.force[-1] / (soft * 0.1 + fresh)  # the error of the mesh, alike in all forces
    assert trace.external_work[-1] == pytest.approx(ratio * quad(power, 0.0, 2.0 * math.tau)[0], rel=6e-4)
    assert trace.dissipated_energy[-1] == pytest.approx(trace.extra["branch_dissipation"][-1], rel=3e-4)


@pytest.mark.slow
def test_the_little_that_an_almost_elastic_press_loses():
    """2e-4 of its work: by the polygon through the rows a sixth too much."""
    rubber = Material(0.75, 0.5, (Branch(0.0075, 1.0),))
    scene = Scene(rubber, Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.03, 1.0),)))
    trace = solve(scene, pressed(0.2, 12))
    assert trace.dissipated_energy[-1] == pytest.approx(trace.extra["branch_dissipation"][-1], rel=0.02)


def test_the_domain_hardly_matters_when_shear_and_bulk_relax_apart():
    """Contact radii are those of punches as stiff: the domain's stiffness is not in the force."""
    material = Material(1.0, 0.3, (Branch(9.0, 1.0),), bulk="elastic")
    scene = Scene(material, FlatPunch(1.0), Loading("jump-in", 0.01, (Hold(3.0),)))

    def force(domain):
        trace = solve(scene, pressed(1.0, domain_ratio=domain))
        return np.interp(np.linspace(0.0, 3.0, 13), trace.time, trace.force)

    assert np.abs(force(12.0) / force(400.0) - 1.0).max() < 5e-4


def test_relaxing_bulk_with_the_shear_s_own_branches_is_a_constant_poisson_ratio():
    alike = Material(1.0, 0.3, (Branch(3.0, 0.5),))
    factor = 1.0 / (3.0 * 0.4)
    apart = Material(1.0, 0.3, (Branch(3.0, 0.5),), BulkRelaxation(factor, (Branch(3.0 * factor, 0.5),)))
    traces = [run(Ramp(0.021, 0.01), material=m) for m in (alike, apart)]
    assert np.allclose(traces[0].force, traces[1].force, rtol=1e-9)


def test_adhesionless_approach_and_retraction():
    # Lee-Radok and Ting: values of formulation, exact
    loading = Loading("jump-in", -0.005, (Ramp(0.05, 0.05), Ramp(-0.05, 0.05)))
    times = {0.6: (0.1581139, 0.04443517), 1.1: (0.2236068, 0.10786683), 1.371049: (0.1795367, 0.03680143)}
    trace = solve(Scene(RUBBER, Sphere(1.0), loading), pressed(0.23), Options(profile_times=tuple(times)))
    for time, (radius, force) in times.items():
        row = int(np.argmin(np.abs(trace.time - time)))
        assert trace.time[row] == time
        assert trace.contact_radius[row] == pytest.approx(radius, rel=1e-3)
        assert trace.force[row] == pytest.approx(force, rel=1e-3)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.outcome.time == pytest.approx(1.6420981, abs=1e-3)
    assert trace.events[-1].penetration == pytest.approx(0.0228951, abs=1e-4)
    assert trace.force.min() >= -1e-7 * trace.force.max()  # of the first node in part
    assert trace.contact_radius[0] == trace.force[0] == 0.0
    assert len(trace.profiles) == 3
    profile = trace.profiles[1]
    area = np.pi * np.diff(profile.radius**2)
    total = np.sum(0.5 * (profile.pressure[1:] + profile.pressure[:-1]) * area)
    assert total == pytest.approx(profile.force, rel=5e-3)
    assert np.all(profile.gap >= 0.0)
    inside = profile.radius < 0.98 * profile.contact_radius
    assert np.allclose(profile.displacement[inside], 0.05 - profile.radius[inside] ** 2 / 2, atol=1e-9)


def test_creep_of_an_adhesionless_sphere_under_constant_force():
    scene = Scene(RUBBER, Sphere(1.0), Loading("jump-in", 0.0, (Force(0.01, 2.0),)))
    trace = solve(scene, pressed(0.23))
    loaded = trace.force == 0.01
    assert np.all(loaded[trace.time > 0.0])
    compliance = 1.0 - 0.9 * np.exp(-trace.time[loaded] / 10.0)
    assert np.allclose(trace.contact_radius[loaded], (0.0075 * compliance) ** (1 / 3), rtol=2e-3)


@pytest.mark.parametrize("level", [2e-3, -1e-3])
def test_a_glassy_load_jump_without_adhesion_loses_nothing(level):
    """A stiff glass over a soft solid: the penetration hardly changes, the contact by much or all of it."""
    scene = Scene(RUBBER, Sphere(1.0), Loading("relaxed", 0.02, (Force(level, 1e-9),)))
    trace = solve(scene, pressed(0.16))
    assert trace.outcome.finished
    whole = abs(trace.external_work).max()
    assert abs(trace.dissipated_energy).max() < 1e-3 * whole
    assert abs(trace.extra["balance_residual"]).max() < 1e-3 * whole


@pytest.mark.slow
def test_force_control_pulls_off_at_the_same_load_as_the_elastic_curve_has():
    trace = run(ForceRamp(-2.0 * JKR, 0.1 * JKR), penetration=0.0, material=SOFT)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert -trace.force[-1] / JKR == pytest.approx(1.02693, rel=2e-3)
    assert trace.events[-1].kind == "pull-off"


def test_load_jumps_are_glassy():
    trace = run(Force(-0.01, 1e-3), penetration=0.02)
    last = np.flatnonzero(trace.time == 0.0)[-1]
    assert trace.force[last] == -0.01
    stiffness = (trace.force[last] - trace.force[0]) / (trace.penetration[last] - trace.penetration[0])
    # that of the glassy punch, 2 Einf* a, less what the edge gives way: 0.92414 of it by front tracking
    assert stiffness == pytest.approx(0.92414 * 20.0 * trace.contact_radius[0], rel=1e-3)


@pytest.mark.parametrize("indenter", [Cone(70.0), PowerLaw(4.0, 8.0)])
def test_other_indenters_obey_their_elastic_equilibrium(indenter):
    trace = run(penetration=0.05, material=SOFT, indenter=indenter)
    a = trace.contact_radius[0]
    # Sneddon's transform G(x) and force of the full profile, plus a punch in tension
    if isinstance(indenter, Cone):
        depth = 0.5 * np.pi * a * indenter.cotangent
        full = 0.5 * np.pi * a**2 * indenter.cotangent
    else:
        depth = 8.0 * 8.0 / 3.0 * a**4
        full = 2.0 * depth * a * 4.0 / 5.0
    assert depth > 0.05
    assert trace.force[0] == pytest.approx(full - 2.0 * a * (depth - 0.05), rel=4e-3)


def test_adhering_flat_punch_releases_at_its_edge():
    loading = Loading("relaxed", 0.0, (Ramp(-0.1, 0.001),))
    trace = solve(Scene(SOFT, FlatPunch(0.2), loading, ADHESION), mesh(4, 0.2))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert np.all(trace.contact_radius == 0.2)
    kendall = np.sqrt(8.0 * np.pi * 0.2**3 * WORK)
    assert kendall < -trace.force.min() < 1.02 * kendall  # a finite zone adds about da/(4a)
    assert np.allclose(trace.force, 0.4 * trace.penetration, rtol=2e-3)


@pytest.mark.slow
def test_an_elastic_ramp_to_far_beyond_detachment_does_the_work_of_its_curve():
    """The first step of a ramp is a share of the whole ramp, most of which lies beyond the end of contact."""
    retraction = scene_of(Ramp(-0.2, 0.01), start="relaxed", at=0.01, material=SOFT)
    trace = SOLVERS["fem"].solve(retraction, 4)
    expected = SOLVERS["reference"].solve(retraction, 8).external_work[-1]
    assert trace.external_work[-1] == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize(
    "times",
    [
        *(pytest.param((t,), marks=pytest.mark.slow) for t in (1e-9, 1e9)),
        tuple(10.0**k for k in range(-8, 9, 2)),
    ],
)
def test_relaxation_times_over_many_decades(times):
    material = Material(0.75, 0.5, tuple(Branch(3.0 / len(times), t) for t in times))
    trace = run(Ramp(0.022, 0.01), Ramp(-0.3, 0.01), material=material)
    assert trace.outcome.finished
    # a fast solid creeps through the instability of its relaxed state, down to the process zone
    fast = times == (1e-9,)
    assert trace.outcome.kind is (OutcomeKind.BELOW_ZONE if fast else OutcomeKind.DETACHED)
    assert is_finite(trace)
    if len(times) == 1 and times[0] < 1.0:
        assert -trace.force.min() / JKR == pytest.approx(1.027, rel=3e-3)
    assert -trace.force.min() / JKR > 1.0


def test_penetration_under_a_force_bends_within_steps():
    """Against Lee and Radok's dual: straight steps end 1.9e-4 off.

    Where radii of a node have the depth of all of it, the edge swings between two nodes without end.
    """
    creeping = load("cone-force-ramp").scene
    trace = solve(creeping, SOLVERS["fem"].mesh(creeping), Options(max_steps=250))

    def square(time):
        after = max(time, 0.0)
        return float(lee_radok.radius_under_force_ramp(creeping.material, creeping.indenter, 1.0, after)) ** 2

    end = trace.time[-1]
    radius = math.sqrt(0.2 * square(end) - 0.18 * square(end - 1.0) - 0.02 * square(end - 6.0))
    depth = 0.5 * math.pi * radius / math.tan(math.radians(60.0))
    assert trace.penetration[-1] == pytest.approx(depth, rel=1e-4)
    assert trace.contact_radius[-1] == pytest.approx(radius, rel=1.5e-4)
    assert trace.outcome.kind is OutcomeKind.COMPLETED


def test_a_prescribed_penetration_bends_within_steps():
    """Against the convolution under a punch: straight steps are 1.8e-4 of the largest force off."""
    oscillating = Loading("relaxed", 0.02, (Oscillate(0.0015, 1.4, 20.0),))
    asked = Scene(RUBBER, FlatPunch(0.5), oscillating)
    trace = solve(asked, SOLVERS["fem"].mesh(asked))
    force = 0.02 + punch_oscillation.force(RUBBER, 0.5, 1.4, 0.0015, trace.time)
    assert np.abs(trace.force - force).max() < 3e-5 * force.max()


def test_contact_of_a_blunt_tip_grows_in_every_step_under_a_growing_force():
    """The residual of ``r^100`` is far steeper between two places than at its root."""
    loading = Loading("jump-in", 0.0, (ForceRamp(0.01, 0.01),))
    asked = Scene(RUBBER, PowerLaw(100.0, 1.0), loading)
    trace = solve(asked, SOLVERS["fem"].mesh(asked))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert np.diff(trace.contact_radius).min() > 1e-6 * trace.contact_radius[-1]


def test_contact_in_a_part_of_the_first_element_is_as_wide_as_hertz_says():
    """Where radii of a node had the depth of all of it, it was up to 17 times as wide."""
    asked = Scene(RUBBER, Sphere(1.0), Loading("jump-in", 0.0, (ForceRamp(1e-9, 1.0), ForceRamp(1.0, 1.0))))
    trace = solve(asked, SOLVERS["fem"].mesh(asked))
    early = (trace.time > 0.0) & (trace.time < 1e-2 * RUBBER.branches[0].time)
    hertz = np.cbrt(0.75 * trace.force[early] / RUBBER.glassy_plane_modulus)
    assert np.all(np.abs(trace.contact_radius[early] / hertz - 1.0) < 0.15)
    assert trace.counters.steps < 250


@pytest.mark.parametrize("steps", [(Force(1e-7, 1.0),), (ForceRamp(1e-7, 1e-2),)])
def test_radii_that_stay_in_contact_take_no_strain_from_the_depth_of_their_node(steps):
    """A force that drops on a glass: with such a strain the radius was 7 % too small."""
    glass = Material(1e3, 0.5, (Branch(3e6, 1e-2),))
    asked = Scene(glass, Sphere(1e-4), Loading("jump-in", 0.0, (Force(1e-5, 10.0), *steps)))
    trace = solve(asked, SOLVERS["fem"].mesh(asked))
    assert trace.contact_radius[trace.time <= 10.002][-1] == pytest.approx(1.7784e-5, rel=3e-4)


@pytest.mark.slow
def test_an_adhering_edge_goes_by_the_depth_of_nodes_that_its_closure_sees():
    """With the depth of the part of a node in contact, the radius is off by 4.9e-4 of the largest."""
    asked = load("force-4").scene
    reference, trace = (SOLVERS[name]._solve(asked, None, RunOptions()) for name in ("reference", "fem"))
    among = windows(asked.loading, reference)
    assert distance(trace, reference, "contact_radius", among).rms < 3.7e-4


def test_options_are_checked():
    for wrong in ({"tolerance": 2.0}, {"max_steps": 0}):
        with pytest.raises(SceneError, match=next(iter(wrong))):
            Options(**wrong)


@pytest.mark.slow
def test_separate_relaxation_runs_a_whole_cycle_on_any_domain():
    material = Material(0.91, 0.3, (Branch(8.19, 1.0),), bulk="elastic")
    scene = cycle_scene(0.02, material=material)
    traces = [solve(scene, EdgeMeshes(ZONE, 4, 0.26, domain_ratio=ratio)) for ratio in (20.0, 400.0)]
    for trace in traces:
        assert trace.outcome.kind is OutcomeKind.DETACHED
        work = np.abs(trace.external_work).max()
        assert np.abs(trace.extra["balance_residual"]).max() < 1e-3 * work
    near, wide = (-trace.force.min() / JKR for trace in traces)
    assert near == pytest.approx(wide, rel=1e-3)
    assert loop(traces[0]) == pytest.approx(loop(traces[1]), rel=1e-3)
    # glassier in shear than in bulk: not the cycle of a constant Poisson's ratio
    assert abs(wide / 4.300 - 1.0) > 1e-2


def test_a_contact_far_smaller_than_its_loading_tells_has_a_mesh_of_its_own():
    """A force that is above its level from the start: the ramp might go on to 40 radii of contact."""
    loading = Loading("jump-in", 0.01, (Ramp(1.0, 1e-3, until_force=1.3e-3), Ramp(-0.1, 0.1)))
    material = Material(0.75, 0.5, (Branch(6.75, 1e-2),))
    scene = Scene(material, Cone(85.0), loading)
    for trace in (SOLVERS["fem"].solve(scene), record_fields(scene, FieldRequest((0.0,))).recording.trace):
        borne = sneddon.force(Cone(85.0), trace.contact_radius[0], 10.0)
        assert trace.force[0] == pytest.approx(borne, rel=1e-3)
