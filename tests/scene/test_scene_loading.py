"""Loading steps as segments: values at the ends are exact, rates are derivatives, kinks are declared."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_scene import Force, ForceRamp, Hold, Loading, Oscillate, Ramp, SceneError, Sweep, Table

STEPS = [
    Ramp(to=0.3, rate=0.07),
    Ramp(to=-0.3, rate=0.07),
    Hold(duration=2.5),
    Force(value=-0.2, duration=2.5),
    ForceRamp(to=0.9, rate=0.3),
    ForceRamp(to=-0.9, rate=0.3),
    Oscillate(amplitude=0.1, angular_frequency=3.0, duration=2.5, drift=0.01),
    Sweep(amplitude=0.1, chirp=0.7, duration=2.5),
    Table(times=(5.0, 5.5, 7.0, 7.25), values=(0.4, 0.1, 0.1, -0.2)),
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


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.kind)
def test_rate_comes_from_the_right(step):
    segment = step.segment(1.7, 0.1, 0.05)
    for at in (segment.start, *segment.kinks):
        h = 1e-7
        assert segment.rate(at) == pytest.approx(
            (segment.value(at + h) - segment.value(at)) / h, rel=1e-5, abs=1e-6
        )


def test_ends_are_exact():
    start, penetration, force = 0.1 + 0.2, 0.7, -0.3
    ramp = Ramp(to=0.1, rate=0.3).segment(start, penetration, force)
    assert (ramp.control, ramp.start, ramp.value(ramp.start), ramp.value(ramp.end)) == (
        "penetration",
        start,
        penetration,
        0.1,
    )
    assert ramp.end == pytest.approx(start + 2.0)
    up = ForceRamp(to=0.6, rate=0.3).segment(start, penetration, force)
    assert (up.control, up.value(up.start), up.value(up.end)) == ("force", force, 0.6)
    assert up.end == pytest.approx(start + 3.0)
    hold = Hold(2.0).segment(start, penetration, force)
    assert (hold.value(hold.start), hold.value(hold.end), hold.rate(start)) == (penetration, penetration, 0.0)
    held = Force(0.25, 2.0).segment(start, penetration, force)
    assert (held.control, held.value(held.start), held.value(held.end)) == ("force", 0.25, 0.25)
    wave = Oscillate(0.1, 3.0, 2.0).segment(start, penetration, force)
    assert wave.value(wave.start) == penetration
    assert wave.value(wave.end) == pytest.approx(penetration + 0.1 * math.sin(6.0))
    sweep = Sweep(0.1, 3.0, 2.0).segment(start, penetration, force)
    assert sweep.value(sweep.start) == penetration
    assert sweep.value(sweep.end) == pytest.approx(penetration + 0.1 * math.sin(6.0))


numbers = st.floats(-1e6, 1e6)


@given(numbers, numbers, numbers, st.floats(1e-6, 1e6))
def test_ramps_start_and_end_exactly_and_stay_between(start, here, there, rate):
    for segment in (
        Ramp(there, rate).segment(start, here, 0.0),
        ForceRamp(there, rate).segment(start, 0.0, here),
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


def test_ramp_after_a_force_step_starts_where_that_ended():
    reached = 0.0421
    ramp = Ramp(to=0.0, rate=0.01).segment(10.0, reached, 0.3)
    assert ramp.value(10.0) == reached
    assert ramp.end == pytest.approx(14.21)
    back = ForceRamp(to=0.0, rate=0.1).segment(10.0, reached, 0.3)
    assert back.value(10.0) == 0.3
    assert back.end == pytest.approx(13.0)


@pytest.mark.parametrize(
    "step", [Hold(0.0), Force(0.2, 0.0), Ramp(to=0.1, rate=1.0), ForceRamp(to=0.05, rate=1.0)]
)
def test_zero_length(step):
    segment = step.segment(3.0, 0.1, 0.05)
    assert segment.end == segment.start == 3.0
    assert segment.rate(3.0) == 0.0
    assert segment.kinks == ()
    expected = {"hold": 0.1, "force": 0.2, "ramp": 0.1, "force-ramp": 0.05}[step.kind]
    assert segment.value(3.0) == expected


def test_duration_lost_in_a_late_start():
    """A step shorter than the spacing of floats at its start is a jump to its end."""
    assert Ramp(to=1e-9, rate=1.0).segment(1e9, 0.0, 0.0).value(1e9) == 1e-9
    table = Table((0.0, 1e-9, 2e-9), (0.0, 1.0, 2.0)).segment(1e9, 0.0, 0.0)
    assert (table.start, table.end, table.kinks, table.value(1e9), table.rate(1e9)) == (
        1e9,
        1e9,
        (),
        2.0,
        0.0,
    )
    partly = Table((0.0, 1e-9, 1.0, 2.0), (0.0, 1.0, 2.0, 0.0)).segment(1e9, 0.0, 0.0)
    assert (partly.value(1e9), partly.kinks, partly.value(1e9 + 1.5)) == (1.0, (1e9 + 1.0,), 1.0)


def test_table_passes_through_its_rows_and_declares_every_kink():
    table = STEPS[-1].segment(10.0, 0.4, 0.0)
    assert (table.start, table.end, table.kinks, table.linear) == (10.0, 12.25, (10.5, 12.0), True)
    assert [table.value(t) for t in (10.0, 10.5, 12.0, 12.25)] == [0.4, 0.1, 0.1, -0.2]
    assert table.value(10.25) == pytest.approx(0.25)
    assert [table.rate(t) for t in (10.0, 10.5, 12.0)] == pytest.approx([-0.6, 0.0, -1.2])


def test_table_may_begin_with_a_jump():
    table = Table((0.0, 1.0), (0.2, 0.3)).segment(4.0, 0.1, 0.0)
    assert table.value(4.0) == 0.2
    assert table.value(4.0) != 0.1


def test_oscillation_drifts_downwards_in_penetration():
    wave = Oscillate(amplitude=0.0, angular_frequency=1.0, duration=3.0, drift=0.1).segment(0.0, 1.0, 0.0)
    assert wave.value(3.0) == pytest.approx(0.7)
    assert not wave.linear


def test_sweep_frequency_is_chirp_times_time():
    sweep = Sweep(amplitude=1.0, chirp=2.0, duration=50.0).segment(0.0, 0.0, 0.0)
    turns = [math.sqrt(math.pi * (2 * n + 1) / 2.0) for n in range(5)]  # chirp t^2/2 = pi/2 + n pi
    for turn in turns:
        assert sweep.rate(turn) == pytest.approx(0.0, abs=1e-12)
        assert abs(sweep.value(turn)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("build", "key"),
    [
        (lambda: Table((0.0, 1.0, 1.0), (0.0, 0.0, 0.0)), "time, row 3"),
        (lambda: Table((0.0, 2.0, 1.0), (0.0, 0.0, 0.0)), "time, row 3"),
        (lambda: Table((0.0,), (0.0,)), "time"),
        (lambda: Table((0.0, 1.0), (0.0,)), "penetration"),
        (lambda: Table((0.0, 1.0), (0.0, float("nan"))), "penetration, row 2"),
    ],
)
def test_bad_tables(build, key):
    with pytest.raises(SceneError) as caught:
        build()
    assert caught.value.key == key
    assert caught.value.allowed


def test_segments_know_what_the_loading_prescribes_and_no_more():
    steps = (Ramp(0.3, 0.1), Hold(1.0), Force(-0.2, 2.0), Ramp(0.5, 0.1))
    first, hold, force, last = (segment for _, segment in Loading("relaxed", 0.1, steps).segments())
    assert (first.start, first.end) == (0.0, (0.3 - 0.1) / 0.1)
    assert (hold.start, hold.end, hold.value(hold.end)) == (first.end, first.end + 1.0, 0.3)
    assert (force.end, force.value(force.end)) == (hold.end + 2.0, -0.2)
    assert last.start == force.end
    assert math.isnan(last.end)  # the penetration it starts from is known after the run only


def test_segments_take_an_estimated_state():
    loading = Loading("jump-in", 0.1, (Force(1.0, 2.0), Ramp(0.5, 0.1)))
    known = []

    def state(step):
        known.append(step)
        return 0.4, 0.0

    assert [segment.end for _, segment in loading.segments(state)] == [2.0, 2.0 + (0.5 - 0.4) / 0.1]
    assert known == list(loading.steps)
    assert [segment.start for _, segment in loading.segments(state, own_time=True)] == [0.0, 0.0]
