"""The command line with the solvers: in processes of its own, on scenes without a start, on an instrument."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from support.scene_text import GOOD
from support.spring_solver import SCENE

from contact_scene import COLUMNS, OutcomeKind, read_columns, read_scene
from crosscontact import arguments
from crosscontact.cli import main
from validation.cases import Case
from validation.exam.own_answers import answer_all

COMMAND = [sys.executable, "-m", "crosscontact"]


@pytest.mark.slow
def test_compare_in_parallel(tmp_path):
    said = subprocess.run(
        [*COMMAND, "compare", "relaxed-equilibrium", "--jobs", "2", "--out", str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert said.returncode == 0, said.stderr
    assert "compare: runs: 3/3" in said.stderr
    assert "FAIL" not in said.stdout
    data = json.loads((tmp_path / "report.json").read_text())
    assert list(data["scenes"][0]["runs"]) == ["bem", "fem", "reference"]


@pytest.mark.parametrize(
    ("arguments", "seconds"),
    [
        (["solve", "sweep", "--solver", "reference"], 2.0),
        (["report", "--jobs", "2"], 0.3),
        pytest.param(["report", "--jobs", "2"], 2.0, marks=pytest.mark.slow),
    ],
)
def test_interrupt(tmp_path, arguments, seconds):
    """So many seconds after the program has been loaded, before which Python answers by itself."""
    program = "import sys; from crosscontact.cli import main; print('up', flush=True); sys.exit(main())"
    work = subprocess.Popen(
        [sys.executable, "-c", program, *arguments, "--out", str(tmp_path / "out")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert work.stdout is not None
    assert work.stdout.readline() == "up\n"
    time.sleep(seconds)
    os.killpg(work.pid, signal.SIGINT)  # as a terminal does: to the workers too
    out, err = work.communicate(timeout=30)
    assert work.returncode in (1, -signal.SIGINT), (out, err)  # before and after the command is up
    assert err.splitlines()[-1] == "crosscontact: interrupted"
    assert "Traceback" not in err
    assert not (tmp_path / "out" / "report.json").exists()


# A scene without a state to start from: every command says so in a line, and what it writes says it too

OUTCOME, WHERE = str(OutcomeKind.NO_EQUILIBRIUM), "touches the surface at penetration 0"


@pytest.fixture
def above(tmp_path):
    """A scene that starts from where adhesion does not reach the surface."""
    file = tmp_path / "above.toml"
    file.write_text(SCENE.replace("penetration = 0.0", "penetration = -0.1"))
    return str(file)


@pytest.fixture
def says(capsys):
    """Runs a command that cannot finish, and returns what it said."""

    def run(*arguments):
        code = main(list(arguments))
        said = capsys.readouterr()
        assert code in (1, 2), said
        assert "Traceback" not in said.out + said.err
        return said.out + said.err

    return run


@pytest.mark.parametrize("solver", arguments.names())
def test_solve_keeps_how_it_ended(says, above, tmp_path, solver):
    """A trace without rows counted as no trace: the files said "failed", and not why."""
    folder = tmp_path / "o"
    assert WHERE in says("solve", above, "--solver", solver, "--resolution", "4", "--out", str(folder))
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["outcome"], summary["finished"]) == (OUTCOME, False)
    assert WHERE in summary["reason"]
    assert summary["counters"]["steps"] == 0
    assert {summary[name] for name in ("start_force", "loop_energy", "final_radius")} == {None}
    columns = read_columns(folder / "trace.csv")
    assert set(COLUMNS) < set(columns)
    assert {len(column) for column in columns.values()} == {0}


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(("compare", "--solvers", "bem,reference", "--jobs", "1"), id="compare"),
        pytest.param(("fields", "--at", "0.5"), id="fields"),
        pytest.param(("study", "--zones", "1e-2", "--jobs", "1"), id="zones"),
        pytest.param(("study", "--poisson", "100", "--jobs", "1"), id="poisson", marks=pytest.mark.slow),
    ],
)
def test_other_commands_say_it(says, above, tmp_path, command):
    name, *options = command
    said = says(name, above, *options, "--out", str(tmp_path / "o"))
    assert OUTCOME in said
    assert WHERE in said


def test_no_answer_to_an_exam(above, tmp_path):
    """It has no curve that could be graded."""
    (failed,) = answer_all(tmp_path, [Case("above", read_scene(above))], ["reference"])
    assert OUTCOME in failed.ending
    assert not list(tmp_path.rglob("trace.csv"))


# An instrument: columns, measures, and a level that is not reached

ELASTIC = GOOD.replace("branches = [{ modulus = 6.75, time = 1.0 }, { modulus = 1, time = 10 }]\n", "")
HEAD = ELASTIC[: ELASTIC.index("[[loading.steps]]")] + "[[loading.steps]]\n"
APPROACH = 'kind = "approach"\nrate = 1\nforce = {force}\nto = 0.1\n\n[machine]\nstiffness = 0.2\n'


def approached(tmp_path, force):
    (tmp_path / "scene.toml").write_text(HEAD + APPROACH.format(force=force))
    code = main(["solve", str(tmp_path / "scene.toml"), "--resolution", "4", "--out", str(tmp_path / "out")])
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    return code, summary, read_columns(tmp_path / "out" / "trace.csv")


def test_trace_and_summary_of_a_spring(tmp_path):
    code, summary, columns = approached(tmp_path, 0.003)
    assert (code, summary["outcome"]) == (0, "detached")
    assert columns["force"].max() == pytest.approx(0.003, rel=1e-12)
    assert columns["stage"] == pytest.approx(columns["penetration"] + columns["force"] / 0.2, abs=1e-12)
    assert summary["stage_at_detachment"] == pytest.approx(columns["stage"].min(), rel=1e-12)
    assert summary["instability_loss"] == columns["instability_loss"][-1] > 0.0


def test_level_out_of_reach_is_said_and_ends_with_1(tmp_path, capsys):
    code, summary, columns = approached(tmp_path, 30)
    assert (code, summary["outcome"]) == (1, "trigger not reached")
    assert "the load step ended before the force was 30" in capsys.readouterr().err
    assert columns["stage"][-1] == pytest.approx(0.1)
