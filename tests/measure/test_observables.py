"""Observables on traces whose numbers are known by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.synthetic_traces import by_hand, work_of

import contact_scene as cs
from contact_scene.run_control import below_zone_outcome
from validation.cases import load
from validation.measure.events import end_of_approach, is_located
from validation.measure.observables import at_last_contact, cycle_losses, measure, observe
from validation.measure.scaling import SYMBOLS, kind_of, unit_sizes

DETACHED, COMPLETED = cs.OutcomeKind.DETACHED, cs.OutcomeKind.COMPLETED


def trace(time, penetration, force, radius=1.0, loss=0.0, kind=COMPLETED, events=(), past=False):
    rows = {"penetration": penetration, "force": force, "contact_radius": radius, "dissipated_energy": loss}
    return work_of(by_hand(time, kind, past=past, events=events, **rows))


def test_cycle():
    run = trace(
        [0, 1, 2, 3, 4, 4],
        [0, 2, 1, 0, -1, -1],
        [-1, 6, 1, -3, -2, 0],
        [0.5, 1.0, 0.9, 0.6, 0.3, 0.0],
        [0, 1, 2, 3, 4, 5],
        DETACHED,
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
    without = observe(dataclasses.replace(run, **{n: c[:-1] for n, c in run.columns().items()}))
    assert (without.final_force, without.final_radius, without.detachment_radius) == (0, 0, 0.3)
    assert observe(trace([0, 0], [2, 1], [4, -2])).loop_energy == pytest.approx(-1.0)  # a jump counts


def test_every_scalar_has_a_kind_and_every_kind_a_size():
    """Units of tables, figures and data sets follow from it: without one a scalar is taken for a share."""
    scene = load("cycle-v0.02").scene
    scalars = {name for name in measure(trace([], [], []), scene, 0.0) if not name.startswith("counters.")}
    shares = {"loss_share", "wall_seconds"}
    assert {name for name in scalars if not kind_of(name)} == shares
    assert {kind_of(name) for name in scalars} <= {*SYMBOLS, "time", "frequency"}
    assert unit_sizes(scene).keys() == SYMBOLS.keys()


def test_nothing_applies():
    seen = observe(trace([0, 1], [0, 1], [0, 1]))
    assert seen.pull_off_force is seen.pull_off_penetration is seen.detachment_time is None
    assert set(observe(trace([], [], [])).as_dict().values()) == {None}
    assert observe(trace([0, 1], [0, -1], [-1, -2])).peak_force is None


def test_the_largest_force_may_come_before_the_largest_penetration():
    creeping = ([0, 1, 1.5, 2, 3], [0, 1, 1.1, 1.2, 0], [0, 5, 5, 3, -1])
    seen = observe(trace(*creeping))
    assert (seen.peak_force, seen.peak_time, seen.approach_force) == (5, 1, 3)
    stopped = observe(trace(*(column[:3] for column in creeping), kind=cs.OutcomeKind.STEP_BUDGET))
    assert stopped.peak_force is stopped.peak_time is None


FREE = (cs.Event("pull-off", 2.0, 0.0, 0.0, 0.0),)
IN_A_POINT = [0, 1, 1.9, 2], [2, 1, 0.1, 0], [2, 1, 0.1, 0], [1, 0.7, 0.3, 0]
FORCED = [0, 1, 2, 2], [2, 1, 0.1, 0], [2, 1, 1e-9, 0], [1, 0.7, 1e-2, 0]


@pytest.mark.parametrize(
    ("columns", "events", "zone", "in_a_point", "time", "radius"),
    [
        (([0, 1, 2], [1, 0, -1], [1, -1, 0]), (cs.Event("snap-in", 0.0, 0.0, -1.0, 0.5),
         cs.Event("pull-off", 1.5, -0.25, -0.5, 0.125)), 0.0, False, 1.5, 0.125),  # as the solver locates it
        (([0, 1, 2, 2], [2, 1, 0, 0], [2, 1, 0, 0], [1, 1, 1, 0]), FREE, 0.0, False, 2.0, 1.0),  # a punch
        (IN_A_POINT, FREE, 0.0, False, 2.0, 0.0),
        (FORCED, FREE, 0.0, True, 2.0, 0.0),  # under a force that much may be left within rounding
        (([0, 1, 2, 3], [1, 0, -1, -2], [1, -3, -2, -1], [1, 0.5, 0.25, 0.1]), (), 0.25, False, 2.0, 0.25),
        (([0, 1, 2, 3], [1, 0, -1, -2], [1, -3, -2, -1], [1, 0.5, 0.25, 0.1]),
         (cs.Event("pull-off", 3.5, -2.5, -0.25, 0.05),), 0.25, False, 2.0, 0.25),  # out of the model
        (([0, 1, 2, 3], [1, 0, -1, -2], [1, -3, -2, -1], [1, 0.5, 0.25, 0.1]),
         (cs.Event("pull-off", 3.5, -2.5, -0.25, 0.05),), 0.04, False, 3.5, 0.05),
    ],
)  # fmt: skip
def test_the_last_state_in_contact(columns, events, zone, in_a_point, time, radius):
    seen = observe(trace(*columns, kind=DETACHED, events=events), zone, None, in_a_point)
    assert (seen.detachment_time, seen.detachment_radius) == (time, radius)


@pytest.mark.parametrize("kind", [DETACHED, COMPLETED])
def test_what_a_run_has_lost_is_read_before_the_snap_to_the_free_surface(kind):
    radius = [1, 1, 0.5, 0 if kind is DETACHED else 0.5]
    lost = trace([0, 1, 2, 2], [0, -1, -2, -2], [0, -1, -1, 0], radius, [0, 1, 2, 9], kind)
    expected = 2.0 if kind is DETACHED else 9.0
    assert at_last_contact(lost, "dissipated_energy") == observe(lost).dissipated_energy == expected
    with_energy = dataclasses.replace(lost, stored_energy=np.array([0.0, 2.0, 4.0, 1.0]))
    assert measure(with_energy, load("cycle-v0.02").scene, 0.0)["loss_share"] == expected / 4.0
    assert at_last_contact(lost, "branch_dissipation") is None
    long = trace([0, 1], [1, 0], [1, -3], [1.0, 0.5], [0, 1], DETACHED)
    assert observe(long, zone=2.0).dissipated_energy == 1  # nothing is longer: the last row in contact
    assert observe(lost, ends_in_a_point=True).dissipated_energy == 9.0  # nothing snaps


UNDER_TENSION = [0, 1, 2], [0, 1, 2], [-2, -1, 3]
RISING = [0, 1, 2, 3], [0, 2, 1, 0], [-2, 3, -1, -4]
PASSED = [0, 1, 2, 3, 4], [0, 2, 1, 0, -1], [-2, 3, -1, -1.5, -1.25]
PLATEAU = [0, 0, 1, 2], [3, 1, 0, -4], [1, -2, -2, -2 + 1e-12]
HELD = [0, 1, 2, 2], [-1, -1, -1, -1], [-2, -2.5, -2.25, 0], [1, 0.75, 0.5, 0]
STOPPED = (cs.OutcomeKind.INTERRUPTED, cs.OutcomeKind.STEP_BUDGET, cs.OutcomeKind.NOT_FINITE, COMPLETED)


@pytest.mark.parametrize(
    ("columns", "kind", "past", "force", "time"),
    [
        *((UNDER_TENSION, kind, False, None, None) for kind in STOPPED),
        *((RISING, kind, False, None, None) for kind in STOPPED),  # no extremum yet
        *((PASSED, kind, False, 1.5, 3) for kind in STOPPED),  # less than at the start, which is none
        (RISING, cs.OutcomeKind.BELOW_ZONE, False, None, None),
        (PASSED, cs.OutcomeKind.BELOW_ZONE, True, 1.5, 3),
        (PASSED, cs.OutcomeKind.BELOW_ZONE, False, None, None),  # only its outcome knows
        (([0, 1, 2], [0, 1, 0], [0, 1, -1e-15]), COMPLETED, False, None, None),  # round-off
        (([0, 1, 1 + 1e-9, 2], [0, 1, 1 - 1e-8, 2], [-3, -2, -2, -1]), COMPLETED, False, None, None),
        (([0, 1, 2, 3, 4], [0, 0, 0, 2, 1], [-2, -2.5, -2.25, 3, -1]), COMPLETED, False, None, None),
        (HELD, DETACHED, False, 2.5, 1),
        (PLATEAU, DETACHED, False, 2.0, 2),  # its last row
        (PLATEAU, COMPLETED, False, None, None),
    ],
)
def test_the_pull_off_is_an_extremum_of_tension_that_the_run_has_passed(columns, kind, past, force, time):
    seen = observe(trace(*columns, kind=kind, past=past), zone=0.25 if past else 0.0)
    assert seen.pull_off_force == (None if force is None else pytest.approx(force))
    assert seen.pull_off_time == time
    assert (seen.detachment_time is None) is (kind is not DETACHED)


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
    assert (outcome.kind, outcome.time) == (cs.OutcomeKind.BELOW_ZONE, 3.0)
    assert outcome.past_extremum is outcome.finished is past
    if len(tension) > 1:
        depth = -np.arange(len(tension), dtype=float)
        run = dataclasses.replace(trace(np.arange(len(tension)), depth, -np.array(tension)), outcome=outcome)
        assert (observe(run).pull_off_force is not None) is past


def test_of_rows_of_one_height_a_located_extremum_is_the_one():
    """A flat crest: rows beside it differ by less than rounding of the largest force."""
    pulled = 1.0 - 1e-12
    rows = [0, 1, 2, 3, 4, 5, 6], [0, 3, 2, 0, -1, -2, -3], [0, 1000, 1000 - 1e-10, 0, -1, -pulled, -0.5]
    run = trace(*rows)
    assert (observe(run).pull_off_time, observe(run).peak_time) == (5, 1)
    located = [
        cs.Event(kind, time, 0.0, 0.0, 0.0) for kind, time in (("largest tension", 4), ("largest force", 2))
    ]
    seen = observe(dataclasses.replace(run, located=tuple(located)))
    assert (seen.pull_off_time, seen.peak_time) == (4, 2)


@pytest.mark.parametrize("shift", [0.0, 0.13, 0.4, 0.77])
@pytest.mark.parametrize("spacing", [0.02, 0.1, 0.4])
def test_of_crests_of_one_height_the_first_ends_the_approach(shift, spacing):
    """Rows miss each crest by another part of its height: the largest row is in any of them."""
    time = np.arange(shift * spacing, 40.0, spacing)
    crest = end_of_approach(trace(time, np.sin(time), time))
    assert abs(time[crest] - 0.5 * np.pi) < spacing
    assert np.sin(time[crest]) > max(np.sin(time[crest - 1]), np.sin(time[crest + 1]))


@pytest.mark.parametrize(
    ("time", "depth", "row"),
    [
        ([0, 1, 2, 3, 4], [0, 1, 1, 1, 0], 1),  # a dwell: its first row
        ([0, 1, 2, 3, 4], [0, 1.0, 0.5, 1.0 + 1e-6, 0], 3),  # a crest that is higher, though it comes later
        ([0, 1, 2, 3, 4], [0, 1.0, 0.5, 1.0, 0], 1),
        # rounding of the penetration of a spring, over next to no time, is a slope without end
        ([0, 1, 1 + 1e-12, 2, 2 + 1e-12, 3, 4], [0, 1, 1 + 1e-9, 1 - 1e-9, 1 - 2e-9, 3, 0], 5),
    ],
)
def test_the_highest_crest_ends_the_approach(time, depth, row):
    assert end_of_approach(trace(time, depth, time)) == row
    growing = np.arange(0.0, 40.0, 0.1)
    last = end_of_approach(trace(growing, (1.0 + 0.01 * growing) * np.sin(growing), growing))
    assert abs(growing[last] - 12.5 * np.pi) < 0.2


T = np.linspace(0.0, 2.0, 201)
PRESSED = cs.Loading("jump-in", 0.0, (cs.Ramp(1.0, 1.0), cs.Ramp(-1.0, 1.0)))
TO_A_LEVEL = cs.Loading("jump-in", 0.0, (cs.Ramp(1.0, 1.0, until_force=1.0),))
LOADED, TURNED = (
    cs.Loading("jump-in", 0.0, steps)
    for steps in ((cs.Force(1.0, 1.0),), (cs.ForceRamp(1.0, 1.0), cs.ForceRamp(0.0, 1.0)))
)
SWUNG = cs.Loading("jump-in", 0.0, (cs.Oscillate(0.1, 6.0, 2.0),))
TWO = trace([0, 1, 2, 3, 4], [0, 1, 0, 0.9999, 0], [0, 1, 0, 0.9, 0])
SLOW, RESTING = (
    trace(T, np.where(T < 1.0, 1.0 - np.exp(-rate * T), 2.0 - T), np.ones_like(T)) for rate in (1.0, 20.0)
)
LATE = trace(T, 1.0 - np.abs(T - 1.1), np.ones_like(T))


@pytest.mark.parametrize(
    ("run", "loading", "located", "not_located"),
    [
        (LATE, TURNED, "approach_penetration", "approach_force approach_radius approach_time"),
        (trace(T, 1.0 - np.abs(T - 1.0), T), TURNED, "approach_force approach_radius approach_time", ""),
        (SLOW, LOADED, "approach_time approach_force pull_off_time", ""),
        (RESTING, LOADED, "approach_force", "approach_time"),
        (RESTING, PRESSED, "approach_time", ""),
        (TWO, LOADED, "approach_penetration", "approach_force"),  # which is higher, its last digits tell
        (TWO, PRESSED, "approach_force peak_time peak_force", ""),
        (TWO, TO_A_LEVEL, "", "approach_force"),
        (TWO, SWUNG, "peak_cycle_loss", "approach_radius peak_time peak_force"),
        (trace(range(5), [0, 1, 0, 1, 0], [0, 5, 1, 4.95, 0]), PRESSED, "peak_force", "peak_time"),
        (trace(range(5), [0, 1, 0, 1, 0], [0, 5, 5, 3, 0]), PRESSED, "peak_force", "peak_time"),  # held
    ],
)
def test_what_is_the_same_in_all_right_runs(run, loading, located, not_located):
    assert all(is_located(name, run, loading) for name in located.split())
    assert not any(is_located(name, run, loading) for name in not_located.split())


DOWN = cs.Ramp(2.0, 1.0)


@pytest.mark.parametrize(
    ("columns", "steps", "time"),
    [
        (UNDER_TENSION, (DOWN,), None),
        (RISING, (DOWN, cs.Ramp(-1.0, 1.0)), 1),
        (([0, 2, 3], [0, 2, 2], [0, 3, 2]), (DOWN, cs.Hold(9)), 2),
        (([0, 2, 2.5], [0, 2, 1.5], [0, 3, 2]), (DOWN, cs.Ramp(-1.0, 1.0)), 2),
        *(
            (([0, 2, 2.5], [0, 2, 1.5], [0, 3, 2]), (DOWN, cs.Ramp(1.0, 1.0), ahead), None)
            for ahead in (
                cs.Ramp(2.5, 1.0),
                cs.Force(4.0, 1.0),
                cs.Oscillate(1.5, 1.0, 9.0),
                cs.Table((0.0, 1.0, 2.0), (1.0, 2.5, 0.0), interpolation="cubic"),
            )
        ),
    ],
)
def test_the_approach_of_a_stopped_run_is_known_once_it_has_ended(columns, steps, time):
    loading = cs.Loading("relaxed", 0.0, steps)
    assert observe(trace(*columns, kind=cs.OutcomeKind.INTERRUPTED), loading=loading).approach_time == time
    assert observe(trace(*columns)).approach_force == 3


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
