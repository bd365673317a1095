"""Commands of many runs that are interrupted: what is kept is said, and taken over by the next attempt."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest
from support.report_commands import WORK
from support.spring_solver import small_scene

from crosscontact.cli import main
from crosscontact.commands.shared import telling_what_is_kept
from validation.runs.store import Store


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
            "reference_runs",
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
