"""Two reports compared: every kind of move is listed, and only those that count change the exit code."""

from __future__ import annotations

import copy
import json
import os
import xml.etree.ElementTree as tree

import pytest
from support.commands import refusal, stand_in
from support.spring_solver import fake

from crosscontact import arguments
from crosscontact.cli import main
from validation.cases import load
from validation.compare import regression
from validation.report.document import Figures

NAME = "cycle-v0.1"


def report_writer(monkeypatch, tmp_path):
    """What writes a report of one scene with fakes of the given stiffness, and returns code and folder."""
    monkeypatch.setattr("validation.scenes.suite", lambda suite: [NAME])
    monkeypatch.setattr(
        "crosscontact.commands.report.exit_code", lambda failures: 0
    )  # only the baseline counts here
    monkeypatch.setattr("validation.compare.scene_page.figures", lambda scene: Figures(()))  # drawn elsewhere

    def report(name: str, *more: str, **factories):
        stand_in(monkeypatch, **factories)
        folder = tmp_path / name
        # without estimates: a fake is the same at any resolution, hence says it is exact
        return main(["report", "--jobs", "1", "--no-estimates", "--out", str(folder), *more]), folder

    return report


@pytest.fixture
def reported(monkeypatch, tmp_path):
    """A function that writes reports, in the test's own folder."""
    return report_writer(monkeypatch, tmp_path)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """The numbers of one report, which no test changes."""
    with pytest.MonkeyPatch.context() as patch:
        _, folder = report_writer(patch, tmp_path_factory.mktemp("reports"))("data")
    return json.loads((folder / "report.json").read_text())


def test_a_repeated_report_has_not_moved_and_says_first_that_its_premises_are_others(reported, capsys):
    _, first = reported("first")
    file = first / "report.json"
    old = json.loads(file.read_text())
    old["environment"]["packages"]["numpy"] = "0.1"
    old["scenes"][0]["premises"]["input"]["adhesion"] = "another"
    old["scenes"][0]["premises"]["tolerances"]["bem"]["values"] = 0.25
    file.write_text(json.dumps(old))
    capsys.readouterr()
    code, second = reported("second", "--baseline", str(file))
    assert code == 0
    printed = capsys.readouterr().out
    for text in (printed, (second / "summary.md").read_text(), (second / "index.html").read_text()):
        places = [
            text.index(said) for said in ("another input: adhesion", "bem: values 0.25", "Nothing moved")
        ]
        assert places == sorted(places)
    baseline = json.loads((second / "report.json").read_text())["baseline"]
    assert (baseline["moves"], len(baseline["changes"])) == ([], 2 + ("numpy" in baseline["changes"][0]))
    assert "Since the baseline" not in (first / "index.html").read_text()


@pytest.mark.parametrize(("stiffness", "beyond"), [(1.02, True), (1.0 + 1e-5, False)])
def test_what_moved_is_named_in_every_form_and_counts_beyond_its_tolerance(
    reported, capsys, stiffness, beyond
):
    old = str(reported("first")[1] / "report.json")
    code, second = reported("second", "--baseline", old, bem=fake(stiffness))
    assert code == int(beyond)
    assert (f"moved: {NAME}: bem: pull_off_force: " in capsys.readouterr().err) is beyond
    for form in ("summary.md", "index.html"):
        assert ("BEYOND" in (second / form).read_text()) is beyond
    moves = json.loads((second / "report.json").read_text())["baseline"]["moves"]
    assert {move["solver"] for move in moves} == {"bem"}
    found = {move["what"]: move for move in moves}["pull_off_force"]
    assert found["change"] == pytest.approx(stiffness - 1.0)
    assert found["tolerance"] == load(NAME).tolerance("bem", "pull_off_force")
    root = tree.parse(second / "junit.xml").getroot()
    (suite,) = [suite for suite in root.iter("testsuite") if suite.get("name") == "baseline"]
    failed = {case.get("classname") for case in suite if case.find("failure") is not None}
    assert failed == ({f"{NAME}.bem"} if beyond else set())
    assert {case.get("classname") for case in suite} == {f"{NAME}.{name}" for name in arguments.names()}


def test_the_baseline_may_be_the_file_that_is_written_and_may_not_state_its_premises(data, reported):
    _, folder = reported("same")
    assert reported("same", "--baseline", str(folder / "report.json"), bem=fake(1.02))[0] == 1
    old = copy.deepcopy(data)
    del old["scenes"][0]["premises"], old["program"], old["environment"]
    assert any("does not say" in line for line in regression.compare("old", old, data, [load(NAME)]).changes)


def moved(old, new):
    return {(m.solver, m.what): m.beyond for m in regression.compare("old", old, new, [load(NAME)]).moves}


def changed(data, solver="bem", **values):
    """The report with other values of a run; a callable takes the value that stands there."""
    new = copy.deepcopy(data)
    run = new["scenes"][0]["runs"][solver]
    for name, value in values.items():
        run[name] = value(run[name]) if callable(value) else value
    return new


def within(share, solver="bem"):
    tolerance = load(NAME).tolerance(solver, "pull_off_force")
    return lambda value: value * (1.0 + share * tolerance)


@pytest.mark.parametrize(
    ("values", "what", "beyond", "back"),
    [
        ({"pull_off_force": within(-2.0)}, "pull_off_force", True, True),
        ({"pull_off_force": within(2.0)}, "pull_off_force", True, True),
        ({"pull_off_force": within(-0.5)}, "pull_off_force", False, False),
        ({"pull_off_force": within(0.5)}, "pull_off_force", False, False),
        ({"pull_off_force": None}, "pull_off_force", True, False),
        ({"counters": lambda c: c | {"steps": round(1.05 * c["steps"])}}, "counters.steps", False, False),
        ({"counters": lambda c: c | {"steps": round(1.2 * c["steps"])}}, "counters.steps", True, False),
        ({"outcome": "step budget exhausted"}, "outcome", True, True),
        ({"wall_seconds": 1e3}, None, None, None),
    ],
)
def test_each_kind_of_move(data, values, what, beyond, back):
    new = changed(data, **values)
    assert moved(data, new) == ({} if what is None else {("bem", what): beyond})
    assert moved(new, data) == ({} if what is None else {("bem", what): back})


def test_verdicts_scenes_and_solvers_lost_count_and_new_ones_do_not(data):
    new = copy.deepcopy(data)
    good = next(check for check in new["scenes"][0]["checks"] if check["passed"])
    good["passed"] = False
    check = good["solver"], f"check of {good['quantity']} ({good['source']})"
    del new["scenes"][0]["runs"]["fem"]
    lost, found = moved(data, new), moved(new, data)
    assert lost[check]
    assert lost["fem", "run"]
    assert not found[check]
    assert not found["fem", "run"]
    new["scenes"] = []
    assert (moved(data, new), moved(new, data)) == ({("", "scene"): True}, {("", "scene"): False})
    assert moved(data, new | {"suite": "full"}) == {}


def test_a_file_that_is_no_report_is_bad_input(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(regression, "LARGEST_REPORT", 200)
    fifo, file = tmp_path / "fifo", tmp_path / "old.json"
    os.mkfifo(fifo)
    contents = [b"", b"[]", b"{}", b'{"scenes": [1]}', b'{"scenes": [{"name": "x"}]}', b"\xff", b" " * 201]
    for content in (*contents, fifo, tmp_path / "none.json"):
        given = content
        if isinstance(content, bytes):
            file.write_bytes(content)
            given = file
        assert "--baseline" in refusal(capsys, "report", "--baseline", given, "--out", tmp_path / "out")
        assert not (tmp_path / "out").exists()
