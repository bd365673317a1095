"""A run that is stopped and gone on with equals the one that never was, for every solver, to the last bit."""

from __future__ import annotations

import random
from functools import partial

import pytest
from support.stopped_runs import Stop, assert_beginning, assert_same, in_parts

import bem_solver
import fem_solver
from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    RunMonitor,
    Scene,
    Sphere,
    Trace,
)
from validation import cases, reference
from validation.contact_range import mesh_for
from validation.execution import checked_pickle

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


def bem(scene: Scene, watch: RunMonitor | None = None, **options) -> Trace:
    return bem_solver.solve(scene, bem_solver.Options(4, profile_times=TIMES, **options), None, watch)


def fem(scene: Scene, watch: RunMonitor | None = None, **options) -> Trace:
    fineness = 4 if scene.is_adhesive else 1
    asked = fem_solver.Options(fineness, 5e-3, TIMES, **options)
    return fem_solver.solve(scene, mesh_for(scene, fineness), asked, None, watch)


def front(scene: Scene, watch: RunMonitor | None = None) -> Trace:
    return reference.solve(scene, reference.Options(5, profile_times=TIMES), None, watch)


SOLVERS = {
    "bem": partial(bem, RICH),
    "bem uniform": partial(bem, RICH, annuli="uniform"),
    "fem": partial(fem, RICH),
    "reference": partial(front, RICH),
}


@pytest.mark.parametrize("name", SOLVERS)
def test_stopped_again_and_again(name):
    run = SOLVERS[name]
    counting = Stop()
    whole = run(counting)
    assert whole.outcome.finished
    assert len(whole.profiles) == len(TIMES)
    chance = random.Random(name)
    few = counting.looks // 3
    strides = [1, *(chance.randint(1, 2 * few) for _ in range(counting.looks))]
    left, resumed = in_parts(run, strides)
    assert len(left) >= 2
    for part in left:
        assert_beginning(part, whole)
    assert_same(resumed, whole)


@pytest.mark.parametrize("name", SOLVERS)
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
    whole = front(RICH, counting)
    for at in (1, counting.looks):
        (part,), resumed = in_parts(partial(front, RICH), [at])
        assert_beginning(part, whole)
        assert_same(resumed, whole)


def test_a_kept_state_is_not_the_run():
    """What goes on afterwards does not reach into what was kept: it can be gone on with twice."""
    stop = Stop(100)
    front(RICH, stop)
    first, second = (front(RICH, Stop(None, stop.data)) for _ in range(2))
    assert_same(first, second)


def test_looking_changes_nothing():
    class Curious:
        start_state = None

        def continue_run(self, state):
            state()
            return True

    assert_same(front(RICH, Curious()), front(RICH))


@pytest.mark.slow
@pytest.mark.parametrize("path", ["auto", "quadrature"])
def test_history_in_the_volume(path):
    run = partial(fem, SHORT if path == "auto" else RICH, path=path)
    counting = Stop()
    whole = run(counting)
    left, resumed = in_parts(run, [1, counting.looks // 2])
    assert len(left) == 2
    assert_same(resumed, whole)


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["bem", "fem", "reference"])
@pytest.mark.parametrize(
    "name", ["cycle-v0.02", "adhesionless-cycle", "three-branches", "force-4", "cycle-si"]
)
def test_built_in_scenes(name, solver):
    run = partial({"bem": bem, "fem": fem, "reference": front}[solver], cases.load(name).scene)
    counting = Stop()
    whole = run(counting)
    chance = random.Random(name + solver)
    left, resumed = in_parts(run, [chance.randint(1, counting.looks // 2) for _ in range(4)])
    assert left
    assert_same(resumed, whole)
