"""Runs that are stopped, end early or find another's files: what there is, is said and kept."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import subprocess
import sys

import pytest
from support.spring_solver import FunctionSolver, named, small_scene, spring

import crosscontact as cc
from contact_scene import OutcomeKind
from crosscontact.cli import main
from validation import solvers


@pytest.fixture
def scene_file(tmp_path):
    return small_scene(tmp_path)


def put(monkeypatch, function):
    method = FunctionSolver(function, "bem")
    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", method))


def stopped_at_row(row: int):
    """A solver that is sent SIGINT before a row, as by Ctrl-C, and asks its monitor at every row."""

    def solve(scene, resolution=None, *, monitor=None, **options):
        trace = spring()(scene, resolution, **options)
        for index in range(len(trace)):
            if index == row:
                os.kill(os.getpid(), signal.SIGINT)
            if monitor is not None and not monitor():
                part = {name: column[:index] for name, column in trace.columns().items()}
                outcome = cc.Outcome(
                    OutcomeKind.INTERRUPTED, "stopped from outside", float(trace.time[index])
                )
                return dataclasses.replace(trace, **part, outcome=outcome)
        return trace

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
