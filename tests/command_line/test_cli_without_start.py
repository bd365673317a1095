"""A scene without a state to start from: every command says so in a line, and what it writes says it too."""

from __future__ import annotations

import json

import pytest
from support.spring_solver import SCENE

from contact_scene import COLUMNS, OutcomeKind, read_scene
from contact_scene.trace import read_columns
from crosscontact import arguments
from crosscontact.cli import main
from validation.cases import Case
from validation.exam.own_answers import answer_all

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
