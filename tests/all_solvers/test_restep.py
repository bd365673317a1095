"""Redoing a rejected step equals not having tried it: trials that are thrown away leave nothing behind.

Before every step another one, longer or shorter, is tried and thrown away. Only the work counters may tell.
"""

from __future__ import annotations

from contextlib import suppress
from itertools import cycle

import pytest
from support.resumable_runs import APART, RICH, SHORT, bem, fem, front, uninterrupted
from support.stopped_runs import assert_same_columns

from bem_solver.stepping import Stepper, Unresolvable
from fem_solver.stepping import Run as FemRun
from validation.reference.tracking.stepping import Run as FrontRun


def shares():
    """How long the vain trials are, in steps."""
    return cycle((0.37, 1.0, 2.5))


@pytest.fixture
def twice(monkeypatch):
    """Every step of every solver is preceded by a vain one; counts them."""
    vain = {"bem": 0, "fem": 0, "reference": 0}
    share = shares()
    attempt, take, advance = Stepper._attempt, FemRun._step, FrontRun.attempt

    def bem_attempt(self, piece, parameter, step):
        with suppress(Unresolvable, FloatingPointError):  # it may come to nothing
            attempt(self, piece, parameter, min(next(share) * step, piece.length - parameter))
        vain["bem"] += 1
        return attempt(self, piece, parameter, step)

    def fem_step(self, segment, clock):
        dt = next(share) * clock.dt
        ahead = min(clock.time + dt, segment.end)
        problem, _ = self._problem(dt, segment.control, segment.value(ahead))
        found = self.law.seek(problem, self.state.s, *self._travel(self.state))
        slopes, scales = self._slopes(problem, found.s, dt)
        self.judge.error(slopes, scales, dt)
        problem.forces(found.s)
        self._count(problem)
        vain["fem"] += 1
        take(self, segment, clock)

    def front_attempt(self, segment, travel=0.0):
        left = segment.end - self.time
        duration = min(next(share) * 1e-2 * left, left)
        trial = advance(self, segment, travel)
        a0 = self.surface.radius
        if a0 > 0.0:
            found = trial.edge(duration, a0, max(0.9 * a0, self.law.lowest), 1.1 * a0)
            trial.surface_at(duration, found.radius)
        vain["reference"] += 1
        return advance(self, segment, travel)

    def put():
        monkeypatch.setattr(Stepper, "_attempt", bem_attempt)
        monkeypatch.setattr(FemRun, "_step", fem_step)
        monkeypatch.setattr(FrontRun, "attempt", front_attempt)
        return vain

    return put


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
def test_a_step_tried_in_vain_in_the_volume(twice):
    assert SHORT.material is APART
    once = fem(SHORT)
    twice()
    again = fem(SHORT)
    assert again.counters.factorisations > once.counters.factorisations  # other steps, other moduli
    assert_same_columns(again, once)
