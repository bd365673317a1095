"""A study that is stopped does what is missing; what it had is taken over, run times included."""

from __future__ import annotations

import dataclasses

import pytest
from support.spring_solver import SCENE, StudiedSolver, spring

from validation.cases import load
from validation.runs.pool import Task, run_tasks
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.studies import ladders as schemes
from validation.studies import study
from validation.studies.ladders import Level, Settings


@pytest.fixture
def levels(monkeypatch):
    """Made-up schemes whose answer depends on the level; counts the levels that are run."""
    ran = []
    run_level = study.run_level

    def counted(case, scheme, level, *others):
        ran.append((scheme, level))
        return run_level(case, scheme, level, *others)

    def solve(scene, resolution, **options):
        return spring(1.0 + 1.0 / resolution)(scene)

    for name, scheme in list(schemes.SCHEMES.items()):
        monkeypatch.setitem(schemes.SCHEMES, name, dataclasses.replace(scheme, solver=StudiedSolver(solve)))
    monkeypatch.setattr(study, "run_level", counted)
    return ran


def found_in(study_of) -> list:
    """Every level with what it gave, without its run time."""
    return [
        dataclasses.replace(run, wall_seconds=None, cpu_seconds=None, repeats=0)
        for ladder in study_of.scenes[0].ladders
        for run in ladder.runs
    ]


def test_a_study_does_what_is_missing(tmp_path, levels, monkeypatch):
    """The first levels are there, as after an interruption."""
    file = tmp_path / "small.toml"
    file.write_text(SCENE)
    cases, out = [load(str(file))], tmp_path / "out"
    out.mkdir()
    put, kept = Store.put, iter(range(25))
    with monkeypatch.context() as patch:
        patch.setattr(Store, "put", lambda *given: next(kept, None) is None or put(*given))
        whole = study.study(cases, 1, Progress("test"), Store(out))
    every = list(levels)
    levels.clear()
    store = Store(out)
    again = study.study(cases, 1, Progress("test"), store)
    assert store.taken_over == 25  # the reference, and the levels before the interruption
    assert 0 < len(levels) < len(every)
    assert found_in(again) == found_in(whole)
    levels.clear()
    third = study.study(cases, 1, Progress("test"), Store(out))
    assert levels == []
    assert [ladder.runs for ladder in third.scenes[0].ladders] == [
        ladder.runs for ladder in again.scenes[0].ladders
    ]


def test_a_level_that_breaks_down_is_tried_again(tmp_path, levels, monkeypatch):
    def fall(*given, **options):
        raise FloatingPointError("overflow")

    (tmp_path / "small.toml").write_text(SCENE)
    asked = load(str(tmp_path / "small.toml")), "bem", Level(0.25, "4", Settings(4))
    task, bem = Task("level", "", study.run_level, asked, study.TimedRun), schemes.SCHEMES["bem"]
    for solver, kept in ((StudiedSolver(fall), False), (bem.solver, True)):
        monkeypatch.setitem(schemes.SCHEMES, "bem", dataclasses.replace(bem, solver=solver))
        run_tasks([task], store=Store(tmp_path))
        assert (Store(tmp_path).get("level", study.TimedRun) is not None) is kept
    assert len(levels) == 2
