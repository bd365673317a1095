"""Scenes at the ends of the allowed range end with an answer, an error of the scene or a reason."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.closed_forms.force_of_history import force_of_history
from support.paper_scenes import ELASTIC, ONE, STICKY, WORK

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
    Step,
    Sweep,
    Table,
    TabulatedProfile,
)
from contact_scene.errors import SceneError
from validation.cases import load
from validation.reference import prony_integrals, sneddon
from validation.reference.finite_zone import FiniteZone
from validation.reference.path.solver import Options, solve
from validation.reference.ting import Ting

COARSE = Options(resolution=4)


def _scene(*steps: Step, start: str = "relaxed", material: Material = ONE, zone: float = 0.0) -> Scene:
    adhesion = Adhesion(WORK, zone) if zone > 0.0 else None
    return Scene(material, Sphere(1.0), Loading(start, 0.032, steps), adhesion)


def test_a_hold_of_any_length_ends_in_the_relaxed_equilibrium() -> None:
    trace = solve(_scene(Hold(1e60), start="jump-in", zone=STICKY.zone), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    exact = FiniteZone(1.0, 1.0, WORK, STICKY.zone).at_penetration(0.032)
    assert trace.contact_radius[-1] == pytest.approx(exact.contact_radius, rel=1e-5)
    assert trace.force[-1] == pytest.approx(exact.force, rel=1e-5)


def test_a_branch_that_relaxes_in_no_time_is_none() -> None:
    fast = Material(0.75, 0.5, (Branch(6.75, 1e-60),))
    trace = solve(_scene(Ramp(0.02, 0.01), start="jump-in", material=fast, zone=0.05), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    exact = FiniteZone(1.0, 1.0, WORK, 0.05).at_penetration(0.02)
    assert trace.force[-1] == pytest.approx(exact.force, rel=1e-4)


def test_a_step_shorter_than_the_rounding_of_time_is_out_of_range() -> None:
    """What the run has done before is kept."""
    trace = solve(_scene(Hold(1e17), Ramp(-0.5, 0.02)), COARSE)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert "rounding of the time" in trace.outcome.reason
    assert trace.time[-1] == 1e17


@pytest.mark.parametrize(("zone", "problem"), [(1e9, "longer than the contact"), (1e-12, "rounding")])
def test_a_zone_out_of_proportion_is_an_error_of_the_scene(zone: float, problem: str) -> None:
    with pytest.raises(SceneError, match=problem) as error:
        solve(_scene(Ramp(-0.5, 0.02), zone=zone), COARSE)
    assert error.value.key == "adhesion.zone"


def test_what_overflows_is_out_of_range() -> None:
    flat = Scene(ELASTIC, PowerLaw(2.0, 1e-300), Loading("relaxed", 0.032, (Ramp(0.0, 0.02),)))
    trace = solve(flat)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert len(trace) == 0
    stiff = Material(1e60, 0.5)
    pressed = Scene(stiff, PowerLaw(2.0, 1e55), Loading("relaxed", 0.0, (Force(1e60, 1.0),)))
    trace = solve(pressed, COARSE)
    assert all(np.isfinite(column).all() for column in trace.columns().values())


@pytest.mark.slow
def test_collapse_of_a_rated_edge_within_the_rounding_of_time() -> None:
    """An unlimited law of a small power: the speed is the ninth power of the drive, too fast for any step."""
    loading = Loading("relaxed", 5.584e-7, (Ramp(3.068e-6, 0.2583), Hold(1.091e-5), Ramp(-1.227e-5, 0.234)))
    adhesion = Adhesion(0.004124, 4.449e-9, 7.299e-4, PowerRate(1.3404e-4, 0.114))
    question = Scene(Material(105000.0, 0.49), FlatPunch(1.60631e-05), loading, adhesion)
    trace = solve(question)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE, trace.outcome
    at_once = np.flatnonzero(np.diff(trace.time) == 0.0)
    assert at_once[-1] == trace.time.size - 2
    assert trace.contact_radius[at_once[0]] > 0.04 * trace.contact_radius.max()
    assert trace.counters.rejected_steps < 500  # it rejected a thousand and went on


@pytest.mark.slow
def test_a_limited_law_has_limit_points() -> None:
    """Beyond its bound no speed balances the edge: contact is lost at fixed time, as by the others."""
    moduli = ((1.41, 0.00772), (13.2, 1.31), (3.36, 546.0), (13.5, 0.00503), (3.74, 0.184), (1.25, 0.0529))
    depths = (0.0232544, 0.0648284, 0.009802, 0.0643552, 0.0616512)
    loading = Loading("relaxed", depths[0], (Table((0.0, 0.692, 0.7403, 1.1613, 1.1918), depths),))
    rate = RateTable((16.149, 1614.9), (7.4326e-5, 1.87793e-4))
    adhesion = Adhesion(3.95353e-5, 0.004186, rate=rate)
    material = Material(1.0, 0.5, tuple(Branch(*one) for one in moduli))
    question = Scene(material, Sphere(1.0), loading, adhesion)
    assert np.isfinite(adhesion.opening(np.inf))
    trace = solve(question, Options(resolution=8))
    assert trace.outcome.kind is OutcomeKind.DETACHED, trace.outcome
    assert trace.events[-1].kind == "pull-off"
    assert trace.events[-1].contact_radius == pytest.approx(0.05622, rel=5e-3)  # 13 zones: bem has the same
    assert trace.events[-1].contact_radius > 10.0 * adhesion.zone


DEPTH, SPEED = 0.032, 0.003
TIME = DEPTH / SPEED
OFF = Ramp(-0.5 * DEPTH, SPEED)
PRESS = Ramp(DEPTH, SPEED)
HARDEST, FASTER = 0.01, 0.01 / TIME
SINE = np.linspace(0.0, 0.5 * math.pi, 9)
SMOOTH = Table(tuple(SINE / SINE[-1] * TIME), tuple(DEPTH * np.sin(SINE) ** 2), interpolation="cubic")
FORCE_TABLE = Table((0.0, 0.5 * TIME, TIME), (0.0, 0.2 * HARDEST, HARDEST), quantity="force")
SHAPES = {
    "sphere": Sphere(1.0),
    "cone": Cone(80.0),
    "punch": FlatPunch(0.1),
    "blunt": PowerLaw(4.0, 2.0),
    "profile": TabulatedProfile((0.0, 0.05, 0.1, 0.2, 0.4), (0.0, 0.001, 0.005, 0.02, 0.1)),
}
PROGRAMMES: dict[str, Loading] = {
    "ramp": Loading("jump-in", 0.0, (PRESS, OFF)),
    "from above": Loading("relaxed", -0.3 * DEPTH, (PRESS, OFF)),
    "hold": Loading("relaxed", 0.0, (PRESS, Hold(0.5 * TIME), OFF)),
    "reload": Loading("relaxed", 0.0, (Ramp(0.6 * DEPTH, SPEED), Ramp(0.4 * DEPTH, SPEED), PRESS, OFF)),
    "table": Loading("relaxed", 0.0, (SMOOTH, OFF)),
    "oscillation": Loading("relaxed", 0.0, (PRESS, Oscillate(0.05 * DEPTH, 3.0 / TIME, 3.0 * TIME), OFF)),
    "sweep": Loading("relaxed", 0.0, (PRESS, Sweep(0.05 * DEPTH, 5.0 / TIME**2, TIME), OFF)),
    "approach": Loading("relaxed", -0.3 * DEPTH, (Ramp(DEPTH, SPEED, until_force=0.1 * HARDEST), OFF)),
    "spring": Loading("relaxed", 0.0, (PRESS, OFF), Machine(1.0)),
    "spring from above": Loading("relaxed", -0.3 * DEPTH, (PRESS, OFF), Machine(1.0)),
    "force": Loading("relaxed", 0.0, (ForceRamp(HARDEST, FASTER), ForceRamp(-0.1 * HARDEST, FASTER))),
    "force from above": Loading(
        "relaxed", -0.3 * DEPTH, (ForceRamp(HARDEST, FASTER), ForceRamp(0.0, FASTER))
    ),
    "dead load": Loading("relaxed", 0.0, (Force(HARDEST, TIME), ForceRamp(0.0, FASTER))),
    "force table": Loading("relaxed", 0.0, (FORCE_TABLE, ForceRamp(0.0, FASTER))),
}


FORCES = {
    "force": [(0.0, FASTER)],
    "force from above": [(0.0, FASTER)],
    "dead load": [],
    "force table": [(0.0, 0.4 * FASTER), (0.5 * TIME, 1.2 * FASTER)],
}
"""Changes of the rate of the force, by the programmes that prescribe one."""


def _material(shortest: float, branches: int = 1, spread: float = 1.0) -> Material:
    """Ten times as stiff as a glass; its times from ``shortest`` on, each ``spread`` times the one before."""
    times = [shortest * spread**k for k in range(branches)]
    return Material(0.75, 0.5, tuple(Branch(6.75 / branches, time) for time in times))


def _check_press(material: Material, shape: str, name: str) -> None:
    """A contact that grows is that of Lee and Radok; it reaches the load asked for, and is lost after it."""
    indenter, loading = SHAPES[shape], PROGRAMMES[name]
    trace = solve(Scene(material, indenter, loading), Options(tolerance=1e-3))
    assert trace.outcome.kind is OutcomeKind.DETACHED, trace.outcome
    depth, force, radius = trace.penetration, trace.force, trace.contact_radius
    receding = np.append(np.flatnonzero(np.diff(radius) < -1e-9 * radius.max()), len(radius) - 1)
    growing = np.arange(len(radius)) <= receding[0]
    if name in ("oscillation", "sweep"):  # rows of swings are farther apart than this asks for
        growing &= trace.time <= TIME
    grown = np.flatnonzero(growing & (radius > 0.0))
    if shape != "punch":
        reached = np.maximum.accumulate(depth)[grown]
        assert sneddon.depth(indenter, radius[grown]) == pytest.approx(reached, abs=4e-4 * DEPTH)
    first, time = loading.steps[0], trace.time[grown]
    if name in FORCES:
        assert force[grown].max() == pytest.approx(HARDEST, rel=1e-6)
        crept = sum(
            prony_integrals.creep_integral(material, np.maximum(time - begin, 0.0)) * more
            for begin, more in FORCES[name]
        )
        if isinstance(first, Force):
            crept = HARDEST * prony_integrals.creep(material, time)
        taken = sneddon.unit_force(indenter, radius[grown], depth[grown])
        settled = (time >= 0.1 * TIME) & (time <= TIME)  # after it a slow contact may still grow
        assert taken[settled] == pytest.approx(crept[settled], rel=2e-3)
        return
    rows = (column[grown] for column in (trace.time, depth, radius))
    expected = force_of_history(material, indenter, "jump-in", *rows)
    assert force[grown] == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())
    if name == "approach":
        assert force.max() == pytest.approx(0.1 * HARDEST, rel=1e-6)
    elif loading.machine is not None:
        assert (depth + force)[grown].max() == pytest.approx(DEPTH, rel=1e-6)  # on a spring of stiffness 1
    elif name != "reload" or material.branches[-1].time <= 1e-3 * TIME:  # a slow one may be lost between
        assert depth.max() >= DEPTH * (1.0 - 1e-9)


@pytest.mark.parametrize("programme", ["hold", "table", "spring from above", "force"])
def test_a_press_with_a_branch_that_relaxes_at_once(programme: str) -> None:
    """Contact was lost in the first steps, whose stress and force were rounding: force 0, completed."""
    _check_press(_material(1e-9 * TIME), "sphere", programme)


def presses(*shapes: str):
    """Fastest time in decades of the press, branches, ratio of their times, shape and loading."""
    return given(
        st.floats(-12.0, 3.0),
        st.integers(1, 16),
        st.floats(1.0, 10.0),
        st.sampled_from(shapes),
        st.sampled_from([*PROGRAMMES]),
    )


@settings(max_examples=4)
@presses("sphere", "cone", "punch", "blunt")
def test_presses_with_any_times(
    decades: float, branches: int, spread: float, shape: str, programme: str
) -> None:
    _check_press(_material(10.0**decades * TIME, branches, spread), shape, programme)


@pytest.mark.slow
@settings(max_examples=60)
@presses(*SHAPES)
def test_many_presses_with_any_times(
    decades: float, branches: int, spread: float, shape: str, programme: str
) -> None:
    _check_press(_material(10.0**decades * TIME, branches, spread), shape, programme)


@pytest.mark.parametrize("shape", ["sphere", "cone", "punch"])
@pytest.mark.parametrize("shortest", [1e-7, pytest.param(1e-12, marks=pytest.mark.slow)])
def test_the_force_and_the_loss_of_a_fast_press(shape: str, shortest: float) -> None:
    """The press of a sphere that was detached at t = 3.1e-12: 0.00763245, lost at 21.333."""
    material, indenter = _material(shortest), SHAPES[shape]
    trace = solve(Scene(material, indenter, PROGRAMMES["ramp"]))
    exact = Ting(material, indenter, SPEED, TIME, SPEED)
    peak = float(exact.force(TIME))
    if shape == "sphere":
        assert peak == pytest.approx(0.00763245, rel=1e-6)
        assert trace.contact_radius.max() == pytest.approx(0.178885, rel=1e-5)
    assert trace.force.max() == pytest.approx(peak, rel=1e-6)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(exact.detachment(), rel=1e-6)


@pytest.mark.slow
def test_fine_steps_of_a_cone_under_a_rising_force() -> None:
    """At 32 it was detached after five steps; 16 and 20 completed."""
    trace = solve(load("cone-force-ramp").scene, Options(resolution=32))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.contact_radius[-1] == pytest.approx(0.49392095, rel=1e-7)


@pytest.mark.parametrize(("force", "rate"), [(1e-9, 1e-7), (1e-10, 1.0)])
def test_a_first_load_that_is_far_below_the_largest(force: float, rate: float) -> None:
    """A point, which bears no load, was tried as the contact at its end."""
    loading = Loading("jump-in", 0.0, (ForceRamp(force, rate), ForceRamp(1.0, 1.0)))
    trace = solve(Scene(ELASTIC, Sphere(1.0), loading), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    hertz = np.cbrt(0.75 * trace.force / ELASTIC.relaxed_plane_modulus)
    assert np.allclose(trace.contact_radius, hertz, rtol=0.0, atol=1e-5 * hertz[-1])


def test_a_tip_that_is_far_smaller_than_the_unit_of_length() -> None:
    """The largest contact of a tip of microns was sought from one metre on, where its table was rounding."""
    gel = Material(2e4, 0.5, (Branch(3e4, 0.01), Branch(2e4, 1.0), Branch(1e4, 100.0)))
    tip = TabulatedProfile((0.0, 1e-5, 2e-5, 1e-4), (0.0, 1e-6, 1.2e-5, 2e-5))
    loading = Loading("jump-in", 0.0, (Ramp(1.9e-5, 1.9e-5), Ramp(-1.9e-5, 1.9e-5)))
    trace = solve(Scene(gel, tip, loading), COARSE)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    deepest = int(np.argmax(trace.penetration))
    assert sneddon.depth(tip, trace.contact_radius[deepest]) == pytest.approx(1.9e-5, rel=1e-4)


def test_an_edge_that_comes_back_is_sought_no_closer_than_its_surface_is_known() -> None:
    """What it had left behind was off by a thousand times what the steps after the turn were to be off by."""
    gel = Material(2e4, 0.5, (Branch(3e4, 0.01), Branch(2e4, 1.0), Branch(1e4, 100.0)))
    loading = Loading("jump-in", 0.0, (Ramp(1e-4, 1e-4), Oscillate(2e-5, 6.0, 5.0)))
    trace = solve(Scene(gel, Sphere(1e-3), loading), Options(resolution=32))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.counters.steps < 1100


@pytest.mark.parametrize("exponent", [50.0, 100.0])
def test_the_first_contact_of_a_blunt_tip(exponent: float) -> None:
    """A tenth of the largest radius was deep enough to begin with: 1e-50 of the largest penetration."""
    loading = Loading("jump-in", 0.0, (Ramp(0.05, 0.02), Ramp(-0.05, 0.02)))
    tip = PowerLaw(exponent, 0.02 / 0.2**exponent)
    trace = solve(Scene(ONE, tip, loading), COARSE)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    deepest = int(np.argmax(trace.penetration))
    assert trace.contact_radius[deepest] == pytest.approx(sneddon.contact_radius(tip, 0.05), rel=1e-6)


@pytest.mark.parametrize("slower", [1e-6, 1.0])
@pytest.mark.parametrize("part", [1e-9, 1e-10])
def test_a_first_ramp_that_is_far_below_the_deepest(part: float, slower: float) -> None:
    """The first step of a contact was to end deeper than the ramp does, at a radius where there is none."""
    steps = Ramp(0.05 * part, 0.02 * slower), Hold(1.0), Ramp(0.05, 0.02), Ramp(-0.1, 0.02)
    trace = solve(Scene(ONE, Sphere(1.0), Loading("jump-in", 0.0, steps)), COARSE)
    exact = Ting(ONE, Sphere(1.0), 0.02, 2.5, 0.02)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    begun = 1.0 + 2.5 * part / slower
    assert trace.force.max() == pytest.approx(float(exact.force(2.5)), rel=1e-4)
    assert trace.time[-1] - begun == pytest.approx(exact.detachment(), rel=1e-4)


@pytest.mark.parametrize(("above", "tiny"), [(0.01, 1e-12), (0.01, 1e-10), (1.0, 5e-11), (1.0, 1e-11)])
def test_a_first_ramp_from_above_that_ends_right_below_the_surface(above: float, tiny: float) -> None:
    """A first step was told by the way of its leg in the air, and ended deeper than the leg does."""
    steps = Ramp(-above, 0.02), Ramp(tiny, 0.02), Hold(1.0), Ramp(0.05, 0.02), Ramp(-0.1, 0.02)
    trace = solve(Scene(ELASTIC, Sphere(1.0), Loading("jump-in", 0.0, steps)), COARSE)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    hertz = 4.0 / 3.0 * ELASTIC.relaxed_plane_modulus * 0.05**1.5
    assert trace.force.max() == pytest.approx(hertz, rel=1e-5)


def test_a_load_step_has_a_time_of_its_own() -> None:
    """After a slow load step the times of a quick one rounded: its budget was spent in a millionth of it."""
    steps = ForceRamp(1e-8, 1e-12), ForceRamp(0.01, 0.01)
    trace = solve(Scene(ONE, Sphere(1.0), Loading("jump-in", 0.0, steps)), replace(COARSE, max_steps=1000))
    quick = solve(Scene(ONE, Sphere(1.0), Loading("jump-in", 0.0, steps[1:])), COARSE)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.contact_radius[-1] == pytest.approx(quick.contact_radius[-1], rel=1e-4)
