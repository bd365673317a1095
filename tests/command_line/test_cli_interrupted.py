"""Runs and commands that are stopped or end early: what there is, is said, kept and taken over."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import subprocess
import sys
from itertools import count

import pytest
from support.commands import stand_in
from support.report_commands import WORK
from support.spring_solver import FunctionSolver, small_scene, spring, stoppable

import crosscontact as cc
from contact_scene import OutcomeKind
from crosscontact.cli import main
from crosscontact.commands.shared import telling_what_is_kept
from validation import solvers
from validation.runs.store import Store


@pytest.fixture
def scene_file(tmp_path):
    return small_scene(tmp_path)


def put(monkeypatch, function):
    stand_in(monkeypatch, FunctionSolver(function))


def stopped_at_row(row: int):
    """A solver that is sent SIGINT before a row, as by Ctrl-C, and asks its monitor at every row."""

    def solve(*given, monitor, **options):
        rows = count()

        def asked():
            if next(rows) == row:
                os.kill(os.getpid(), signal.SIGINT)
            return monitor()

        return stoppable(spring())(*given, monitor=asked, **options)

    return solve


def test_interrupted_without_a_folder_what_there_is_is_printed(capsys, scene_file, monkeypatch):
    put(monkeypatch, stopped_at_row(5))
    assert main(["solve", scene_file, "--solver", "bem"]) == 1
    out, err = capsys.readouterr()
    assert "small by bem: interrupted: stopped from outside" in out
    assert "approach_force" in out
    assert err.splitlines()[-2:] == [
        "crosscontact: the run ends here; the same command begins it anew",
        "crosscontact: interrupted",
    ]


def path_of(folder) -> dict[str, str]:
    """The environment of a process that imports from the folder too."""
    return os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), *filter(None, sys.path)])}


def test_interrupted_while_a_class_is_made_the_exit_code_is_1(tmp_path):
    """Its text is run by exec, as by dataclasses while a program is loaded."""
    text = """import sys
from crosscontact import cli
cli._run = lambda options: exec("raise KeyboardInterrupt")
sys.exit(cli.main(["scenes"]))
"""
    (tmp_path / "program.py").write_text(text)
    command = [sys.executable, "-m", "program"]
    ended = subprocess.run(command, env=path_of(tmp_path), capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (1, "crosscontact: interrupted\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_leaves_the_exit_code(tmp_path, number):
    """It comes where the command has told its end, and the process is not yet over."""
    text = f"""import atexit, os, signal, sys
from crosscontact import cli
kill = lambda *_: os.kill(os.getpid(), {int(number)})
cli._run = kill
atexit.register(kill)
sys.argv = ["crosscontact", "scenes"]
sys.exit(cli.program())
"""
    command = [sys.executable, "-c", text]
    ended = subprocess.run(command, env=path_of(tmp_path), capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (1, "crosscontact: interrupted\n")


def test_interrupted_in_the_error_estimate_the_run_stands(capsys, tmp_path, scene_file, monkeypatch):
    runs = []

    def second_is_stopped(*given, **options):
        runs.append(options)
        return stopped_at_row(5 if len(runs) == 2 else -1)(*given, **options)

    put(monkeypatch, second_is_stopped)
    out = tmp_path / "out"
    assert main(["solve", scene_file, "--solver", "bem", "--estimate", "--out", str(out)]) == 1
    assert len(runs) == 2
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["outcome"], summary["finished"], summary["error_estimates"]) == ("detached", True, {})
    shown, said = capsys.readouterr()
    assert "no error estimate (it was interrupted)" in shown
    assert "the run is whole, its errors are not estimated" in said


def test_a_budget_that_ends_a_run_is_said(capsys, tmp_path, scene_file, monkeypatch):
    given = ["solve", "relaxed-equilibrium", "--solver", "bem", "--out", str(tmp_path), "--max-steps"]
    seen = []

    def note(scene, resolution=None, *, max_steps=None, **options):
        seen.append(max_steps)
        return spring(kind=OutcomeKind.STEP_BUDGET)(scene, resolution, **options)

    put(monkeypatch, note)
    assert main([*given, "7"]) == 1
    assert seen == [7]
    last = capsys.readouterr().err.splitlines()[-1]
    assert last == "crosscontact: not finished: step budget exhausted: as told; --max-steps N allows more"
    with pytest.raises(SystemExit) as refused:
        main([*given, "0"])
    assert refused.value.code == 2


def test_an_outcome_below_the_zone_is_read_back_as_it_was(tmp_path, scene_file, monkeypatch):
    def shrinks(past):
        def solve(scene, resolution=None, **options):
            trace = spring()(scene, resolution, **options)
            reason = "the contact has shrunk to its process zone"
            outcome = cc.Outcome(OutcomeKind.BELOW_ZONE, reason, float(trace.time[-1]), past)
            return dataclasses.replace(trace, outcome=outcome)

        return solve

    for past in (True, False):
        put(monkeypatch, shrinks(past))
        out = tmp_path / str(past)
        assert main(["solve", scene_file, "--solver", "bem", "--out", str(out)]) == (0 if past else 1)
        loaded = cc.load(out)
        assert loaded.outcome.past_extremum == past
        assert loaded.outcome.finished == past
        summary = json.loads((out / "summary.json").read_text())
        assert (summary["outcome"], summary["past_extremum"]) == ("out of the model's range", past)


def test_what_makes_an_answer_doubtful_is_said_once_and_kept(capsys, tmp_path, scene_file, monkeypatch):
    put(monkeypatch, spring())
    given = ["solve", scene_file, "--solver", "bem", "--out", str(tmp_path / "out")]
    for before, after in ((("before",), ("after",)), ((), ("after",)), ((), ())):
        monkeypatch.setattr(solvers, "scene_warnings", lambda scene, said=before: said)
        monkeypatch.setattr(solvers, "trace_warnings", lambda scene, trace, said=after: said)
        assert main(given) == 0
        lines = [line for line in capsys.readouterr().err.splitlines() if "warning" in line]
        assert lines == [f"crosscontact: warning: {text}" for text in before or after]
        result = cc.load(tmp_path / "out")
        assert result.warnings == after
        assert [line for line in repr(result).splitlines() if "warning" in line] == [
            f"  warning: {text}" for text in after
        ]


# Commands of many runs


@pytest.mark.parametrize("done", [0, 1])
@pytest.mark.parametrize("command", WORK)
def test_what_is_kept_is_said(capsys, tmp_path, monkeypatch, command, done):
    out = tmp_path / "out"

    def work(*given, **more):
        (store,) = (one for one in (*given, *more.values()) if isinstance(one, Store))
        for number in range(done):
            store.put(f"run {number}", number)
        raise KeyboardInterrupt

    monkeypatch.setattr(f"crosscontact.commands.{WORK[command]}", work)
    given = [small_scene(tmp_path) if word == "SCENE" else word for word in command.split()]
    assert main([*given, "--jobs", "1", "--out", str(out)]) == 1
    kept = f"{out} holds what is done: the same command goes on with it"
    words = kept if done else "no run is done: there is nothing to keep"
    said = capsys.readouterr().err.splitlines()
    assert said[-2:] == [f"crosscontact: {words}", "crosscontact: interrupted"]


@pytest.mark.parametrize("done", [0, 1])
def test_what_a_sweep_keeps_is_said(capsys, tmp_path, monkeypatch, done):
    """Without a finished run its folder is gone, too."""

    def work(plan, table, *given):
        for number in range(done):
            table.put(f"run {number}", number)
        raise KeyboardInterrupt

    monkeypatch.setattr("crosscontact.commands.sweep.carry_out", work)
    out = tmp_path / "out"
    assert main(["sweep", "speed-zone", "--jobs", "1", "--out", str(out)]) == 1
    kept = f"kept in {out}: the same command goes on"
    words = kept if done else "no run is done: there is nothing to keep"
    said = capsys.readouterr().err.splitlines()
    assert said[-2:] == [f"crosscontact: {words}", "crosscontact: interrupted"]
    assert out.exists() == bool(done)


@pytest.mark.parametrize(
    ("action", "work", "words"),
    [
        (
            "export",
            "export_reference",
            "holds the scenes; answers of the reference are kept only when all are done",
        ),
        ("answer", "answer_all", "answers are kept only when all are done"),
    ],
)
def test_what_an_exam_keeps_is_said(capsys, tmp_path, monkeypatch, action, work, words):
    def stopped(*given, **more):
        raise KeyboardInterrupt

    assert main(["exam", "export", str(tmp_path)]) == 0
    written = sorted(tmp_path.rglob("*"))
    monkeypatch.setattr(f"crosscontact.commands.exam.{work}", stopped)
    more = ["--with-reference"] if action == "export" else ["--solvers", "reference"]
    assert main(["exam", action, str(tmp_path), *more, "--jobs", "1"]) == 1
    place = f"{tmp_path} " if action == "export" else ""
    said = capsys.readouterr().err.splitlines()
    assert said[-2:] == [f"crosscontact: {place}{words}", "crosscontact: interrupted"]
    assert sorted(tmp_path.rglob("*")) == written


def test_an_interruption_that_a_library_made_an_error_of_is_one(capsys):
    """Compiled modules of VTK answer Ctrl-C during their import with an ImportError."""

    def load():
        try:
            os.kill(os.getpid(), signal.SIGINT)
        except KeyboardInterrupt:
            raise ImportError("no module named vtk") from None

    with pytest.raises(KeyboardInterrupt), telling_what_is_kept(None, Store()):
        load()
    assert "nothing is kept" in capsys.readouterr().err
    with pytest.raises(ImportError), telling_what_is_kept(None, Store()):
        raise ImportError("without an interruption it stays an error")


def test_an_interruption_while_the_program_is_loaded_is_one_line():
    stopping = """
import sys
class Stop:
    def find_spec(self, name, *given):
        if name == "argparse":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop())
from crosscontact.cli import main
sys.exit(main(["scenes"]))
"""
    done = subprocess.run([sys.executable, "-c", stopping], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (1, "", "crosscontact: interrupted\n")
