"""Observables on traces whose numbers are known by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from contact_scene import (
    Counters,
    Event,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Oscillate,
    Outcome,
    OutcomeKind,
    Ramp,
    Trace,
)
from contact_scene.run_control import below_zone_outcome
from validation.cases import load
from validation.measure.curves import distance, parting_time
from validation.measure.events import end_of_approach, is_located
from validation.measure.observables import at_last_contact, cycle_losses, measure, observe


def trace(time, penetration, force, radius=None, loss=None, kind=OutcomeKind.COMPLETED, events=()):
    time, depth, load = (np.asarray(column, float) for column in (time, penetration, force))
    zero = np.zeros_like(time)
    work = np.concatenate((zero[:1], np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(depth))))
    return Trace(
        solver="by hand",
        time=time,
        penetration=np.asarray(penetration, float),
        force=np.asarray(force, float),
        contact_radius=zero + 1.0 if radius is None else np.asarray(radius, float),
        stored_energy=zero,
        external_work=work,
        dissipated_energy=zero if loss is None else np.asarray(loss, float),
        outcome=Outcome(kind, "by hand", float(time[-1]) if time.size else 0.0),
        counters=Counters(),
        events=events,
    )


def test_the_largest_force_may_come_before_the_largest_penetration():
    """A contact that creeps on after its force has fallen, and one that never presses."""
    creeping = ([0, 1, 1.5, 2, 3], [0, 1, 1.1, 1.2, 0], [0, 5, 5, 3, -1])
    seen = observe(trace(*creeping))
    assert (seen.peak_force, seen.peak_time, seen.approach_force) == (5, 1, 3)
    stopped = observe(trace(*(column[:3] for column in creeping), kind=OutcomeKind.STEP_BUDGET))
    assert stopped.peak_force is stopped.peak_time is None
    assert observe(trace([0, 1], [0, -1], [-1, -2])).peak_force is None


def test_the_time_of_the_largest_force_is_compared_where_it_is_one():
    pressed = Loading("relaxed", 0.0, (Ramp(1.0, 1.0), Ramp(-1.0, 1.0)))
    time, depth = np.arange(5.0), [0, 1, 0, 1, 0]
    for force, located in (
        ([0, 5, 1, 3, 0], True),
        ([0, 5, 1, 4.95, 0], False),  # which of two is larger, is a matter of the error
        ([0, 5, 5, 3, 0], False),  # held: where it is largest by round-off
    ):
        assert is_located("peak_time", trace(time, depth, force), pressed) is located
        assert is_located("peak_force", trace(time, depth, force), pressed)
    cycles = Loading("relaxed", 0.0, (Oscillate(0.1, 1.0, 2.0),))
    assert not is_located("peak_time", trace(time, depth, [0, 5, 1, 3, 0]), cycles)
    assert not is_located("peak_force", trace(time, depth, [0, 5, 1, 3, 0]), cycles)
    assert is_located("peak_cycle_loss", trace(time, depth, [0, 5, 1, 3, 0]), cycles)


def test_cycle():
    run = trace(
        [0, 1, 2, 3, 4, 4],
        [0, 2, 1, 0, -1, -1],
        [-1, 6, 1, -3, -2, 0],
        [0.5, 1.0, 0.9, 0.6, 0.3, 0.0],
        [0, 1, 2, 3, 4, 5],
        OutcomeKind.DETACHED,
    )
    seen = observe(run)
    assert (seen.start_force, seen.start_radius) == (-1, 0.5)
    assert (seen.approach_time, seen.approach_force, seen.approach_radius) == (1, 6, 1.0)
    assert (seen.pull_off_force, seen.pull_off_time) == (3, 3)
    assert (seen.pull_off_penetration, seen.pull_off_radius) == (0, 0.6)
    assert (seen.detachment_time, seen.detachment_penetration, seen.detachment_radius) == (4, -1, 0.3)
    assert seen.loop_energy == pytest.approx(5.0 - 3.5 + 1.0 + 2.5)
    assert seen.dissipated_energy == 4  # not what the snap to the free surface sets free
    assert (seen.final_force, seen.final_radius) == (0, 0)


def test_the_solver_s_own_event_locates_the_detachment():
    events = (Event("snap-in", 0.0, 0.0, -1.0, 0.5), Event("pull-off", 1.5, -0.25, -0.5, 0.125))
    seen = observe(trace([0, 1, 2], [1, 0, -1], [1, -1, 0], kind=OutcomeKind.DETACHED, events=events))
    assert (seen.detachment_time, seen.detachment_penetration) == (1.5, -0.25)
    assert (seen.detachment_radius, seen.detachment_force) == (0.125, -0.5)


def test_an_event_at_the_free_surface_is_the_row_before_where_contact_is_lost_at_once():
    """A punch keeps its radius to the end; a sphere without adhesion comes to a point."""
    free = (Event("pull-off", 2.0, 0.0, 0.0, 0.0),)
    punch = trace([0, 1, 2, 2], [2, 1, 0, 0], [2, 1, 0, 0], [1, 1, 1, 0], None, OutcomeKind.DETACHED, free)
    assert observe(punch).detachment_radius == 1.0
    sphere = trace(
        [0, 1, 1.9, 2], [2, 1, 0.1, 0], [2, 1, 0.1, 0], [1, 0.7, 0.3, 0], None, OutcomeKind.DETACHED, free
    )
    assert observe(sphere).detachment_radius == 0.0
    radius = [1, 0.7, 1e-2, 0]  # under a force, that much may be left within rounding of the end
    forced = trace([0, 1, 2, 2], [2, 1, 0.1, 0], [2, 1, 1e-9, 0], radius, None, OutcomeKind.DETACHED, free)
    assert observe(forced, ends_in_a_point=True).detachment_radius == 0.0
    assert observe(punch).detachment_time == observe(sphere).detachment_time == 2.0


@pytest.mark.parametrize("kind", [OutcomeKind.DETACHED, OutcomeKind.COMPLETED])
def test_what_a_run_has_lost_is_read_before_the_snap_to_the_free_surface(kind):
    """The last row of a run that detached is the free surface; what it sets free is no viscous loss."""
    lost = trace(
        [0, 1, 2, 2], [0, -1, -2, -2], [0, -1, -1, 0], [1, 1, 0.5, 0 if kind == "detached" else 0.5],
        loss=[0, 1, 2, 9], kind=kind,
    )  # fmt: skip
    expected = 2.0 if kind is OutcomeKind.DETACHED else 9.0
    assert at_last_contact(lost, "dissipated_energy") == expected
    assert observe(lost).dissipated_energy == expected
    with_energy = dataclasses.replace(lost, stored_energy=np.array([0.0, 2.0, 4.0, 1.0]))
    assert measure(with_energy, load("elastic-press").scene, 0.0)["loss_share"] == expected / 4.0
    assert at_last_contact(lost, "branch_dissipation") is None


def test_a_contact_shorter_than_its_zone_has_left_the_model():
    events = (Event("pull-off", 3.5, -2.5, -0.25, 0.05),)
    for told in ((), events):
        run = trace(
            [0, 1, 2, 3], [1, 0, -1, -2], [1, -3, -2, -1], [1.0, 0.5, 0.25, 0.1], [0, 1, 2, 3],
            OutcomeKind.DETACHED, told,
        )  # fmt: skip
        seen = observe(run, zone=0.25)
        assert (seen.detachment_time, seen.detachment_penetration, seen.detachment_radius) == (2, -1, 0.25)
        assert seen.dissipated_energy == 2
        assert observe(run, zone=2.0).dissipated_energy == 3  # nothing is longer: the last row in contact
    assert observe(run, zone=0.04).detachment_penetration == -2.5


def test_nothing_applies():
    seen = observe(trace([0, 1], [0, 1], [0, 1]))
    assert seen.pull_off_force is seen.pull_off_penetration is seen.detachment_time is None
    assert set(observe(trace([], [], [])).as_dict().values()) == {None}


def test_round_off_is_not_a_pull_off():
    assert observe(trace([0, 1, 2], [0, 1, 0], [0, 1, -1e-15])).pull_off_force is None


def test_rows_that_go_back_by_what_is_not_known_of_them_are_no_pull_off():
    """On a spring, two rows at nearly the same time of an approach under tension."""
    run = trace([0, 1, 1 + 1e-9, 2], [0, 1, 1 - 1e-8, 2], [-3, -2, -2, -1])
    assert observe(run).pull_off_force is None


def test_dwell_ends_the_approach_at_its_first_row():
    run = trace([0, 1, 2, 3, 4], [0, 1, 1, 1, 0], [0, 3, 2, 1, 0])
    assert end_of_approach(run) == 1
    assert observe(run).approach_force == 3


@pytest.mark.parametrize("shift", [0.0, 0.13, 0.4, 0.77])
@pytest.mark.parametrize("spacing", [0.02, 0.1, 0.4])
def test_of_crests_of_one_height_the_first_ends_the_approach(shift, spacing):
    """Rows miss each crest by another part of its height: the largest row is in any of them."""
    time = np.arange(shift * spacing, 40.0, spacing)
    crest = end_of_approach(trace(time, np.sin(time), time))
    assert abs(time[crest] - 0.5 * np.pi) < spacing
    assert np.sin(time[crest]) > np.sin(time[crest - 1])
    assert np.sin(time[crest]) > np.sin(time[crest + 1])


def test_a_crest_that_is_higher_ends_the_approach_though_it_comes_later():
    time = np.arange(0.0, 40.0, 0.1)
    growing = end_of_approach(trace(time, (1.0 + 0.01 * time) * np.sin(time), time))
    assert abs(time[growing] - 12.5 * np.pi) < 0.2
    ramps = trace([0, 1, 2, 3, 4], [0, 1.0, 0.5, 1.0 + 1e-6, 0], [0, 1, 0, 1, 0])
    assert end_of_approach(ramps) == 3
    assert end_of_approach(trace([0, 1, 2, 3, 4], [0, 1.0, 0.5, 1.0, 0], [0, 1, 0, 1, 0])) == 1


def test_rows_at_nearly_one_time_make_no_crest_of_a_bump():
    """Rounding of the penetration of a spring, over next to no time, is a slope without end."""
    time = [0.0, 1.0, 1.0 + 1e-12, 2.0, 2.0 + 1e-12, 3.0, 4.0]
    depth = [0.0, 1.0, 1.0 + 1e-9, 1.0 - 1e-9, 1.0 - 2e-9, 3.0, 0.0]
    assert end_of_approach(trace(time, depth, time)) == 5


@pytest.mark.parametrize("late", [0.0, 0.1])
def test_a_contact_that_creeps_on_after_its_force_has_turned_ends_its_approach_at_a_smooth_crest(late):
    t = np.linspace(0.0, 2.0, 201)
    found = trace(t, 1.0 - np.abs(t - 1.0 - late), np.ones_like(t))
    force = Loading("jump-in", 0.0, (ForceRamp(1.0, 1.0), ForceRamp(0.0, 1.0)))
    for name in ("approach_force", "approach_radius", "approach_time"):
        assert is_located(name, found, force) is (late == 0.0)
    assert is_located("approach_penetration", found, force)


@pytest.mark.parametrize(("rate", "located"), [(1.0, True), (20.0, False)])
def test_a_penetration_that_creeps_until_it_all_but_rests_ends_the_approach_at_no_certain_time(rate, located):
    t = np.linspace(0.0, 2.0, 201)
    crept = trace(t, np.where(t < 1.0, 1.0 - np.exp(-rate * t), 2.0 - t), np.ones_like(t))
    force, pressed = Loading("jump-in", 0.0, (Force(1.0, 1.0),)), Loading("jump-in", 0.0, (Ramp(1.0, 1.0),))
    assert is_located("approach_time", crept, force) is located
    assert is_located("approach_force", crept, force)
    assert is_located("pull_off_time", crept, force)
    assert is_located("approach_time", crept, pressed)
    again = trace([0, 1, 2, 3, 4], [0, 1, 0, 0.9999, 0], [0, 1, 0, 0.9, 0])
    assert not is_located("approach_force", again, force)
    assert is_located("approach_penetration", again, force)
    assert is_located("approach_force", again, pressed)
    to_a_level = Loading("jump-in", 0.0, (Ramp(1.0, 1.0, until_force=1.0),))
    assert not is_located("approach_force", again, to_a_level)
    swung = Loading("jump-in", 0.0, (Oscillate(0.1, 6.0, 2.0),))
    assert not is_located("approach_radius", crept, swung)


def test_a_run_stopped_after_its_first_crest_has_ended_its_approach():
    loading = Loading("relaxed", 0.0, (Oscillate(1.0, 1.0, 40.0),))
    time = np.arange(0.03, 9.0, 0.1)
    stopped = trace(time, np.sin(time), time, kind=OutcomeKind.INTERRUPTED)
    assert observe(stopped, loading=loading).approach_time == pytest.approx(0.5 * np.pi, abs=0.1)
    rising = trace(time[:12], np.sin(time[:12]), time[:12], kind=OutcomeKind.INTERRUPTED)
    assert observe(rising, loading=loading).approach_time is None


@pytest.mark.parametrize("free_surface", [True, False])
def test_of_a_contact_that_was_lost_the_final_state_is_without_force_and_radius(free_surface):
    """Some solvers end with the last state in contact, some with a row of the free surface."""
    rows = slice(None) if free_surface else slice(-1)
    columns = ([0, 1, 2, 3, 3][rows], [0, 2, 0, -1, -1][rows], [0, 6, -3, -2, 0][rows])
    radius = [0.5, 1.0, 0.6, 0.3, 0.0][rows]
    seen = observe(trace(*columns, radius, kind=OutcomeKind.DETACHED))
    assert (seen.final_time, seen.final_penetration) == (3, -1)
    assert (seen.final_force, seen.final_radius) == (0, 0)
    assert (seen.detachment_force, seen.detachment_radius) == (-2, 0.3)
    kept = observe(trace(*columns, radius))
    assert (kept.final_force, kept.final_radius) == (columns[2][-1], radius[-1])


def test_force_plateau_pulls_off_at_its_last_row():
    plateau = [0, 0, 1, 2], [3, 1, 0, -4], [1, -2, -2, -2 + 1e-12]
    assert observe(trace(*plateau, kind=OutcomeKind.DETACHED)).pull_off_time == 2
    assert observe(trace(*plateau)).pull_off_time is None  # the tension has not fallen: no extremum yet


def ended(*columns, kind=OutcomeKind.INTERRUPTED, past=False):
    run = trace(*columns)
    return dataclasses.replace(run, outcome=dataclasses.replace(run.outcome, kind=kind, past_extremum=past))


STOPPED = (OutcomeKind.INTERRUPTED, OutcomeKind.STEP_BUDGET, OutcomeKind.NOT_FINITE, OutcomeKind.COMPLETED)
UNDER_TENSION = [0, 1, 2], [0, 1, 2], [-2, -1, 3]
RISING = [0, 1, 2, 3], [0, 2, 1, 0], [-2, 3, -1, -4]
PASSED = [0, 1, 2, 3, 4], [0, 2, 1, 0, -1], [-2, 3, -1, -1.5, -1.25]


@pytest.mark.parametrize("kind", STOPPED)
def test_a_run_that_ends_before_an_extremum_of_tension_has_no_pull_off(kind):
    for columns in (UNDER_TENSION, RISING):
        seen = observe(ended(*columns, kind=kind))
        assert {seen.pull_off_force, seen.pull_off_time, seen.pull_off_penetration, seen.pull_off_radius} == {
            None
        }
    seen = observe(ended(*PASSED, kind=kind))  # less than the tension at the start, which is no pull-off
    assert (seen.pull_off_force, seen.pull_off_time, seen.pull_off_penetration) == (1.5, 3, 0)


def test_a_dwell_under_tension_before_the_approach_is_no_pull_off():
    run = trace([0, 1, 2, 3, 4], [0, 0, 0, 2, 1], [-2, -2.5, -2.25, 3, -1])
    assert observe(run).pull_off_force is None


def test_a_hold_that_ends_in_detachment_pulls_off_at_its_extremum():
    held = [0, 1, 2, 2], [-1, -1, -1, -1], [-2, -2.5, -2.25, 0], [1, 0.75, 0.5, 0]
    assert observe(trace(*held, kind=OutcomeKind.DETACHED)).pull_off_force == 2.5


@pytest.mark.parametrize("past", [False, True])
def test_a_contact_as_long_as_its_zone_has_not_detached(past):
    columns = PASSED if past else RISING
    seen = observe(ended(*columns, kind=OutcomeKind.BELOW_ZONE, past=past), zone=0.25)
    found = [value for name, value in seen.as_dict().items() if name.startswith("detachment")]
    assert set(found) == {None}
    assert len(found) == 4
    assert seen.pull_off_force == (1.5 if past else None)
    assert (seen.final_time, seen.approach_time) == ((4, 1) if past else (3, 1))
    unknown = observe(ended(*PASSED, kind=OutcomeKind.BELOW_ZONE, past=False), zone=0.25)
    assert unknown.pull_off_force is None


def test_the_approach_of_a_stopped_run_is_known_once_it_has_ended():
    down = Ramp(2.0, 1.0)
    back = Ramp(-1.0, 1.0)
    assert observe(ended(*UNDER_TENSION)).approach_force is None
    assert observe(trace(*UNDER_TENSION)).approach_force == 3
    assert observe(ended(*RISING)).approach_force == 3
    assert (
        observe(
            ended([0, 2, 3], [0, 2, 2], [0, 3, 2]), 0.0, Loading("relaxed", 0, (down, Hold(9)))
        ).approach_time
        == 2
    )
    for ahead in (Ramp(2.5, 1.0), Force(4.0, 1.0), Oscillate(1.5, 1.0, 9.0)):
        again = Loading("relaxed", 0.0, (down, Ramp(1.0, 1.0), ahead))
        assert observe(ended([0, 2, 2.5], [0, 2, 1.5], [0, 3, 2]), 0.0, again).approach_force is None
        assert (
            observe(
                ended([0, 2, 2.5], [0, 2, 1.5], [0, 3, 2]), 0.0, Loading("relaxed", 0.0, (down, back))
            ).approach_force
            == 3
        )


def test_jump_counts_in_the_loop_integral():
    assert observe(trace([0, 0], [2, 1], [4, -2])).loop_energy == pytest.approx(-1.0)


def test_cycle_losses_of_a_linear_material():
    storage, loss, amplitude, w = 3.0, 0.5, 0.1, 2.0
    time = np.linspace(0, 4 * np.pi, 4001)
    depth = amplitude * np.sin(w * time)
    force = storage * depth + loss * amplitude * np.cos(w * time)
    dissipated = 0.5 * loss * amplitude**2 * w * time
    ends = np.arange(5) * np.pi + 1e-4
    cycles = cycle_losses(trace(time, depth, force, loss=dissipated), ends)
    assert len(cycles) == 3
    for cycle in cycles:
        assert cycle.loop == pytest.approx(np.pi * loss * amplitude**2, rel=1e-5)
        assert cycle.dissipated == pytest.approx(np.pi * loss * amplitude**2, rel=1e-9)
        assert cycle.angular_frequency == pytest.approx(w)


def test_norms_by_hand():
    run = trace([0, 2], [0, 0], [0, 4])
    base = trace([0, 1, 2], [0, 0, 0], [0, 2, 2])
    apart = distance(run, base)
    assert apart is not None
    assert apart.mean == pytest.approx(0.5 * 0.5 / 2 * 2 * 1.0)
    assert apart.rms == pytest.approx(np.sqrt(4 / 3 / 2) / 2)
    assert (apart.largest, apart.at, apart.covered) == (1.0, 2.0, 1.0)


def test_sign_change_inside_an_interval():
    apart = distance(trace([0, 2], [0, 0], [-1, 1]), trace([0, 2], [0, 0], [1, -1]))
    assert apart is not None
    assert apart.mean == pytest.approx(1.0)


def test_norms_see_both_sides_of_a_jump():
    run = trace([0, 1, 1, 2], [0, 0, 0, 0], [0, 0, 2, 2])
    assert distance(run, run).largest == 0.0
    late = trace([0, 1.5, 1.5, 2], [0, 0, 0, 0], [0, 0, 2, 2])
    apart = distance(run, late)
    assert apart is not None
    assert apart.mean == pytest.approx(0.25)
    assert parting_time(run, late, 1e-3) == 1.0
    assert parting_time(run, run, 1e-3) is None


def test_jump_at_the_first_row():
    run = trace([0, 0, 1], [0, 0, 0], [5, 1, 1])
    base = trace([0, 1], [0, 0], [1, 1])
    apart = distance(run, base)
    assert apart is not None
    assert apart.mean == 0.0


def test_shorter_run_is_compared_as_far_as_it_goes():
    apart = distance(trace([0, 1], [0, 0], [1, 1]), trace([0, 4], [0, 0], [1, 1]))
    assert apart is not None
    assert (apart.until, apart.covered, apart.largest) == (1.0, 0.25, 0.0)
    assert distance(trace([0], [0], [1]), trace([0, 1], [0, 0], [1, 1])) is None


@pytest.mark.parametrize(
    ("tension", "past"),
    [
        ([1.0, 2.0, 1.5], True),
        ([1.0, 2.0, 2.0], False),  # it has not fallen yet
        ([1.0, 1.5, 2.0], False),
        ([2.0, 1.5, 1.0], False),  # a run that merely begins under tension
        ([2.0, -3.0, 1.5, 1.0], True),  # less than at the start, and an extremum
        ([2.0, -3.0, 1.0, 1.5], False),
        ([-3.0, -1.0, -2.0], False),  # never under tension
        ([0.0], False),
        ([], False),
    ],
)
def test_the_extremum_before_the_process_zone_is_reached(tension, past):
    outcome = below_zone_outcome(-np.array(tension), 3.0)
    assert (outcome.kind, outcome.time) == (OutcomeKind.BELOW_ZONE, 3.0)
    assert outcome.past_extremum is outcome.finished is past
    if len(tension) > 1:
        depth = -np.arange(len(tension), dtype=float)
        run = dataclasses.replace(trace(np.arange(len(tension)), depth, -np.array(tension)), outcome=outcome)
        assert (observe(run).pull_off_force is not None) is past
