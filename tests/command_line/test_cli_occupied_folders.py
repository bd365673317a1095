"""No command writes over another scene's, solver's, command's or program's files without --fresh."""

from __future__ import annotations

import json
import tomllib

import pytest
from support.recorded import elastic_scene, hertz_curve
from support.report_commands import WORK
from support.spring_solver import SCENE, FunctionSolver, named, small_scene, spring, stoppable

import crosscontact as cc
from contact_scene.scene import scene_from_dict
from crosscontact.cli import main
from validation import cases, solvers
from validation.runs.premises import of_case
from validation.runs.report_folder import (
    FIT,
    KINDS,
    STABILITY,
    SWEEP,
    check_kind,
    poisson_json,
    zones_json,
)
from validation.runs.run import Run
from validation.runs.run_folder import write_run
from validation.studies import poisson_page, zone_page

OWN = {
    "compare SCENE": "report.json",
    "study SCENE": "study.json",
    "study SCENE --poisson 10": poisson_json("small"),
    "study SCENE --zones 0.01": zones_json("small"),
    "report": "report.json",
}
"""Their numbers on scenes."""


class WorkBegan(Exception):
    """The folder was accepted."""


@pytest.fixture(params=WORK)
def command(request, tmp_path, monkeypatch):
    """Arguments of a command into ``tmp_path / "out"``, which ends where its work begins."""

    def work(*given, **more):
        raise WorkBegan

    monkeypatch.setattr(f"crosscontact.commands.{WORK[request.param]}", work)
    file = small_scene(tmp_path)
    (tmp_path / "out").mkdir()
    given = [file if word == "SCENE" else word for word in request.param.split()]
    return [*given, "--jobs", "1", "--out", str(tmp_path / "out")]


def own_numbers(command: list[str]) -> str | None:
    """File of the numbers of a command on scenes of a user or of a suite; else ``None``."""
    words = ["SCENE" if word.endswith("small.toml") else word for word in command]
    return OWN.get(" ".join(words[: words.index("--jobs")]))


def refused(capsys, given: list[str]) -> str:
    """The line with which a command is refused; with --fresh it is carried out."""
    capsys.readouterr()
    assert main(given) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("crosscontact: error: --out: ")
    assert line.endswith("; allowed: another folder, or --fresh to replace what it holds")
    return line


def test_a_foreign_trace_is_kept(capsys, tmp_path, command):
    foreign = tmp_path / "out/trace.csv"
    foreign.write_text("mine")
    assert "holds a trace.csv" in refused(capsys, command)
    assert foreign.read_text() == "mine"
    with pytest.raises(WorkBegan):
        main([*command, "--fresh"])


def test_another_command_s_page_is_kept(capsys, tmp_path, command):
    own = own_numbers(command) or STABILITY
    others = [(name, kind) for name, kind in KINDS.items() if name != own and own in KINDS]
    for name, kind in others:
        other = tmp_path / "out" / name
        other.write_text("{}")
        assert kind in refused(capsys, command)
        other.unlink()
    with pytest.raises(WorkBegan):
        main(command)


def test_numbers_on_another_scene_are_kept(capsys, tmp_path, command):
    name = own_numbers(command)
    if name is None:
        pytest.skip("the matrix has no scenes of a user")
    numbers = tmp_path / "out" / name
    scene = {"name": "small", "premises": of_case(cases.load(str(tmp_path / "small.toml")))}
    if command[0] == "report":
        scene = {"name": "cone-pull", "premises": of_case(cases.load("cone-pull"))}

    def write(**changes):
        one = {**scene, **changes}
        alone = {"scene": one["name"], "premises": one["premises"]}
        numbers.write_text(json.dumps({"scenes": [one]} if name in KINDS else alone))

    write()
    with pytest.raises(WorkBegan):
        main(command)  # its own
    write(name="larger")
    assert "another scene, 'larger'" in refused(capsys, command)
    write(premises={"input": scene["premises"]["input"] | {"material": "0"}})
    assert f"another scene, '{scene['name']}'" in refused(capsys, command)
    numbers.write_text('{"mine": 1}')
    assert "not of this program" in refused(capsys, command)
    with pytest.raises(WorkBegan):
        main([*command, "--fresh"])


def test_a_fit_does_not_replace_a_report(tmp_path):
    (tmp_path / "report.json").write_text("{}")
    with pytest.raises(ValueError, match="holds a report"):
        check_kind(tmp_path, FIT)
    with pytest.raises(ValueError, match=r"^out: .* holds a report, report\.json; allowed: another folder$"):
        cc.fit(hertz_curve(), elastic_scene(), ["material.modulus"], out=tmp_path)


@pytest.mark.parametrize("other", [name for name in KINDS if name != SWEEP])
def test_a_sweep_does_not_join_another_command_s_page(capsys, tmp_path, monkeypatch, other):
    def work(*given):
        raise WorkBegan

    monkeypatch.setattr("crosscontact.commands.sweep.carry_out", work)
    monkeypatch.setattr("crosscontact.sweeps.carry_out", work)
    scene, plan, out = small_scene(tmp_path), tmp_path / "plan.toml", tmp_path / "out"
    coordinate = '[[coordinates]]\nkeys = ["material.modulus"]\nvalues = [0.7, 0.8]\n'
    plan.write_text(f'scene = "{scene}"\n{coordinate}')
    given = ["sweep", str(plan), "--jobs", "1", "--out", str(out)]
    out.mkdir()
    (out / other).write_text("{}")
    assert f"holds {KINDS[other]}, {other}" in refused(capsys, given)
    with pytest.raises(cc.SceneError, match=r"^out: .* holds .*; allowed: another folder$"):
        cc.sweep(scene, {"material.modulus": [0.7]}, out=out)
    assert [file.name for file in out.iterdir()] == [other]
    with pytest.raises(WorkBegan):
        main([*given, "--fresh"])
    (out / other).unlink()
    with pytest.raises(WorkBegan):
        main(given)


def test_premises_are_what_is_written(tmp_path):
    """Studies that are written are known again, by the same command."""
    case = cases.load(small_scene(tmp_path))
    for numbers in (poisson_page.data(case, []), zone_page.data(case, [])):
        assert numbers["scene"] == "small"
        assert numbers["premises"] == of_case(case)


@pytest.fixture
def solved(tmp_path, monkeypatch):
    """Solves the small scene by a stand-in of this name, into a folder."""
    for name in ("bem", "fem"):
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, FunctionSolver(stoppable(spring()))))
    file = small_scene(tmp_path)
    return lambda name, *more: main(["solve", file, "--solver", name, "--out", str(tmp_path / "out"), *more])


def test_another_solver_s_results_are_kept(capsys, tmp_path, solved):
    assert solved("bem") == 0
    before = (tmp_path / "out/summary.json").read_bytes()
    capsys.readouterr()
    assert solved("fem") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "holds the results of another solver, bem; allowed: another folder, or --fresh" in line
    assert (tmp_path / "out/summary.json").read_bytes() == before
    assert solved("bem", "--resolution", "6") == 0  # other options of the same question
    assert solved("fem", "--fresh") == 0
    assert json.loads((tmp_path / "out/summary.json").read_text())["solver"] == "fem"


def test_fields_do_not_join_another_solver_s_trace(capsys, tmp_path, solved, monkeypatch):
    given = ["fields", str(tmp_path / "small.toml"), "--at", "0.1", "--out", str(tmp_path / "out")]

    def work(*given):
        raise WorkBegan

    monkeypatch.setattr("crosscontact.commands.fields.record_fields", work)
    assert solved("bem") == 0
    assert "another solver, bem" in refused(capsys, given)
    assert solved("fem", "--fresh") == 0
    with pytest.raises(WorkBegan):
        main(given)


def test_a_solver_does_not_join_the_fields_of_another(capsys, tmp_path, solved):
    out = tmp_path / "out"
    out.mkdir()
    (out / "scene.toml").write_text(SCENE)
    (out / "moments.json").write_text('{"moments": [], "solver": "fem"}')
    assert solved("bem") == 2
    assert "another solver, fem" in capsys.readouterr().err
    assert solved("fem") == 0


def test_runs_of_a_report_are_told_by_their_scene(tmp_path, command, capsys):
    if command[0] != "compare":
        pytest.skip("a report's scenes are built in")
    other = tomllib.loads(SCENE.replace("0.75", "0.76"))
    run = Run("small", "bem", failure="none")
    write_run(tmp_path / "out/runs/small/bem", scene_from_dict(other), run)
    assert "another scene, 'A small scene'" in refused(capsys, command)
