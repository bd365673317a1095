"""A ``fields`` command that is interrupted and given again does only what is missing, to the same files."""

from __future__ import annotations

import json
import os
import signal
import tomllib

import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_array_equal
from support.scene_text import DOWN_AND_UP

from contact_scene import read_scene, scene_from_dict
from crosscontact.cli import main
from crosscontact.commands import fields
from validation.cases import Case
from validation.execution import checked_pickle, checkpoints, store
from validation.execution.files import in_words
from validation.fields import files
from validation.fields.figures import figure_set
from validation.fields.figures.figure_set import FigureSet
from validation.fields.request import FieldRequest, record_fields
from validation.solvers import Cost

WORK = ("processor_seconds", "fields", "run")


@pytest.fixture(scope="module")
def recorded():
    """One run for all commands: it is the same to the bit each time."""
    runs = {}

    def once(scene, request, *rest):
        key = request.times, request.every
        if key not in runs:
            runs[key] = record_fields(scene, request, *rest)
        return runs[key]

    return once


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "down-and-up.toml"
    path.write_text(DOWN_AND_UP, encoding="utf-8")
    return str(path)


def interrupt_at(monkeypatch, owner, name, count):
    """The n-th call of a function is interrupted; all calls are counted."""
    calls, function = [], getattr(owner, name)

    def call(*given):
        calls.append(given)
        if len(calls) == count:
            raise KeyboardInterrupt
        return function(*given)

    monkeypatch.setattr(owner, name, call)
    return calls


def contents(folder):
    found = {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*") if path.is_file()}
    numbers = json.loads(found.pop(folder.joinpath("moments.json").relative_to(folder)))
    return found, {name: value for name, value in numbers.items() if name not in WORK}


def test_files_that_are_there_are_taken_over(scene_file, tmp_path, monkeypatch, recorded, capsys):
    monkeypatch.setattr(fields, "record_fields", recorded)
    given = ["fields", scene_file, "--at", "0.06", "--every", "100", "--resolution", "4", "--no-figures"]
    once, twice = tmp_path / "once", tmp_path / "twice"
    assert main([*given, "--out", str(once)]) == 0
    whole = capsys.readouterr().out
    moments = len(list((once / "body").iterdir()))
    assert moments >= 3
    written = sum(path.stat().st_size for path in once.rglob("*.vt[up]"))
    assert whole.splitlines()[-1] == f"for ParaView: {in_words(written)}"
    with monkeypatch.context() as stopped:
        interrupt_at(stopped, files, "save", 7)
        assert main([*given, "--out", str(twice)]) == 1
    assert "the same command goes on with it" in capsys.readouterr().err
    assert not (twice / "body.pvd").exists()
    written = interrupt_at(monkeypatch, files, "save", None)
    assert main([*given, "--out", str(twice)]) == 0
    assert len(written) == 3 * (moments - 2)
    assert not (twice / store.FOLDER).exists()
    assert contents(twice) == contents(once)
    table = [line for line in capsys.readouterr().out.splitlines() if line[:20].strip() == "-"]
    assert table == [line for line in whole.splitlines() if line[:20].strip() == "-"]


SHORT = Cost(1000.0, 5.0, 1e6)
ANNOUNCED = {
    "14 s, 1.0 MB of memory, 23 moments of 2 MB for ParaView, 0 pictures": (
        FieldRequest((0.0, 0.1), pull_off=True, every=50),
        None,
    ),
    "49 s, 1.0 MB of memory, 1 moment of 2 MB for ParaView, 32 pictures": (
        FieldRequest((0.0,)),
        FigureSet(("von_mises", "stress_zz"), animate=True, frames=30),
    ),
    "": (FieldRequest((0.0,)), None),
}


@pytest.mark.parametrize("said", ANNOUNCED)
def test_files_and_pictures_are_announced(scene_file, capsys, said):
    """A moment takes 0.4 s, a picture a second; frames are no files for ParaView."""
    case = Case("pressed", read_scene(scene_file))
    fields.FieldsCommand(case, *ANNOUNCED[said], None, None, False).announce(SHORT)
    expected = f"crosscontact: expected: about 1e3 steps, {said}\n" if said else ""
    assert capsys.readouterr().err == expected


def test_pictures_that_are_there_are_taken_over(scene_file, tmp_path, monkeypatch, recorded, capsys):
    def small(state, scene, quantity, common):
        return Figure(figsize=(0.2, 0.2))

    monkeypatch.setattr(fields, "record_fields", recorded)
    monkeypatch.setattr(figure_set, "single_section", small)
    given = ["fields", scene_file, "--at", "0.06", "--resolution", "4", "--out", str(tmp_path / "out")]
    with monkeypatch.context() as stopped:
        interrupt_at(stopped, figure_set, "single_section", 2)
        assert main(given) == 1
    drawn = interrupt_at(monkeypatch, figure_set, "single_section", None)
    assert main(given) == 0
    assert [call[2].name for call in drawn] == ["stress_zz", "dissipation_rate"]
    assert len(list((tmp_path / "out/sections").glob("*.png"))) == 3


def test_interrupted_in_the_run(scene_file, tmp_path, monkeypatch, capsys):
    def stop(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr(fields, "record_fields", stop)
    assert main(["fields", scene_file, "--at", "0", "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().err.splitlines() == [
        "crosscontact: no step is kept: there is nothing to go on with",
        "crosscontact: interrupted",
    ]
    assert not (tmp_path / "out").exists()


DOWN = DOWN_AND_UP.rpartition("[[loading.steps]]")[0].replace("zone = 0.03", "zone = 0.06")
APART = DOWN.replace("time = 0.3 }]", 'time = 0.3 }]\nbulk = "elastic"')
"""Pressed only, and coarsely: where bulk relaxes apart, every step solves for the whole body."""
RUNS = {"on the surface": (DOWN_AND_UP, "0.09", 40), "in the body": (APART, "0.06", 10)}
"""Where the history is: scene, last moment, steps before the interruption."""


@pytest.mark.parametrize("name", ["on the surface", pytest.param("in the body", marks=pytest.mark.slow)])
def test_an_interrupted_run_goes_on_with_its_history(tmp_path, monkeypatch, capsys, name):
    text, last, looks = RUNS[name]
    file = tmp_path / "scene.toml"
    file.write_text(text, encoding="utf-8")
    given = ["fields", str(file), "--at", "0", last, "--resolution", "4", "--no-figures", "--out"]
    once, twice = tmp_path / "once", tmp_path / "twice"
    assert main([*given, str(once)]) == 0
    with monkeypatch.context() as stopping:
        left, look = iter(range(looks)), checkpoints.CheckpointWriter.continue_run

        def stop_later(writer, state):
            if next(left, None) is None:
                os.kill(os.getpid(), signal.SIGINT)
            return look(writer, state)

        stopping.setattr(checkpoints.CheckpointWriter, "continue_run", stop_later)
        assert main([*given, str(twice)]) == 1
    assert {path.name for path in twice.iterdir()} == {"checkpoint"}
    assert "the same command goes on with it" in capsys.readouterr().err
    assert main([*given, str(twice)]) == 0
    assert "continuing the run saved in" in capsys.readouterr().err
    assert contents(twice) == contents(once)
    assert not (twice / "checkpoint").exists()


class Keeping:
    """A monitor that counts steps, stops the run after so many, and keeps its state there as in a file."""

    def __init__(self, last=None, start_state=None):
        self.last, self.start_state, self.kept, self.steps = last, start_state, b"", 0

    def continue_set_up(self):
        return True

    def continue_run(self, state):
        self.steps += 1
        if self.steps == self.last:
            self.kept = checked_pickle.dumps(state())
        return self.steps != self.last


@pytest.mark.slow
def test_a_second_run_for_picked_rows_goes_on_without_the_first():
    """Where bulk relaxes apart whole states are stored, of rows that only the trace of a first run tells."""
    scene = scene_from_dict(tomllib.loads(APART))
    asked = FieldRequest((0.06,), picked=lambda trace, scene: {len(trace) // 2: "half-way"})
    whole = Keeping()
    once = record_fields(scene, asked, 4, monitor=whole)
    run = whole.steps // 2
    for last in (run // 2, run + run // 2):
        stopped = Keeping(last)
        assert not record_fields(scene, asked, 4, monitor=stopped).recording.trace.outcome.finished
        assert stopped.steps == last  # no second run of a first one that was stopped
        taken_up = Keeping(start_state=checked_pickle.loads(stopped.kept))
        again = record_fields(scene, asked, 4, monitor=taken_up)
        assert taken_up.steps <= whole.steps - last + 1
        assert again.moments == once.moments
        assert "half-way" in again.moments.values()
        for state, same in zip(again.states(), once.states(), strict=True):
            assert_array_equal(state.stress, same.stress)
            assert_array_equal(state.dissipated, same.dissipated)


def test_another_scenes_fields_are_refused(scene_file, tmp_path, monkeypatch, recorded, capsys):
    monkeypatch.setattr(fields, "record_fields", recorded)
    out = str(tmp_path / "out")
    given = ["--at", "0.06", "--resolution", "4", "--no-figures", "--out", out]
    assert main(["fields", scene_file, *given]) == 0
    other = tmp_path / "other.toml"
    other.write_text(DOWN_AND_UP.replace("poisson = 0.4", "poisson = 0.3"), encoding="utf-8")
    capsys.readouterr()
    assert main(["fields", str(other), *given]) == 2
    assert "results of another scene" in capsys.readouterr().err
    assert main(["fields", str(other), *given, "--fresh"]) == 0


def test_an_animation_alone_writes_no_files_for_paraview(scene_file, tmp_path, monkeypatch, recorded, capsys):
    monkeypatch.setattr(fields, "record_fields", record_fields)
    monkeypatch.setattr(figure_set.animation, "film", lambda *given: b"GIF" * 700)
    out = tmp_path / "out"
    given = ["fields", scene_file, "--animate", "--resolution", "4", "--out", str(out)]
    assert main(given) == 0
    assert {path.name for path in out.rglob("*") if path.is_file()} == {"scene.toml", "cycle_von_mises.gif"}
    said = capsys.readouterr().out
    assert "cycle_von_mises.gif (2.1 kB)" in said
    assert "ParaView" not in said
