"""Two reports compared: every kind of move is listed, and only those that count change the exit code."""

from __future__ import annotations

import copy
import json
import os
import xml.etree.ElementTree as tree

import pytest
from support.spring_solver import fake, named

from crosscontact import arguments
from crosscontact.cli import main
from validation import solvers
from validation.cases import load
from validation.compare import regression
from validation.report.document import Figures

NAME = "cycle-v0.1"
WORD = "beyond tolerance"


def report_writer(monkeypatch, tmp_path):
    """What writes a report of one scene with fakes of the given stiffness, and returns code and folder."""
    monkeypatch.setattr("validation.scenes.suite", lambda suite: [NAME])
    monkeypatch.setattr(
        "crosscontact.commands.report.exit_code", lambda failures: 0
    )  # only the baseline counts here
    monkeypatch.setattr("validation.compare.scene_page.figures", lambda scene: Figures(()))  # drawn elsewhere

    def report(name: str, *more: str, **factories):
        for solver in arguments.names():
            monkeypatch.setitem(solvers.SOLVERS, solver, named(solver, factories.get(solver, fake())))
        folder = tmp_path / name
        # without estimates: a fake is the same at any resolution, hence says it is exact
        return main(["report", "--jobs", "1", "--no-estimates", "--out", str(folder), *more]), folder

    return report


@pytest.fixture
def reported(monkeypatch, tmp_path):
    """A function that writes reports, in the test's own folder."""
    return report_writer(monkeypatch, tmp_path)


def test_nothing_moves_in_a_repeated_report(reported, capsys):
    _, first = reported("first")
    code, second = reported("second", "--baseline", str(first / "report.json"))
    assert code == 0
    assert "Nothing moved since" in capsys.readouterr().out
    assert "Nothing moved since" in (second / "summary.md").read_text()
    assert "Nothing moved since" in (second / "index.html").read_text()
    assert json.loads((second / "report.json").read_text())["baseline"]["moves"] == []
    assert "Since the baseline" not in (first / "index.html").read_text()


def test_a_move_beyond_tolerance_is_named_and_exits_1(reported, capsys):
    _, first = reported("first")
    old = str(first / "report.json")
    code, second = reported("second", "--baseline", old, bem=fake(1.02))
    out, err = capsys.readouterr()
    assert code == 1
    assert WORD in out
    assert f"moved: {NAME}: bem: pull_off_force: " in err
    for form in ("summary.md", "index.html"):
        text = (second / form).read_text()
        assert "Since the baseline" in text
        assert "BEYOND" in text
        assert "+2.0e-02" in text


def test_other_premises_are_said_first(reported, monkeypatch, capsys):
    _, first = reported("first")
    old = json.loads((first / "report.json").read_text())
    old["program"] = "another"
    old["environment"]["packages"]["numpy"] = "0.1"
    old["scenes"][0]["premises"]["input"]["adhesion"] = "another"
    old["scenes"][0]["premises"]["tolerances"]["bem"]["values"] = 0.25
    del old["scenes"][0]["premises"]["tolerances"]["fem"]
    (first / "report.json").write_text(json.dumps(old))
    capsys.readouterr()
    code, second = reported("second", "--baseline", str(first / "report.json"))
    assert code == 0
    lines = capsys.readouterr().out.splitlines()
    verdict = next(index for index, line in enumerate(lines) if "moved since" in line)
    said = lines[verdict - 3 : verdict]
    assert said[0].startswith("changed: another version of the program or its packages: commit ")
    assert "numpy 0.1 -> " in said[0]
    assert said[1] == f"changed: {NAME}: another input: adhesion"
    now = load(NAME).tolerance("bem", "values")
    assert said[2] == f"changed: {NAME}: other tolerances of bem: values 0.25 -> {now}"
    changed = json.loads((second / "report.json").read_text())["baseline"]["changes"]
    assert [f"changed: {line}" for line in changed] == said
    for form in ("summary.md", "index.html"):
        text = (second / form).read_text()
        assert text.index("another input: adhesion") < text.index("Nothing moved since")


def test_an_earlier_report_without_premises_is_said(data):
    old = copy.deepcopy(data)
    del old["scenes"][0]["premises"], old["program"], old["environment"]
    changes = regression.compare("old", old, data, [load(NAME)]).changes
    assert "commit unknown -> " in changes[0]
    assert changes[1] == f"{NAME}: input and tolerances: the earlier report does not say"


def test_junit_holds_the_verdicts(reported):
    _, first = reported("first")
    _, second = reported("second", "--baseline", str(first / "report.json"), bem=fake(1.02))
    root = tree.parse(second / "junit.xml").getroot()
    (suite,) = [suite for suite in root.iter("testsuite") if suite.get("name") == "baseline"]
    cases = {(case.get("classname"), case.get("name").split(" ", 1)[1]): case for case in suite}
    failed = {name for (_, name), case in cases.items() if case.find("failure") is not None}
    source = f"(baseline {first / 'report.json'})"
    assert f"pull_off_force {source}" in failed
    assert {classname for classname, _ in cases} == {f"{NAME}.{name}" for name in arguments.names()}
    assert (f"{NAME}.reference", f"all values {source}") in cases
    assert suite.get("failures") == str(len(failed))


def test_a_small_move_is_listed_but_harmless(reported, capsys):
    _, first = reported("first")
    old = str(first / "report.json")
    code, second = reported("second", "--baseline", old, bem=fake(1.0 + 1e-5))
    assert code == 0
    assert "0 of them beyond tolerance" in capsys.readouterr().out
    moves = json.loads((second / "report.json").read_text())["baseline"]["moves"]
    assert {move["solver"] for move in moves} == {"bem"}
    found = {move["what"]: move for move in moves}["pull_off_force"]
    assert found["change"] == pytest.approx(1e-5)
    assert found["tolerance"] == load(NAME).tolerance("bem", "pull_off_force")
    assert "| BEYOND |" not in (second / "summary.md").read_text()


@pytest.mark.slow
def test_the_baseline_may_be_the_file_that_is_written(reported):
    _, folder = reported("same")
    code, _ = reported("same", "--baseline", str(folder / "report.json"), bem=fake(1.02))
    assert code == 1


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """The numbers of one report, which no test changes."""
    with pytest.MonkeyPatch.context() as patch:
        _, folder = report_writer(patch, tmp_path_factory.mktemp("reports"))("data")
    return json.loads((folder / "report.json").read_text())


def moved(old, new):
    return {(m.solver, m.what): m for m in regression.compare("old", old, new, [load(NAME)]).moves}


def run_of(data, solver="bem"):
    return data["scenes"][0]["runs"][solver]


@pytest.mark.parametrize(("factor", "beyond"), [(1.05, False), (1.2, True), (0.5, False)])
def test_more_work_counts_less_does_not(data, factor, beyond):
    new = copy.deepcopy(data)
    run_of(new)["counters"]["steps"] = round(factor * run_of(data)["counters"]["steps"])
    assert moved(data, new)["bem", "counters.steps"].beyond is beyond


def test_run_time_is_no_move(data):
    new = copy.deepcopy(data)
    run_of(new)["wall_seconds"] = 1e3
    assert moved(data, new) == {}


def test_a_lost_value_counts_a_new_one_does_not(data):
    new = copy.deepcopy(data)
    run_of(new)["pull_off_force"] = None
    assert moved(data, new)["bem", "pull_off_force"].beyond
    assert not moved(new, data)["bem", "pull_off_force"].beyond


@pytest.mark.parametrize("solver", ["bem", "reference"])
@pytest.mark.parametrize(("share", "beyond"), [(-2.0, True), (-0.5, False), (0.5, False), (2.0, True)])
def test_a_value_that_falls_counts_like_one_that_rises(data, solver, share, beyond):
    new = copy.deepcopy(data)
    move = share * load(NAME).tolerance(solver, "pull_off_force")
    run_of(new, solver)["pull_off_force"] *= 1.0 + move
    found = moved(data, new)[solver, "pull_off_force"]
    assert found.change == pytest.approx(move)
    assert found.beyond is beyond


def test_another_ending_counts(data):
    new = copy.deepcopy(data)
    run_of(new)["outcome"] = "step budget exhausted"
    assert moved(data, new)["bem", "outcome"].beyond


def test_verdicts_lost_and_mended(data):
    new = copy.deepcopy(data)
    good = next(check for check in new["scenes"][0]["checks"] if check["passed"])
    good["passed"] = False
    what = f"check of {good['quantity']} ({good['source']})"
    assert moved(data, new)[good["solver"], what].beyond
    assert not moved(new, data)[good["solver"], what].beyond


def test_missing_scenes_and_solvers_count_in_the_same_suite_only(data):
    new = copy.deepcopy(data)
    del new["scenes"][0]["runs"]["fem"]
    assert moved(data, new)["fem", "run"].beyond
    assert not moved(new, data)["fem", "run"].beyond
    new["scenes"] = []
    assert moved(data, new)["", "scene"].beyond
    assert not moved(new, data)["", "scene"].beyond
    new["suite"] = "full"
    assert moved(data, new) == {}


@pytest.mark.parametrize(
    "content", ["", "[]", "{}", '{"scenes": [1]}', '{"scenes": [{"name": "x"}]}', "\xff"]
)
def test_a_file_that_is_no_report_is_bad_input(tmp_path, capsys, content):
    file = tmp_path / "old.json"
    file.write_bytes(content.encode("latin-1"))
    assert main(["report", "--baseline", str(file), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "--baseline" in said
    assert not (tmp_path / "out").exists()


def test_a_missing_baseline_is_bad_input(tmp_path, capsys):
    assert main(["report", "--baseline", str(tmp_path / "none.json"), "--out", str(tmp_path / "out")]) == 2
    assert "--baseline" in capsys.readouterr().err


def test_what_cannot_be_read_to_its_end_is_no_baseline(tmp_path, capsys, monkeypatch):
    fifo, large = tmp_path / "fifo", tmp_path / "large.json"
    os.mkfifo(fifo)
    large.write_text("[1, 2, 3]")
    monkeypatch.setattr(regression, "LARGEST_REPORT", 5)
    for file, reason in (
        (fifo, "not a regular file"),
        ("/dev/zero", "not a regular file"),
        (large, "larger"),
    ):
        assert main(["report", "--baseline", str(file), "--out", str(tmp_path / "out")]) == 2
        (said,) = capsys.readouterr().err.splitlines()
        assert "--baseline" in said
        assert reason in said
