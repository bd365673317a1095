"""Where an edge comes to be one process zone from its turn: its speed changes as the root of the time."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from support.paper_scenes import ZONE, cycle

from contact_scene import Adhesion, Force, Hold, Loading, Oscillate, Ramp
from validation.reference.tracking import Options, solve
from validation.reference.tracking.dense_output import cubics
from validation.reference.tracking.edge_path import path_family
from validation.reference.tracking.recorder import Recorder
from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.step_history import RADIUS, HistoryRow, StepHistory
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.zone_from_turn import RootExtrapolation


def _radius(time: float) -> float:
    """A cubic, and from 0 on terms in the powers 3/2 to 5/2 of the time."""
    root = math.sqrt(max(time, 0.0))
    return 1.0 - 0.3 * time + 0.1 * time**2 - 0.05 * time**3 - 0.2 * root**3 + 0.07 * root**4 - 0.03 * root**5


def _row(time: float) -> HistoryRow:
    return time, _radius(time), 2.0 * _radius(time), 0.0


def _history(*times: float) -> StepHistory:
    """Rows at times before 0, at 0, and at ``times``."""
    history = StepHistory()
    for time in (-0.9, -0.6, -0.2, 0.0):
        history.add(_row(time))
    history.rates_follow_root()
    for time in times:
        history.add(_row(time))
    return history


def test_rows_are_extrapolated_over_the_root_of_the_time() -> None:
    """Exact with the rows for it, three since then; by the time alone it is off by hundreds of times that."""
    history = _history(0.01, 0.04, 0.1)
    assert history.expectation(RADIUS).value_after(0.2) == pytest.approx(_radius(0.3), abs=1e-13)
    assert abs(history.extrapolation(RADIUS).value_after(0.2) - _radius(0.3)) > 1e-4
    assert _history().expectation(RADIUS).value_after(0.3) == pytest.approx(
        _radius(0.3) + 0.2 * 0.3**1.5 - 0.07 * 0.3**2 + 0.03 * 0.3**2.5, abs=1e-13
    )


def test_path_of_a_step_has_the_same_middle() -> None:
    rows = _history(0.01, 0.04).expectation(RADIUS)
    assert isinstance(rows, RootExtrapolation)
    path = path_family(rows, 0.2, _radius(0.04)).parabola(_radius(0.24))
    shares = np.array([0.0, 0.5, 1.0])
    np.testing.assert_allclose(path(shares), [_radius(0.04 + 0.2 * share) for share in shares], atol=1e-13)


def test_the_root_is_left_behind() -> None:
    """Once the rows reach less far than the root is away, by a kink, or by a jump."""
    history = _history(0.01, 0.04, 0.1, 0.2)
    assert isinstance(history.expectation(RADIUS), RootExtrapolation)
    for time in (0.3, 0.4, 0.5, 0.6):
        history.add(_row(time))
    assert isinstance(history.expectation(RADIUS), RowExtrapolation)
    history = _history(0.01)
    history.kink()
    assert isinstance(history.expectation(RADIUS), RowExtrapolation)
    history = _history(0.01)
    history.add(_row(0.01))
    assert isinstance(history.expectation(RADIUS), RowExtrapolation)


@pytest.mark.slow
def test_speed_changes_as_the_root_of_the_time() -> None:
    """Smooth up to one zone from the turn; from there on the radius leaves it with the power 3/2."""
    times = np.arange(24.6, 25.3, 0.02)
    trace = solve(cycle(0.002), Options(24, stop_times=tuple(times)))
    radius = np.array([trace.contact_radius[np.abs(trace.time - time).argmin()] for time in times])
    began = float(np.interp(ZONE - trace.contact_radius.max(), -radius, times))
    before, after = times < began, (times > began) & (times < began + 0.1)
    smooth = Polynomial.fit(times[before], radius[before], 5)
    assert np.abs(smooth(times[before]) - radius[before]).max() < 1e-9
    left = smooth(times[after]) - radius[after]
    power = np.polyfit(np.log(times[after] - began), np.log(left), 1)[0]
    assert 1.35 < power < 1.55


def test_steps_end_where_the_edge_is_whole_zones_from_its_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    ends: list[float] = []
    add = Recorder.add

    def noted(self: Recorder, time: float, surface: Surface, force: float) -> None:
        ends.append(surface.radius)
        add(self, time, surface, force)

    monkeypatch.setattr(Recorder, "add", noted)
    trace = solve(cycle(0.002), Options(6))
    radius = np.array(ends)
    for zones in (1, 2):
        assert np.abs(radius - (radius.max() - zones * ZONE)).min() < 1e-14
    assert np.abs(radius - (radius.max() - 3 * ZONE)).min() > 1e-6
    assert trace.counters.rejected_steps <= 4


def _unexpected(self: StepHistory) -> None:
    raise AssertionError("rates do not follow a root here")


TURNS = {
    "stationary oscillation": Loading("relaxed", 0.03, (Oscillate(4e-3, 1.5, 8.0),)),
    "held before": Loading("relaxed", 0.03, (Ramp(0.034, 0.02), Hold(1.0), Ramp(0.02, 0.004))),
    "outwards": Loading("relaxed", 0.03, (Ramp(0.02, 0.01), Ramp(0.034, 0.005))),
    "released load": Loading("relaxed", 0.03, (Force(0.03, 2.0), Force(-1e-3, 3.0))),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TURNS)
def test_other_turns_are_as_accurate(name: str) -> None:
    """Radius and force at some times of a coarse run against a fine one."""
    scene = replace(cycle(0.02), loading=TURNS[name])
    times = tuple(np.linspace(0.1, 0.98, 12) * solve(scene, Options(6)).time[-1])
    coarse, fine = (solve(scene, Options(n, stop_times=times)) for n in (8, 32))
    for column in ("contact_radius", "force"):
        one, two = (
            np.array([getattr(trace, column)[np.abs(trace.time - time).argmin()] for time in times])
            for trace in (coarse, fine)
        )
        assert np.abs(one - two).max() < 1e-5 * np.abs(two).max(), column


@pytest.mark.slow
def test_laws_without_a_fixed_zone_go_without() -> None:
    """An edge that rests at its turn, or whose zone changes, has no place to end a step at."""
    for adhesion in (Adhesion(5e-4, ZONE, work_closing=2e-4), Adhesion(5e-4, stress=0.1)):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(StepHistory, "rates_follow_root", _unexpected)
            trace = solve(replace(cycle(0.02), adhesion=adhesion), Options(4))
        assert trace.outcome.finished, adhesion


def test_rows_in_between_of_a_smooth_stretch_are_of_sixth_order() -> None:
    """Exact for a quintic whose corrections get smaller; a cubic beside a much shorter interval."""
    curve = Polynomial([1.0, 2.0, -1.0, 0.5, -2e-3, 1e-4])
    time = np.arange(8.0)
    at, index = np.array([3.4]), np.array([3])
    values = curve(time)[:, None]
    found = cubics(time, values, np.array([0, 7]), index, at)
    assert found[0, 0] == pytest.approx(curve(3.4), abs=1e-12)
    time[2] = 2.95
    values = curve(time)[:, None]
    found = cubics(time, values, np.array([0, 7]), index, at)
    assert abs(found[0, 0] - curve(3.4)) > 1e-6
