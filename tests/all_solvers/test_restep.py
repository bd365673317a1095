"""Redoing a rejected step equals not having tried it: trials that are thrown away leave nothing behind.

Before every step another one, longer or shorter, is tried and thrown away. Only the work counters may tell.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import cycle

import pytest

import bem_solver
import fem_solver
from bem_solver.step import TrialStep
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    Ramp,
    RunMonitor,
    Scene,
    Sphere,
    Trace,
)
from fem_solver.run import NodeReleaseRun
from validation import solvers
from validation.reference import path as reference
from validation.reference.path.continuation import Continuation
from validation.reference.path.numerics import DEGREE
from validation.solvers.finite_elements import FiniteElements

TIMES = (0.0, 0.05, 0.35)  # of profiles: the start, within the approach, within the oscillation
TWO = Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(3.75, 1.0)))
APART = Material(0.75, 0.4, (Branch(6.75, 1.0),), BulkRelaxation())
LOADING = Loading(
    "jump-in",
    0.0,
    (
        Ramp(0.01, 0.1),
        Hold(0.1),
        Oscillate(1e-3, 30.0, 0.2),
        Force(-5e-4, 0.05),  # jumps
        Ramp(-0.5, 0.3),
    ),
)
RICH = Scene(TWO, Sphere(1.0), LOADING, Adhesion(5e-4, 0.02))
SHORT = Scene(APART, Sphere(1.0), Loading("relaxed", 0.02, (Ramp(0.018, 0.05),)), Adhesion(5e-4, 0.02))


def bem(scene: Scene, monitor: RunMonitor | None = None, **options) -> Trace:
    return bem_solver.solve(scene, bem_solver.Options(4, profile_times=TIMES, **options), None, monitor)


def fem(scene: Scene, monitor: RunMonitor | None = None, **options) -> Trace:
    fineness = 4 if scene.is_adhesive else 1
    asked = fem_solver.Options(5e-3, profile_times=TIMES, **options)
    return fem_solver.solve(scene, FiniteElements().mesh(scene, fineness), asked, None, monitor)


def front(scene: Scene, monitor: RunMonitor | None = None) -> Trace:
    return reference.solve(scene, reference.Options(5, profile_times=TIMES), None, monitor)


@cache
def uninterrupted(solve: Callable[..., Trace]) -> Trace:
    """The whole run of ``RICH`` by ``bem``, ``fem`` or ``front``, computed once in a process."""
    return solve(RICH)


def assert_same_columns(found: Trace, wanted: Trace) -> None:
    """All columns, to the last bit."""
    columns = wanted.columns()
    assert list(found.columns()) == list(columns)
    for name, column in found.columns().items():
        assert column.tobytes() == columns[name].tobytes(), name


def stopped(solve: Callable[..., Trace], after: int) -> Trace:
    """A run of ``RICH`` that is stopped after so many looks of its monitor."""
    looks = iter(range(after))
    return solve(RICH, lambda: next(looks, None) is not None)


def shares():
    """How long the vain trials are, in steps."""
    return cycle((0.37, 1.0, 2.5))


@pytest.fixture
def twice(monkeypatch):
    """Every step of every solver is preceded by a vain one; counts them."""
    vain = {"bem": 0, "fem": 0, "reference": 0}
    share = shares()
    result, node_trial, trial = TrialStep.result, NodeReleaseRun.trial_step, Continuation.trial

    def bem_result(self):
        left = self.interval.length - self.state.parameter
        with suppress(FloatingPointError):  # it may come to nothing
            result(replace(self, step=min(next(share) * self.step, left)))
        vain["bem"] += 1
        return result(self)

    def fem_trial(self, segment, dt, end):
        longer = next(share) * dt
        node_trial(self, segment, longer, min(self.time + longer, segment.end))
        vain["fem"] += 1
        return node_trial(self, segment, dt, end)

    def front_trial(self, radius, s, order=DEGREE):
        elsewhere = self.state.radius + next(share) * (radius - self.state.radius)
        tried = trial(self, max(elsewhere, self.least_radius), s, order)
        self.arrive(tried, next(share) * self.h * self.T).after()
        vain["reference"] += 1
        return trial(self, radius, s, order)

    def put():
        monkeypatch.setattr(TrialStep, "result", bem_result)
        monkeypatch.setattr(NodeReleaseRun, "trial_step", fem_trial)
        monkeypatch.setattr(Continuation, "trial", front_trial)
        return vain

    return put


@pytest.mark.slow
@pytest.mark.parametrize(("name", "solve"), [("bem", bem), ("fem", fem), ("reference", front)])
def test_a_step_tried_in_vain_leaves_nothing(twice, name, solve):
    once = uninterrupted(solve)
    vain = twice()
    again = solve(RICH)
    assert vain[name] >= once.counters.steps // 2
    assert again.counters.linear_solves + again.counters.closure_evaluations > (
        once.counters.linear_solves + once.counters.closure_evaluations
    )
    assert again.counters.steps == once.counters.steps
    assert again.counters.rejected_steps == once.counters.rejected_steps
    assert again.events == once.events
    assert_same_columns(again, once)


@pytest.mark.slow
def test_a_step_tried_in_vain_where_bulk_relaxes_apart(twice):
    assert SHORT.material is APART
    once = fem(SHORT)
    twice()
    again = fem(SHORT)
    assert again.counters.closure_evaluations > once.counters.closure_evaluations
    assert_same_columns(again, once)


@pytest.mark.parametrize(("name", "solve"), [("bem", bem), ("fem", fem), ("reference", front)])
def test_a_stopped_run_is_the_beginning_of_a_longer_one(name, solve):
    looks, shares = iter(range(30)), []
    part = solvers.solver(name).solve(
        RICH, 4, monitor=lambda: next(looks, None) is not None, progress=shares.append
    )
    assert part.outcome.kind is OutcomeKind.INTERRUPTED
    assert part.outcome.time == part.time[-1]
    assert 0.0 < shares[-1] < 1.0
    part, whole = (stopped(solve, looks) for looks in (30, 60))
    for column in ("time", "penetration", "force", "contact_radius", "stored_energy"):
        mine, theirs = part.columns()[column], whole.columns()[column]
        assert 3 < len(mine) < len(theirs)
        if (name, column) == ("bem", "stored_energy"):  # by slopes through the rows on both sides
            mine = mine[:-3]
        assert mine.tobytes() == theirs[: len(mine)].tobytes(), column
