"""Load steps, triggers, approach and machine: ends are exact, rates are derivatives, kinks are declared."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.scene_text import GOOD

import contact_scene as cs
from contact_scene.machine import machine_columns

STEPS = [
    cs.Ramp(to=0.3, rate=0.07),
    cs.Ramp(to=-0.3, rate=0.07),
    cs.Hold(duration=2.5),
    cs.Force(value=-0.2, duration=2.5),
    cs.ForceRamp(to=0.9, rate=0.3),
    cs.ForceRamp(to=-0.9, rate=0.3),
    cs.Oscillate(amplitude=0.1, angular_frequency=3.0, duration=2.5, drift=0.01),
    cs.Sweep(amplitude=0.1, chirp=0.7, duration=2.5),
    cs.Table(times=(5.0, 5.5, 7.0, 7.25), values=(0.4, 0.1, 0.1, -0.2)),
]


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.kind)
def test_rate_is_the_derivative_between_kinks(step):
    segment = step.segment(1.7, 0.1, 0.05)
    ends = [segment.start, *segment.kinks, segment.end]
    for low, high in pairwise(ends):
        for part in (0.1, 0.5, 0.9):
            at, h = low + part * (high - low), 1e-6 * (high - low)
            slope = (segment.value(at + h) - segment.value(at - h)) / (2 * h)
            assert segment.rate(at) == pytest.approx(slope, rel=1e-6, abs=1e-9)
        right = (segment.value(low + 1e-7) - segment.value(low)) / 1e-7
        assert segment.rate(low) == pytest.approx(right, rel=1e-5, abs=1e-6)


def test_how_long_a_load_rests():
    """A quarter of the first cycle of a sweep, half a cycle of an oscillation."""
    rests = {step.kind: step.longest_rest for step in STEPS}
    resting = {kind: rest for kind, rest in rests.items() if rest > 0.0}
    expected = {"hold": 2.5, "force": 2.5, "oscillate": math.pi / 3.0, "sweep": math.sqrt(math.pi / 0.7)}
    assert resting == pytest.approx(expected)


numbers = st.floats(-1e6, 1e6)


@given(numbers, numbers, numbers, st.floats(1e-6, 1e6))
def test_ramps_start_and_end_exactly_and_stay_between(start, here, there, rate):
    for segment in (
        cs.Ramp(there, rate).segment(start, here, 0.0),
        cs.ForceRamp(there, rate).segment(start, 0.0, here),
    ):
        if segment.end > start:
            assert segment.value(start) == here
            assert abs(segment.rate(start)) == pytest.approx(
                abs(there - here) / (segment.end - start), rel=1e-12
            )
        assert segment.value(segment.end) == there
        slack = 1e-15 * max(abs(here), abs(there))
        for part in (0.25, 0.5, 1.0 - 1e-9):
            value = segment.value(start + part * (segment.end - start))
            assert min(here, there) - slack <= value <= max(here, there) + slack


def test_duration_lost_in_a_late_start():
    """A step shorter than the spacing of floats at its start is a jump to its end."""
    assert cs.Ramp(to=1e-9, rate=1.0).segment(1e9, 0.0, 0.0).value(1e9) == 1e-9
    table = cs.Table((0.0, 1e-9, 2e-9), (0.0, 1.0, 2.0)).segment(1e9, 0.0, 0.0)
    assert (table.start, table.end, table.kinks, table.value(1e9), table.rate(1e9)) == (
        1e9,
        1e9,
        (),
        2.0,
        0.0,
    )
    partly = cs.Table((0.0, 1e-9, 1.0, 2.0), (0.0, 1.0, 2.0, 0.0)).segment(1e9, 0.0, 0.0)
    assert (partly.value(1e9), partly.kinks, partly.value(1e9 + 1.5)) == (1.0, (1e9 + 1.0,), 1.0)


# The machine, and approaches

K = 0.5


def read(tmp_path, text):
    (tmp_path / "scene.toml").write_text(text)
    return cs.read_scene(tmp_path / "scene.toml")


def with_steps(*entries):
    """The good scene with other load steps."""
    return GOOD[: GOOD.index("[[loading.steps]]")] + "\n".join(f"[[loading.steps]]\n{e}" for e in entries)


def test_machine_is_read_and_written(tmp_path):
    scene = read(tmp_path, GOOD + "\n[machine]\nstiffness = 2\n")
    assert scene.machine == cs.Machine(2.0)
    assert read(tmp_path, GOOD).machine is None
    assert read(tmp_path, GOOD + "\n[machine]\nstiffness = inf\n").loading.compliance == 0.0
    cs.write_scene(scene, tmp_path / "again.toml")
    assert cs.read_scene(tmp_path / "again.toml") == scene


def test_steps_drive_the_stage_of_a_spring_and_forces_the_indenter():
    loading = cs.Loading(
        "relaxed", 0.1, (cs.Ramp(1.0, 0.5), cs.ForceRamp(0.2, 1.0), cs.Hold(2.0)), cs.Machine(K)
    )
    ramp, pull, hold = (loading.segment(step, 3.0, 0.1, 0.2) for step in loading.steps)
    assert (ramp.control, pull.control, hold.control) == ("stage", "force", "stage")
    assert ramp.value(3.0) == pytest.approx(0.1 + 0.2 / K)
    assert ramp.end == pytest.approx(3.0 + (1.0 - 0.5) / 0.5)
    assert hold.value(4.0) == ramp.value(3.0)
    assert ramp.present(0.3, 0.1) == pytest.approx(0.5)
    assert pull.present(0.3, 0.1) == 0.1
    rigid = replace(loading, machine=cs.Machine(math.inf)).segment(loading.steps[0], 3.0, 0.1, 0.2)
    assert (rigid.control, rigid.value(3.0), rigid.compliance) == ("penetration", 0.1, 0.0)


def test_what_a_loading_knows_before_a_run():
    known = [s.end for _, s in cs.Loading("relaxed", 0.0, (cs.Ramp(1.0, 1.0), cs.Hold(1.0))).segments()]
    assert known == [1.0, 2.0]
    sprung = cs.Loading("relaxed", 0.0, (cs.Ramp(1.0, 1.0), cs.Hold(1.0)), cs.Machine(K))
    ends = [s.end - s.start for _, s in sprung.segments(own_time=True)]
    assert math.isnan(ends[0])  # the force of the start state is not known, and the stage with it
    assert ends[1:] == [1.0]
    unknown = cs.Loading("relaxed", 0.1, (cs.Force(-0.2, 2.0), cs.Ramp(0.5, 0.1))).segments()
    assert math.isnan([segment.end for _, segment in unknown][1])  # where the force has led, a run knows
    until = cs.Loading("relaxed", 0.0, (cs.Ramp(1.0, 1.0, until_force=0.5), cs.ForceRamp(0.0, 0.25)))
    (_, press), (_, release) = until.segments()
    assert press.end == 1.0
    assert math.isnan(release.start)
    assert release.control == "force"
    assert math.isnan(release.value(release.end))
    knowing = until.segments(lambda step: (0.1, 0.5), own_time=True)
    assert [segment.end for _, segment in knowing] == [0.9, 2.0]


def test_triggers_are_reached_from_either_side_and_at_once():
    ramp = cs.Ramp(1.0, 1.0, until_force=0.5).segment(0.0, 0.0, 0.0)
    assert ramp.trigger == cs.Trigger("force", 0.5)
    for before, within, beyond in ((0.1, 0.49, 0.51), (0.9, 0.51, 0.49)):
        cursor = cs.LoadingCursor()
        assert not cursor.triggered(ramp, 0.0, before, 0.0)
        assert not cursor.triggered(ramp, 0.0, within, 0.0)
        assert cursor.triggered(ramp, 0.0, beyond, 0.0)
        cursor.step_done()
        assert cursor.trigger_side is None
    assert cs.LoadingCursor().triggered(ramp, 0.0, 0.5 * (1.0 + 1e-12), 0.0)
    creep = cs.Force(1.0, 2.0, until_penetration=0.3).segment(0.0, 0.0, 0.0)
    cursor = cs.LoadingCursor()
    assert [cursor.triggered(creep, depth, 1.0, 0.0) for depth in (0.1, 0.29, 0.31)] == [False, False, True]
    wide = cs.Ramp(1.0, 1.0, until_radius=0.2).segment(0.0, 0.0, 0.0)
    assert wide.trigger is not None
    assert wide.trigger.excess(0.0, 0.0, 0.3) == pytest.approx(0.1)


def test_approach_stands_for_ramp_hold_ramp(tmp_path):
    entry = 'kind = "approach"\nrate = 2\nforce = 0.5\nto = 3\ndwell = 4\nretract = 0.1'
    expected = (cs.Ramp(3.0, 2.0, until_force=0.5), cs.Hold(4.0), cs.Ramp(-3.0, 0.1))
    scene = read(tmp_path, with_steps(entry))
    assert scene.loading.steps == expected
    assert cs.Loading("relaxed", 0.0, (cs.Approach(2.0, 0.5, 3.0, away=1.0),)).steps == (
        cs.Ramp(3.0, 2.0, until_force=0.5),
        cs.Ramp(1.0, 2.0),
    )
    cs.write_scene(scene, tmp_path / "again.toml")
    assert cs.read_scene(tmp_path / "again.toml") == scene


def bound(*steps, indenter=None, work=0.0, material=None, machine=None):
    """Where the last ramp to a force ends at most, in a scene whose approach says nothing of it."""
    adhesion = cs.Adhesion(work, 0.01) if work else None
    loading = cs.Loading("relaxed", 0.01, steps, machine)
    scene = cs.Scene(material or cs.Material(0.75, 0.5), indenter or cs.Sphere(2.0), loading, adhesion)
    return [step.to for step in scene.loading.steps if step.trigger is not None][-1]


def test_an_approach_without_a_bound_gets_that_of_twice_the_force():
    """Hertz, Sneddon's cone and the flat punch with ``E* = 1``, ``R = 2``, by hand."""
    until = cs.Approach(1.0, 0.3)
    hertz = (0.6 * 3.0 * 2.0 / 4.0) ** (2.0 / 3.0) / 2.0
    assert bound(until) == pytest.approx(hertz, rel=1e-12)
    assert bound(until, machine=cs.Machine(K)) == pytest.approx(hertz + 0.3 / K, rel=1e-12)
    begun = 4.0 / 3.0 * math.sqrt(2.0) * 0.01**1.5  # of the start, at D = 0.01: the stage is there already
    small = bound(cs.Approach(1.0, 1e-6), machine=cs.Machine(1e-3))
    assert small == pytest.approx(0.01 + begun / 1e-3, rel=1e-12)
    assert bound(until, indenter=cs.PowerLaw(2.0, 0.25)) == pytest.approx(hertz, rel=1e-12)
    slope = math.tan(math.radians(20.0))
    cone = math.sqrt(0.6 * math.pi * slope / 2.0)
    assert bound(until, indenter=cs.Cone(70.0)) == pytest.approx(cone, rel=1e-12)
    assert bound(until, indenter=cs.FlatPunch(0.5)) == pytest.approx(0.6, rel=1e-12)
    assert bound(cs.Ramp(7.0, 1.0), cs.Ramp(0.0, 1.0), until) == 7.0
    assert bound(cs.Oscillate(3.0, 1.0, 4.0, -1.0), until) == pytest.approx(0.01 + 3.0 + 4.0)
    assert bound(cs.Table((0.0, 1.0, 2.0), (0.0, 5.0, 0.0)), until) == 5.0
    ramp, back = cs.Scene(
        cs.Material(0.75, 0.5), cs.Sphere(2.0), cs.Loading("relaxed", 0.0, (until,))
    ).loading.steps
    assert (ramp.until_force, back.to) == (0.3, -ramp.to)


def test_the_bound_of_a_tension_grows_with_work_and_glass():
    """``D^2 = 8 pi w a/E0* * 2 (Einf/E0) 3/4`` on a sphere, which any pull of a glass stays below."""
    glassy = cs.Material(0.75, 0.5, (cs.Branch(0.75 * 9.0, 1.0),))
    for material, ratio in ((None, 1.0), (glassy, 10.0)):
        depth = bound(cs.Approach(1.0, -1e-3), work=0.1, material=material)
        radius = math.sqrt(2.0 * depth)
        assert depth**2 == pytest.approx(8.0 * math.pi * 0.1 * radius * 1.5 * ratio, rel=1e-12)
    assert bound(cs.Approach(1.0, -1.0), indenter=cs.FlatPunch(0.5), work=0.1) == pytest.approx(
        math.sqrt(2.0 * math.pi * 0.51 * 0.1), rel=1e-12
    )


@pytest.mark.parametrize("to", [None, 0.1])
def test_a_retraction_ends_where_no_contact_is_left(to):
    """``E0* u = sqrt(2 pi (a + da) w Einf*)`` by hand."""

    def away(indenter, machine=None, ratio=100.0, work=1.0):
        material = cs.Material(0.75, 0.5, (cs.Branch(0.75 * (ratio - 1.0), 1.0),))
        loading = cs.Loading("relaxed", 0.0, (cs.Approach(1.0, 0.01, to),), machine)
        scene = cs.Scene(material, indenter, loading, cs.Adhesion(work, 0.01) if work else None)
        return scene.loading.steps[-1].to, scene.loading.steps[0].to

    lifted = math.sqrt(2.0 * math.pi * 0.51 * 100.0)
    assert away(cs.FlatPunch(0.5))[0] == pytest.approx(-lifted, rel=1e-12)
    assert away(cs.FlatPunch(0.5), cs.Machine(K))[0] == pytest.approx(-lifted * (1.0 + 1.0 / K), rel=1e-12)
    found, reached = away(cs.Sphere(2.0), ratio=1.0, work=1e-3)
    radius = 2.0 * max(math.sqrt(2.0 * reached), 2.0 * (8.0 * math.pi * 1e-3 * 16.0 / 4.0) ** (1.0 / 3.0))
    assert -found == pytest.approx(max(reached, math.sqrt(2.0 * math.pi * (radius + 0.01) * 1e-3)), rel=1e-12)
    found, reached = away(cs.Sphere(2.0), work=0.0)
    assert found == -reached


def test_cubic_table_has_no_kinks_and_no_extremum_between_rows(tmp_path):
    times, values = (0.0, 1.0, 2.0, 3.5, 4.0), (0.0, 1.0, 1.0, 0.2, 0.3)
    linear, cubic = (
        cs.Table(times, values, interpolation=how).segment(10.0, 0.0, 0.0) for how in ("linear", "cubic")
    )
    assert linear.kinks == (11.0, 12.0, 13.5)
    assert (cubic.kinks, cubic.linear) == ((), False)
    assert [cubic.value(10.0 + t) for t in times] == pytest.approx(values)
    nearly = cs.Table((0.0, 1.0, 2.0, 3.0), (0.0, 1e-310, 3e-310, 1.0), interpolation="cubic")
    assert 0.0 < nearly.segment(0.0, 0.0, 0.0).value(2.5) < 1.0  # without a warning
    assert cubic.value(cubic.end) == values[-1]
    between = [cubic.value(t) for t in np.linspace(11.0, 12.0, 20)]
    assert between == pytest.approx([1.0] * 20)
    for t in (10.3, 12.7, 13.6):
        assert cubic.rate(t) == pytest.approx(
            (cubic.value(t + 1e-6) - cubic.value(t - 1e-6)) / 2e-6, rel=1e-6
        )
    (tmp_path / "t.csv").write_text("time,force\n0,0\n1,2\n3,1\n")
    entry = 'kind = "table"\nfile = "t.csv"\nquantity = "force"\ninterpolation = "cubic"'
    scene = read(tmp_path, with_steps(entry))
    assert scene.loading.steps == (cs.Table((0.0, 1.0, 3.0), (0.0, 2.0, 1.0), "", "force", "cubic"),)
    assert scene.loading.steps[0].segment(0.0, 0.0, 0.0).control == "force"
    cs.write_scene(scene, tmp_path / "again.toml")
    assert cs.read_scene(tmp_path / "again.toml") == scene


def test_energies_of_machine_and_losses_of_instabilities():
    """Two rows before a snap at constant stage, two after it: the balance closes over the snap."""
    force = np.array([0.2, -0.3, 0.0, 0.0])
    depth = np.array([0.1, 0.0, -0.3 / K, -1.0])
    work = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(depth))))
    rows = {
        "time": np.array([0.0, 1.0, 1.0, 2.0]),
        "penetration": depth,
        "force": force,
        "contact_radius": np.array([0.3, 0.2, 0.0, 0.0]),
        "external_work": work,
        "dissipated_energy": np.array([0.0, 0.01, 0.11, 0.12]),
    }
    found = machine_columns(rows, cs.Machine(K), [cs.Event("pull-off", 1.0, 0.0, -0.3, 0.2)])
    assert found["stage"] == pytest.approx([0.5, -0.6, -0.6, -1.0])
    assert found["machine_energy"] == pytest.approx([0.04, 0.09, 0.0, 0.0])
    assert found["instability_loss"] == pytest.approx([0.0, 0.0, 0.1, 0.1])
    along_stage = np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(found["stage"]))
    assert found["external_work"][1:] == pytest.approx(along_stage, abs=1e-15)
