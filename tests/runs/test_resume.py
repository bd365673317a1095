"""Commands that are stopped or killed and given again: the results are those of one that never was."""

from __future__ import annotations

import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from functools import cache
from pathlib import Path

import pytest
from support.interruptible_command import BEGUN, VERSION
from support.spring_solver import SCENE, FunctionSolver, spring
from support.unlaid_figures import without_layout

from benchmarks import kills
from contact_scene import read_columns
from crosscontact.cli import main
from validation import solvers
from validation.runs import provenance
from validation.runs.folder import CLAIM, LOCK_FILE, locked_folder
from validation.runs.run import Run
from validation.runs.store import UNFINISHED, loads

ENVIRONMENT = os.environ | {"PYTHONPATH": os.getcwd(), "OMP_NUM_THREADS": "1"}
TIMES = ("wall_seconds", "cpu_seconds", "estimate_seconds")
RESULTS = ["scene.toml", "summary.json", "trace.csv"]
PATIENCE = 60.0  # seconds that a busy machine may take


@pytest.fixture(autouse=True)
def _version(monkeypatch):
    monkeypatch.setattr(provenance, "version", lambda: VERSION)


@pytest.fixture(autouse=True)
def _plain_figures():
    """What reports are written here is compared by its numbers and the names of its files."""
    with without_layout():
        yield


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory):
    file = tmp_path_factory.mktemp("scene") / "small.toml"
    file.write_text(SCENE.replace("to = -0.01", "to = -0.5").replace("0.01\n", "0.1\n"))
    return str(file)


@pytest.fixture(scope="module")
def uninterrupted(scene_file, tmp_path_factory):
    """Folder of the whole run, by solver; each is solved once."""

    @cache
    def solve(solver: str) -> Path:
        out = tmp_path_factory.mktemp(solver)
        assert main(arguments(scene_file, solver, out)) == 0
        return out

    return solve


def arguments(scene: str, solver: str, out: Path) -> list[str]:
    return ["solve", scene, "--solver", solver, "--resolution", "4", "--out", str(out)]


def begin(*given: str, rest: float = 0.03) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "tests/support/interruptible_command.py", str(rest), *given],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
    )


def wait_for(true, what: str, patience: float = PATIENCE) -> None:
    end = time.monotonic() + patience
    while not true():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.02)


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(entry) for key, entry in value.items() if key not in TIMES}
    return [without_times(entry) for entry in value] if isinstance(value, list) else value


def assert_same_results(found: Path, wanted: Path) -> None:
    assert sorted(file.name for file in found.glob("[!.]*")) == RESULTS
    assert (found / "trace.csv").read_bytes() == (wanted / "trace.csv").read_bytes()
    one, other = (json.loads((folder / "summary.json").read_text()) for folder in (found, wanted))
    assert without_times(one) == without_times(other)


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_signal_ends_the_run_with_its_step(capsys, tmp_path, scene_file, uninterrupted, number):
    work = begin(*arguments(scene_file, "reference", tmp_path))
    assert work.stdout is not None
    assert work.stdout.readline().strip() == BEGUN
    work.send_signal(number)
    out, err = work.communicate(timeout=PATIENCE)
    assert work.returncode == 1, err
    assert "Traceback" not in err
    assert err.splitlines()[-1] == "crosscontact: interrupted"
    assert "the same command begins it anew" in err
    assert "interrupted: stopped from outside" in out
    assert sorted(file.name for file in tmp_path.glob("[!.]*")) == RESULTS
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (summary["outcome"], summary["finished"]) == ("interrupted", False)
    whole = uninterrupted("reference")
    part, force = (read_columns(folder / "trace.csv")["force"] for folder in (tmp_path, whole))
    assert 0 < len(part) < len(force)
    assert part.tobytes() == force[: len(part)].tobytes()
    assert main(arguments(scene_file, "reference", tmp_path)) == 0
    assert_same_results(tmp_path, whole)


def test_bad_input_leaves_no_folder(tmp_path):
    assert main(["solve", "nowhere.toml", "--solver", "bem", "--out", str(tmp_path / "out")]) == 2
    assert list(tmp_path.iterdir()) == []


class Counting:
    """Stand-ins for the solvers that count their runs; the one named ``stops`` is interrupted, once."""

    def __init__(self, monkeypatch) -> None:
        self.runs: list[str] = []
        self.stops = ""
        for name in ("bem", "fem", "reference"):
            monkeypatch.setitem(solvers.SOLVERS, name, FunctionSolver(self.solver(name), name))

    def solver(self, name: str):
        def call(*given, **options):
            if name == self.stops:
                self.stops = ""
                raise KeyboardInterrupt
            self.runs.append(name)
            return spring()(*given, **options)

        return call


def kept_runs(folder: Path) -> list[Run]:
    """The runs that a stopped command has kept, read past its store."""
    with closing(sqlite3.connect(folder / UNFINISHED)) as connection:
        return [loads(text, Run) for (text,) in connection.execute("SELECT answer FROM answers")]


def report_of(folder: Path):
    report = without_times(json.loads((folder / "report.json").read_text()))
    del report["environment"]  # with the time of day
    return report


def test_a_report_does_what_is_missing_and_has_the_run_times_of_the_runs(
    capsys, tmp_path, scene_file, monkeypatch
):
    solved = Counting(monkeypatch)
    given = ["compare", scene_file, "--jobs", "1", "--out"]
    once, twice = tmp_path / "once", tmp_path / "twice"
    assert main([*given, str(once)]) == 0
    all_runs, solved.runs = solved.runs, []
    solved.stops = "reference"
    assert main([*given, str(twice)]) == 1
    assert sorted(file.name for file in twice.iterdir()) == [CLAIM, UNFINISHED]
    measured = {run.solver: run.wall_seconds for run in kept_runs(twice)}
    assert set(measured) == {"bem", "fem"}
    assert main([*given, str(twice)]) == 0
    assert sorted(solved.runs) == sorted(all_runs)
    assert "2/3 taken over" in capsys.readouterr().err
    assert report_of(twice) == report_of(once)
    assert sorted(file.name for file in twice.iterdir()) == sorted(file.name for file in once.iterdir())
    (scene,) = json.loads((twice / "report.json").read_text())["scenes"]
    for solver, seconds in measured.items():
        assert scene["runs"][solver]["wall_seconds"] == seconds


def test_a_fresh_report_takes_nothing_over(tmp_path, scene_file, monkeypatch):
    solved = Counting(monkeypatch)
    given = ["compare", scene_file, "--jobs", "1", "--out", str(tmp_path / "out")]
    solved.stops = "reference"
    assert main(given) == 1
    solved.runs = []
    assert main([*given, "--fresh"]) == 0
    assert {"bem", "fem", "reference"} <= set(solved.runs)


@pytest.mark.parametrize("command", ["report", "compare", "solve", "study"])
def test_a_folder_in_use_is_refused(capsys, tmp_path, scene_file, monkeypatch, command):
    monkeypatch.setattr(f"crosscontact.commands.{command}.run", lambda *given: pytest.fail("it ran"))
    given = {"report": [], "solve": [scene_file, "--solver", "bem"]}.get(command, [scene_file])
    with locked_folder(tmp_path):
        assert main([command, *given, "--out", str(tmp_path)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert f"in use by another crosscontact (process {os.getpid()} on " in line
        assert [file.name for file in tmp_path.iterdir()] == [LOCK_FILE]


POOL = """
    with processes(2) as pool:
        print(*{f.result() for f in [pool.submit(os.getpid) for _ in range(20)]}, flush=True)
        pool.submit(time.sleep, 60).result()
"""
MATRIX = """
    with processes(1, isolated=True) as pool:
        (task,) = run_tasks([Task("", "", os.getpid, (), time_limit=30.0)], pool)
        print(task.value, flush=True)
        run_tasks([Task("", "", time.sleep, (60,), time_limit=60.0)], pool)
"""


@pytest.mark.parametrize(
    "work", [pytest.param(POOL, id="pool", marks=pytest.mark.slow), pytest.param(MATRIX, id="matrix")]
)
def test_workers_end_with_their_parent(work):
    imports = "import os, time\nfrom validation.runs.pool import Task, processes, run_tasks\n"
    program = f"{imports}if __name__ == '__main__':{work}"
    parent = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, env=ENVIRONMENT
    )
    assert parent.stdout is not None
    with parent.stdout as told:
        workers = [int(number) for number in told.readline().split()]
    parent.kill()
    parent.wait()
    assert workers
    wait_for(lambda: not any(map(alive, workers)), "the workers to end", 30.0)


def alive(process: int) -> bool:
    """Whether it runs; one that nobody has buried yet does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=() if name == "sweep" else pytest.mark.exhaustive) for name in kills.COMMANDS],
)
def test_a_command_killed_again_and_again_gives_the_same_numbers(tmp_path, command):
    """The real solvers in processes of their own; the store grows until nothing is missing."""
    kills.prepare(tmp_path)
    done, ends, differing = kills.killed(command, tmp_path, 2, random.Random(1))
    assert (done, differing) == (2, 0)
    assert ends > 0
