"""Random scenes of seeds, and what is said of the answers: every finding, told from altered answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.synthetic_traces import by_hand

import contact_scene as cs
from benchmarks import random_matrix
from benchmarks.random_matrix import Answer, Finding, JudgedScene, Settings, judge
from benchmarks.random_scenes import FAMILIES, RandomScene, random_scene, rounded
from benchmarks.trace_invariants import broken
from validation import solvers
from validation.measure.observables import measure
from validation.runs.pool import Task, TaskEnding, TaskResult
from validation.runs.run import Run
from validation.solvers.contact_range import largest_contact_radius

SCENE = cs.Scene(
    cs.Material(0.75, 0.5),
    cs.Sphere(1.0),
    cs.Loading("relaxed", 0.02, (cs.Ramp(-0.1, 0.01),)),
    cs.Adhesion(1e-3, 0.01),
)
CHOSEN = RandomScene(1, "retraction", SCENE)


def answer(excursion: float = 0.1, kind: cs.OutcomeKind = cs.OutcomeKind.COMPLETED) -> cs.Trace:
    """A small movement on a large mean, to the last penetration of the loading."""
    t = np.linspace(0.0, 1.0, 51)
    energies = {"stored_energy": 1.0, "external_work": t, "dissipated_energy": t}
    rows = {"penetration": 0.02 - 0.12 * t, "contact_radius": 0.2, "extra": {"branch_dissipation": 0.1 * t}}
    return by_hand(t, kind, "reference", force=10.0 + excursion * np.sin(6.0 * t), **rows, **energies)


def result(solver: str, trace: cs.Trace | None, error: float = 1e-3, **how) -> TaskResult:
    task = Task("key", "label", print, (CHOSEN.case, solver))
    if trace is None:
        return TaskResult(task, how.pop("value", None), **how)
    run = Run("seed", solver, trace, measures=measure(trace, SCENE, 0.0))
    return TaskResult(
        task, replace(run, errors=dict.fromkeys([*run.measures, "force", "contact_radius"], error))
    )


def judged(
    mine: TaskResult, base: cs.Trace | None = None, compared: bool = False, error: float = 1e-5
) -> Answer:
    """The boundary elements' answer beside a reference of small error."""
    reference = result("reference", base or answer(), error)
    results = {"bem": mine, "fem": result("fem", answer()), "reference": reference}
    found = judge(CHOSEN, {name: results[name] for name in solvers.SOLVERS}, compared)
    return {one.solver: one for one in found.answers}["bem"]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_seed_is_always_the_same_scene_and_most_seeds_have_one(family):
    assert random_scene(family, 7) == random_scene(family, 7)
    found = [one for one in (random_scene(family, seed) for seed in range(12)) if one is not None]
    assert len(found) > 8
    assert len({one.kind for one in found}) > 2
    if family == "short-zones":
        assert all(one.scene.adhesion.zone < 1e-2 * largest_contact_radius(one.scene) for one in found)


def test_plain_scenes_have_round_numbers():
    found = [one.scene for one in (random_scene("plain", seed) for seed in range(20)) if one is not None]
    laws = [scene.adhesion for scene in found if scene.adhesion is not None]
    speeds = [step.rate for scene in found for step in scene.loading.steps if isinstance(step, cs.Ramp)]
    assert laws
    assert all(number == rounded(number) for law in laws for number in (law.work, law.zone))
    assert all(speed == rounded(speed) for speed in speeds)


@pytest.mark.parametrize(
    ("trace", "error", "finding"),
    [
        (answer(0.13), 5e-5, Finding.WRONG),
        (answer(0.13), 1e-2, Finding.TOLD),
        (answer(0.102), 5e-5, Finding.UNDERSTATED),
        (answer(0.102), 1e-3, Finding.AGREES),
        (answer(0.102), 1e-2, Finding.LOOSE),
        (answer(kind=cs.OutcomeKind.NO_EQUILIBRIUM), 1e-3, Finding.DECLINED),
        (answer(kind=cs.OutcomeKind.DETACHED), 1e-3, Finding.OTHER_ENDING),
        (replace(answer(), time=answer().time[::-1].copy()), 1e-3, Finding.IMPROPER),
        (replace(answer(), extra={"branch_dissipation": -100.0 * answer().time}), 1e-3, Finding.IMPROPER),
    ],
)
def test_a_movement_counts_relative_to_itself(trace, error, finding):
    """Three per cent of a swing of a hundredth of the mean: 3e-4 of the mean."""
    found = judged(result("bem", trace, error))
    assert found.finding is finding
    if finding is Finding.WRONG:
        assert (found.quantity, found.difference) == ("force", pytest.approx(0.3 * 0.72 / 1.95, rel=0.1))


def test_runs_without_an_answer():
    hung = judged(result("bem", None, failure="no answer", ending=TaskEnding.TIMED_OUT))
    died = judged(result("bem", None, failure="signal 11", ending=TaskEnding.DIED))
    refused = judged(result("bem", None, value=Run("seed", "bem", failure="not this one", refused=True)))
    found = [one.finding for one in (hung, died, refused)]
    assert found == [Finding.HUNG, Finding.CRASHED, Finding.DECLINED]


def test_what_a_comparison_rejects_is_a_finding_unless_there_is_a_worse_one():
    loose = judged(result("bem", answer(), error=0.05), compared=True, error=1e-3)
    assert loose.finding is Finding.FAILED
    assert "F(t), RMS" in loose.note
    off = judged(result("bem", answer(0.13), 5e-5), compared=True, error=1e-3)
    assert off.finding is Finding.WRONG
    assert "F(t), movement" in off.note
    ended = answer(kind=cs.OutcomeKind.NO_EQUILIBRIUM)
    assert judged(result("bem", answer()), base=ended, compared=True).finding is Finding.NO_REFERENCE


@pytest.mark.parametrize("miss", [0.0, 4e-16, 1e-9])
def test_the_last_penetration_is_met_to_a_rounding_error_of_the_way(miss):
    trace = answer()
    depth = trace.penetration.copy()
    depth[-1] += miss * np.abs(depth).max()
    found = broken(SCENE, replace(trace, penetration=depth))
    assert ("the last penetration is not the prescribed one" in found) == (miss > 1e-12)


def test_estimates_are_asked_for_where_they_decide(monkeypatch):
    """First without estimates; one run of bem is off by more than it may be, and is asked again."""
    asked: list[tuple[str, bool]] = []

    def carried_out(numbered, executor):
        for number, task in numbered:
            solver, estimate = task.arguments[1], task.function.keywords["estimate"]
            asked.append((solver, estimate))
            mine = result(solver, answer(0.13 if solver == "bem" else 0.1), 1e-2 if solver == "bem" else 1e-5)
            yield number, mine if estimate else replace(mine, value=replace(mine.value, errors={}))

    monkeypatch.setattr(random_matrix, "completed_tasks", carried_out)
    found = random_matrix.answers(CHOSEN, Settings(coarse=True, screened=True), None)
    assert set(asked[:3]) == {(name, name == "reference") for name in solvers.SOLVERS}
    assert asked[3:] == [("bem", True)]
    assert {one.solver: one.finding for one in found.answers}["bem"] is Finding.TOLD


def test_a_stopped_matrix_goes_on_shard_by_shard_and_keeps_its_settings(tmp_path, monkeypatch, capsys):
    asked = []

    def answers(chosen, settings, executor):
        asked.append(chosen.seed)
        died = Answer("bem", Finding.CRASHED, note="signal 11")
        return JudgedScene(chosen.seed, chosen.kind, "sphere", (died,))

    monkeypatch.setattr(random_matrix, "answers", answers)
    monkeypatch.setattr(random_matrix, "random_scene", lambda family, seed: replace(CHOSEN, seed=seed))
    command = ["--out", str(tmp_path), "--first", "1"]
    assert random_matrix.main([*command, "--count", "2"]) == 1
    assert random_matrix.main([*command, "--count", "6", "--shard", "0/2"]) == 1
    assert random_matrix.main([*command, "--count", "6", "--shard", "1/2"]) == 1
    assert asked == [1, 2, 4, 6, 3, 5]
    assert "| crashed | 6 | 0 | 0 |" in (tmp_path / "table.md").read_text()
    assert (tmp_path / "scenes" / "seed-5.toml").exists()
    assert random_matrix.main([*command, "--family", "plain"]) == 2
    assert "--out" in capsys.readouterr().err


def test_a_kink_of_the_loading_is_no_difference():
    """Of a punch that is pressed and held: rows of one solver alone tell no corner from a bend."""
    chosen = random_scene("swings", 22006)
    results = {}
    for name in ("bem", "reference"):
        trace = solvers.SOLVERS[name].solve(chosen.scene, 4)
        run = Run("seed", name, trace, measures=measure(trace, chosen.scene, 0.0))
        run = replace(run, errors=dict.fromkeys([*run.measures, "force", "contact_radius"], 1e-3))
        results[name] = TaskResult(Task("key", "label", print, (chosen.case, name)), run)
    assert {one.finding for one in judge(chosen, results).answers} == {Finding.AGREES}
