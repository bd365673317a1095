"""Random scenes of seeds, and what is said of the answers: every finding, told from altered answers."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from contact_scene import Adhesion, Counters, Hold, Outcome, OutcomeKind, Ramp, Scene, Sphere, Table, Trace
from validation import solvers
from validation.execution.runs import Run
from validation.execution.tasks import Task, TaskEnding, TaskResult
from validation.measure.scalars import measure
from validation.stability import (
    random_instruments,
    random_matrix,
    random_plain,
    random_report,
    random_runs,
    random_swings,
    trace_invariants,
)
from validation.stability.random_answers import AnswerFinding, JudgedScene, RandomSceneAnswer, examine
from validation.stability.random_compared import examine_compared
from validation.stability.random_instruments import random_instrument
from validation.stability.random_matrix import table
from validation.stability.random_numbers import rounded
from validation.stability.random_scenes import LOADINGS, random_scene, random_short_zone
from validation.stability.random_swings import random_swing

CHOSEN = next(
    one for one in map(random_scene, range(1, 100)) if one.kind == "retraction" and not one.profile_times
)
SCENE = replace(CHOSEN.scene, adhesion=Adhesion(1e-3, 0.01))


def answer(excursion: float = 0.1, kind: OutcomeKind = OutcomeKind.COMPLETED) -> Trace:
    """A small movement on a large mean, to the last penetration of the loading."""
    t = np.linspace(0.0, 1.0, 51)
    (ramp,) = SCENE.loading.steps
    assert isinstance(ramp, Ramp)
    depth = SCENE.loading.penetration + (ramp.to - SCENE.loading.penetration) * t
    force = 10.0 + excursion * np.sin(6.0 * t)
    energy = np.ones_like(t)
    extra = {"branch_dissipation": 0.1 * t}
    outcome = Outcome(kind, "as told", 1.0)
    return Trace(
        "reference",
        t,
        depth,
        force,
        np.full_like(t, 0.2),
        energy,
        energy * t,
        energy * t,
        outcome,
        Counters(),
        extra,
    )


def result(solver: str, trace: Trace | None, error: float = 1e-3, **how) -> TaskResult:
    task = Task("key", "label", print, (CHOSEN.case, solver))
    if trace is None:
        return TaskResult(task, how.pop("value", None), **how)
    run = Run("seed", solver, trace, measures=measure(trace, SCENE, 0.0))
    return TaskResult(
        task, replace(run, errors=dict.fromkeys([*run.measures, "force", "contact_radius"], error))
    )


def judged(mine: TaskResult, base: Trace | None = None) -> RandomSceneAnswer:
    """The boundary elements' answer beside a reference of small error."""
    reference = result("reference", base or answer(), 1e-5)
    results = {"bem": mine, "fem": result("fem", answer()), "reference": reference}
    found = examine(replace(CHOSEN, scene=SCENE), {name: results[name] for name in solvers.SOLVERS})
    return {one.solver: one for one in found.answers}["bem"]


@pytest.fixture
def asked(monkeypatch):
    """Solvers that a matrix asks for, each of which dies."""
    asked: list[str] = []

    def carried_out(numbered, executor, outstanding):
        for number, task in numbered:
            asked.append(task.arguments[1])
            yield number, result(task.arguments[1], None, failure="died", ending=TaskEnding.DIED)

    monkeypatch.setattr(random_runs, "completed_tasks", carried_out)
    monkeypatch.setattr(random_matrix, "processes", NoProcesses)
    return asked


def test_a_seed_is_always_the_same_scene_and_every_kind_comes():
    assert random_scene(7) == random_scene(7)
    many = [random_scene(seed) for seed in range(1, 120)]
    assert {one.kind for one in many} == set(LOADINGS)
    spheres = [one.scene for one in many if isinstance(one.scene.indenter, Sphere) and one.scene.adhesion]
    zones = [scene.adhesion.zone / scene.indenter.radius for scene in spheres]
    assert max(zones) / min(zones) > 100.0
    radii = [one.scene.indenter.radius for one in many if isinstance(one.scene.indenter, Sphere)]
    assert min(radii) < 1e-4 < 1.0 <= max(radii)
    assert any(one.profile_times for one in many)


def test_short_zones_are_short_and_a_family_of_their_own():
    assert random_short_zone(7) == random_short_zone(7)
    assert random_matrix.FAMILIES["short-zones"](7) == random_short_zone(7)
    spheres = [one for one in map(random_short_zone, range(1, 120)) if isinstance(one.scene.indenter, Sphere)]
    zones = np.array([one.scene.adhesion.zone / one.scene.indenter.radius for one in spheres])
    assert 3e-9 < zones.min() < 3e-7
    assert 3e-6 < zones.max() < 3e-4
    assert {one.kind for one in spheres} == set(LOADINGS)


def test_swings_go_to_and_fro_over_short_zones():
    assert random_swing(7) == random_swing(7)
    assert random_matrix.FAMILIES["swings"](7) == random_swing(7)
    many = [random_swing(seed) for seed in range(1, 80)]
    assert {one.kind for one in many} == set(random_swings.LOADINGS)
    spheres = [one.scene for one in many if isinstance(one.scene.indenter, Sphere)]
    zones = [scene.adhesion.zone / scene.indenter.radius for scene in spheres]
    assert 1e-8 < min(zones) < 1e-6 < 1e-4 < max(zones) < 1e-2
    ramps = [one.scene.loading.steps for one in many if one.kind in {"triangles", "forces"}]
    assert all(sum(not isinstance(step, Hold) for step in steps) >= 4 for steps in ramps)
    assert any(isinstance(step, Hold) for steps in ramps for step in steps)


def test_plain_scenes_have_round_numbers_every_test_and_every_tip():
    assert random_plain.random_plain(7) == random_plain.random_plain(7)
    assert random_matrix.FAMILIES["plain"](7) == random_plain.random_plain(7)
    many = [random_plain.random_plain(seed) for seed in range(1, 200)]
    scenes = [one.scene for one in many]
    assert {one.kind for one in many} == set(random_plain.LOADINGS)
    tips = {"sphere", "cone", "flat-punch", "power-law", "profile"}
    assert {scene.indenter.shape for scene in scenes} == tips
    assert {scene.loading.start for scene in scenes} == {"jump-in", "relaxed", "snap-in"}
    counts = {len(scene.material.branches) for scene in scenes}
    assert {0, 1, 2, 3} < counts
    laws = [scene.adhesion for scene in scenes if scene.adhesion is not None]
    assert 0.25 < len(laws) / len(scenes) < 0.42
    speeds = [step.rate for scene in scenes for step in scene.loading.steps if isinstance(step, Ramp)]
    numbers = [*speeds, *(law.work for law in laws), *(law.zone for law in laws)]
    assert all(number == rounded(number) for number in numbers)


@pytest.mark.parametrize(
    ("value", "near"),
    [(1.4, 1.0), (1.5, 2.0), (3.0, 2.0), (3.3, 5.0), (8.0, 10.0), (4e-7, 5e-7), (1e-7, 1e-7)],
)
def test_round_numbers_are_the_nearest_in_the_logarithm(value, near):
    assert rounded(value) == near


def test_solvers_may_be_left_out_but_not_the_reference(tmp_path, asked):
    seed = next(seed for seed in range(1, 6) if random_matrix._possible(seed, "short-zones"))
    arguments = ["--out", str(tmp_path), "--seeds", str(seed), "--family", "short-zones", "--solvers"]
    assert random_matrix.main([*arguments, "bem"]) == 1
    assert asked == ["bem", "reference"]
    assert random_matrix.main([*arguments, "fem"]) == 2  # the folder keeps its settings


def test_instruments_have_every_part_and_a_stream_of_their_own():
    assert random_instrument(7) == random_instrument(7)
    many = [random_instrument(seed).scene for seed in range(1, 60)]
    assert {random_instrument(seed).kind for seed in range(1, 60)} == set(random_instruments.LOADINGS)
    laws = [scene.adhesion for scene in many if scene.adhesion is not None]
    assert {law.stress is None for law in laws} == {True, False}
    assert {law.work_closing is None for law in laws} == {True, False}
    assert {law.rate is None for law in laws} == {True, False}
    assert {scene.machine is None for scene in many} == {True, False}
    steps = [step for scene in many for step in scene.loading.steps]
    levels = {step.trigger.quantity for step in steps if step.trigger is not None}
    assert levels == {"force", "radius", "penetration"}
    records = {step.quantity for step in steps if isinstance(step, Table) and step.interpolation == "cubic"}
    assert records == {"force", "penetration"}
    assert random_matrix.FAMILIES["usual"](7) == random_scene(7)


def test_a_movement_counts_relative_to_itself():
    """Two per cent of a swing of a hundredth of the mean: 2e-4 of the mean, by twice what the run says."""
    off = judged(result("bem", answer(0.13), 5e-5))
    assert off.finding is AnswerFinding.WRONG
    assert off.quantity == "force"
    assert off.difference == pytest.approx(0.3 * 0.72 / 1.95, rel=0.1)
    assert judged(result("bem", answer(0.13), 1e-2)).finding is AnswerFinding.TOLD
    assert judged(result("bem", answer(0.102), 5e-5)).finding is AnswerFinding.UNDERSTATED
    assert judged(result("bem", answer(0.102), 1e-3)).finding is AnswerFinding.AGREES
    assert judged(result("bem", answer(0.102), 1e-2)).finding is AnswerFinding.LOOSE


def compared(mine: TaskResult, base: Trace | None = None) -> dict[str, RandomSceneAnswer]:
    """All answers, held to the checks of a comparison as well."""
    results = {
        "bem": mine,
        "fem": result("fem", answer()),
        "reference": result("reference", base or answer()),
    }
    found = examine_compared(replace(CHOSEN, scene=SCENE), results)
    return {one.solver: one for one in found.answers}


def test_what_a_comparison_rejects_is_a_finding_unless_there_is_a_worse_one():
    found = compared(result("bem", answer()))
    assert {one.finding for one in found.values()} == {AnswerFinding.AGREES}
    loose = compared(result("bem", answer(), error=0.05))["bem"]
    assert judged(result("bem", answer(), error=0.05)).finding is AnswerFinding.LOOSE
    assert loose.finding is AnswerFinding.FAILED
    assert "F(t), RMS: the run estimates its own error at 0.05" in loose.note
    off = compared(result("bem", answer(0.13), 5e-5))["bem"]
    assert off.finding is AnswerFinding.WRONG
    assert "F(t), movement" in off.note
    silent = compared(result("bem", answer()), base=answer(kind=OutcomeKind.NO_EQUILIBRIUM))
    assert silent["reference"].finding is AnswerFinding.FAILED
    assert silent["bem"].finding is AnswerFinding.NO_REFERENCE


def test_a_scene_that_all_solvers_refuse_is_not_compared():
    refusal = {"value": Run("seed", "bem", failure="not this one", refused=True)}
    results = {name: result(name, None, **refusal) for name in solvers.SOLVERS}
    found = examine_compared(replace(CHOSEN, scene=SCENE), results)
    assert {one.finding for one in found.answers} == {AnswerFinding.DECLINED}


def test_other_findings():
    ended = answer(kind=OutcomeKind.NO_EQUILIBRIUM)
    assert judged(result("bem", ended)).finding is AnswerFinding.DECLINED
    assert judged(result("bem", answer(), 1e-3), base=ended).finding is AnswerFinding.NO_REFERENCE
    assert judged(result("bem", answer(kind=OutcomeKind.DETACHED))).finding is AnswerFinding.OTHER_ENDING
    time_back = replace(answer(), time=answer().time[::-1].copy())
    assert judged(result("bem", time_back)).finding is AnswerFinding.IMPROPER
    gaining = replace(answer(), extra={"branch_dissipation": -100.0 * answer().time})
    assert "gain" in judged(result("bem", gaining)).note
    hung = result("bem", None, failure="no answer", ending=TaskEnding.TIMED_OUT)
    assert judged(hung).finding is AnswerFinding.HUNG
    died = result("bem", None, failure="signal 11", ending=TaskEnding.DIED)
    assert judged(died).note == "signal 11"
    refused = result("bem", None, value=Run("seed", "bem", failure="not this one", refused=True))
    assert judged(refused).finding is AnswerFinding.DECLINED


@pytest.mark.parametrize("miss", [0.0, 4e-16, 1e-9])
def test_the_last_penetration_is_met_to_a_rounding_error_of_the_way(miss):
    trace = answer()
    depth = trace.penetration.copy()
    depth[-1] += miss * np.abs(depth).max()
    found = trace_invariants.broken(SCENE, replace(trace, penetration=depth))
    assert ("the last penetration is not the prescribed one" in found) == (miss > 1e-12)


@pytest.mark.parametrize(
    ("swing", "error", "finding"),
    [
        (0.104, 1e-2, AnswerFinding.LOOSE),
        (0.13, 1e-2, AnswerFinding.TOLD),
        (0.13, 1e-5, AnswerFinding.WRONG),
    ],
)
def test_estimates_are_asked_for_where_they_decide(swing, error, finding):
    """First without estimates; one run of bem is off by more than it may be, and is asked again."""
    asked: list[tuple[str, bool]] = []

    def carried_out(numbered, executor, outstanding):
        for number, task in numbered:
            _, solver, _, estimate = task.arguments
            asked.append((solver, estimate))
            bem = solver == "bem"
            mine = result(solver, answer(swing if bem else 0.1), error if bem else 1e-5)
            bare = replace(mine, value=replace(mine.value, errors={}))
            yield number, mine if estimate else bare

    settings = random_runs.RandomRunSettings(coarse=True, screened=True)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(random_runs, "completed_tasks", carried_out)
        ((_, one),) = random_runs.judged_scenes([replace(CHOSEN, scene=SCENE)], settings, None)
    assert set(asked[:3]) == {(name, name == "reference") for name in solvers.SOLVERS}
    assert asked[3:] == [("bem", True)]
    found = {each.solver: each.finding for each in one.answers}
    assert (found["bem"], found["fem"]) == (finding, AnswerFinding.AGREES)


def test_without_an_estimate_only_a_wrong_answer_is_told():
    mine = result("bem", answer(0.102))
    bare = replace(mine, value=replace(mine.value, errors={}))
    found = judged(bare)
    assert found.finding is AnswerFinding.AGREES
    assert math.isinf(found.allowed)


def test_a_matrix_holds_answers_to_a_comparison_if_asked(tmp_path, monkeypatch):
    """And not together with estimates where they decide alone: a comparison has them all."""

    def carried_out(numbered, executor, outstanding):
        for number, task in numbered:
            yield number, result(task.arguments[1], answer(), 0.05)

    monkeypatch.setattr(random_runs, "completed_tasks", carried_out)
    findings = []
    for asked in (False, True):
        settings = random_runs.RandomRunSettings(compared=asked)
        ((_, one),) = random_runs.judged_scenes([replace(CHOSEN, scene=SCENE)], settings, None)
        findings.append({each.finding for each in one.answers})
    assert findings == [
        {AnswerFinding.AGREES, AnswerFinding.LOOSE},
        {AnswerFinding.AGREES, AnswerFinding.FAILED},
    ]
    with pytest.raises(SystemExit):
        random_matrix.main(["--out", str(tmp_path), "--screened", "--compared"])


def test_a_stopped_matrix_goes_on(tmp_path, asked):
    """Scenes that are done are not repeated; those at fault are written, the table counts all."""
    touching = [seed for seed in range(1, 6) if random_matrix._possible(seed)]
    first = random_matrix.run(tmp_path, touching[:2])
    assert [one.seed for one in random_matrix.run(tmp_path, touching[:3])] == touching[:3]
    assert asked == [*solvers.SOLVERS] * 3
    assert random_matrix.read(tmp_path / "scenes.jsonl")[:2] == first
    assert (tmp_path / "scenes" / f"seed-{touching[0]}.toml").exists()
    assert f"| {AnswerFinding.CRASHED} | 3 | 3 | 3 |" in (tmp_path / "table.md").read_text()


class NoProcesses:
    """In place of the processes of a matrix."""

    def __init__(self, *given, **named) -> None:
        pass

    def __enter__(self) -> None:
        pass

    def __exit__(self, *given) -> None:
        pass


def test_the_table_shows_the_worst_first():
    answers = (RandomSceneAnswer("bem", AnswerFinding.UNDERSTATED, "completed", "force", 0.1, 0.05),)
    worse = (RandomSceneAnswer("bem", AnswerFinding.WRONG, "completed", "force", 0.3, 0.1),)
    text = table(
        [JudgedScene(1, "cycle", "cone", 0.1, answers), JudgedScene(2, "table", "sphere", 0.1, worse)]
    )
    assert text.index("| silently wrong | bem | 2 |") < text.index(
        "| off by more than its estimate | bem | 1 |"
    )


def test_a_random_scene_is_a_scene():
    assert isinstance(random_scene(3).scene, Scene)


def test_the_report_counts_classes_and_says_what_became_of_them(tmp_path):
    wrong = RandomSceneAnswer("bem", AnswerFinding.WRONG, "completed", "force", 0.3, 0.1)
    good = RandomSceneAnswer("fem", AnswerFinding.AGREES, "completed")
    judged = [JudgedScene(seed, "cycle", "cone", 0.1, (wrong, good)) for seed in (5, 9)]
    later = {(5, "bem"): "agrees"}
    assert "| silently wrong | 2 | 0 | 0 |" in random_report.counts(judged)
    assert "| silently wrong | bem | force | 2 | 5 0.3 (agrees), 9 0.3 |" in random_report.faults(
        judged, later
    )
    (tmp_path / "settings.json").write_text('{"seconds": 3.0}')
    lines = [json.dumps(asdict(one)) for one in judged]
    (tmp_path / "scenes.jsonl").write_text("\n".join(lines) + "\n")
    assert "2 scenes of the seeds 5 to 9" in random_report.report(tmp_path)
    assert random_report.later_findings([tmp_path])[9, "bem"] == "silently wrong 0.3"


def test_a_folder_keeps_its_settings(tmp_path, capsys):
    (tmp_path / "settings.json").write_text('{"family": "instruments", "seconds": 3.0}')
    assert random_matrix.main(["--out", str(tmp_path), "--count", "1"]) == 2
    assert "holds scenes with" in capsys.readouterr().err
