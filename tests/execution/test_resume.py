"""A run that is stopped and gone on with equals the one that never was, for every solver, to the last bit."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import cache, partial
from itertools import product

import pytest
from support.resumable_runs import RICH, SHORT, TIMES, bem, fem, front
from support.stopped_runs import Stop, assert_beginning, assert_same, in_parts
from support.table_rows import sampled

from contact_scene import Material, OutcomeKind
from validation import cases, solvers
from validation.execution import checked_pickle

SOLVERS = {
    "bem": partial(bem, RICH),
    "bem uniform": partial(bem, RICH, annuli="uniform"),
    "fem": partial(fem, RICH),
    "reference": partial(front, RICH),
    "reference elastic": partial(front, replace(RICH, material=Material(0.75, 0.5))),
}

BEGUN = replace(RICH, loading=replace(RICH.loading, steps=RICH.loading.steps[:2]))
"""Its ramp and its hold."""


@cache
def whole_run(name):
    """The run that is looked at but never stopped, and the number of looks."""
    counting = Stop()
    return SOLVERS[name](counting), counting.looks


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "reference" else pytest.mark.slow) for name in SOLVERS],
)
def test_stopped_again_and_again(name):
    whole, looks = whole_run(name)
    assert whole.outcome.finished
    assert len(whole.profiles) == len(TIMES)
    chance = random.Random(name)
    few = looks // 3
    strides = [1, *(chance.randint(1, 2 * few) for _ in range(looks))]
    left, resumed = in_parts(SOLVERS[name], strides)
    assert len(left) >= 2
    for part in left:
        assert_beginning(part, whole)
    assert_same(resumed, whole)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if " " in name else ()) for name in SOLVERS],
)
def test_what_is_put_back_is_what_was_taken(name):
    stop = Stop(60)
    SOLVERS[name](stop)
    again = Stop(1, stop.data)
    SOLVERS[name](again)
    kept, found = (checked_pickle.dumps(checked_pickle.loads(data)) for data in (stop.data, again.data))
    assert len(kept) > 1000
    assert found == kept


def test_the_very_first_and_the_very_last_look():
    counting = Stop()
    whole = front(BEGUN, counting)
    for at in (1, counting.looks):
        (part,), resumed = in_parts(partial(front, BEGUN), [at])
        assert_beginning(part, whole)
        assert_same(resumed, whole)


@pytest.mark.parametrize("name", ["bem", "fem", "reference"])
def test_a_stopped_run_is_not_said_to_be_done(name):
    shares: list[float] = []
    trace = solvers.solver(name).solve(RICH, 4, monitor=Stop(30), progress=shares.append)
    assert trace.outcome.kind is OutcomeKind.INTERRUPTED
    assert 0.0 < shares[-1] < 1.0


def test_a_kept_state_is_not_the_run():
    """What goes on afterwards does not reach into what was kept: it can be gone on with twice."""
    stop = Stop(30)
    front(BEGUN, stop)
    first, second = (front(BEGUN, Stop(None, stop.data)) for _ in range(2))
    assert_same(first, second)


def test_looking_changes_nothing():
    class Curious:
        start_state = None

        def continue_set_up(self):
            return True

        def continue_run(self, state):
            state()
            return True

    assert_same(front(BEGUN, Curious()), front(BEGUN))


@pytest.mark.slow
@pytest.mark.parametrize("path", ["auto", "quadrature"])
def test_history_in_the_volume(path):
    run = partial(fem, SHORT if path == "auto" else BEGUN, path=path)
    counting = Stop()
    whole = run(counting)
    left, resumed = in_parts(run, [1, counting.looks // 2])
    assert len(left) == 2
    assert_same(resumed, whole)


@pytest.mark.parametrize(
    ("name", "solver"),
    sampled(
        product(
            ["cycle-v0.02", "adhesionless-cycle", "three-branches", "force-4", "cycle-si", "rated-edge-si"],
            ["bem", "fem", "reference"],
        ),
        4,  # each solver among them
    ),
)
def test_built_in_scenes(name, solver):
    run = partial({"bem": bem, "fem": fem, "reference": front}[solver], cases.load(name).scene)
    counting = Stop()
    whole = run(counting)
    chance = random.Random(name + solver)
    left, resumed = in_parts(run, [chance.randint(1, counting.looks // 2) for _ in range(4)])
    assert left
    assert_same(resumed, whole)
