"""Files of other codes are hostile input: each fault is told in one line, and nothing breaks."""

from __future__ import annotations

import json

import pytest
from support.exam_answers import SCENE, case, hertz, put, text
from support.wrong_values import refusal

from contact_scene import OutcomeKind
from validation.exam import answer as answer_module
from validation.exam.answer import read_answer, read_folder
from validation.exam.question import expanded

HEAD = "# code: a code\n"
TIMED = HEAD + "time,force\n0,0\n"
FAULTS = {
    "": "header: code: is missing",
    HEAD: "no rows of numbers",
    "# code: <script>\ntime,force\n0,0\n": "header: code: got '<script>'",
    **{HEAD + f"# seconds: {value}\n{TIMED[9:]}": "header: seconds" for value in ("-1", "nan", "x")},
    **{HEAD + f"# {key}: -1\n{TIMED[9:]}": f"header: {key}" for key in ("tabor", "transition", "outcome")},
    HEAD + "# units: mm\ntime,force\n0,0\n": "header: units: got 'mm'",
    HEAD + "# problem: [1\ntime,force\n0,0\n": "header: problem",
    HEAD + "time,force [N]\n0,0\n": "column 'force' states a unit",
    HEAD + "force,penetration\n0,0\n": "allowed: time and at least one of penetration",
    TIMED + "1\n": "line 4: 1 cells; allowed: 2",
    TIMED + "1,nan\n": "force, line 4",
    TIMED + "2,0\n1,0\n": "time, line 5: runs backwards (2 -> 1)",
    HEAD + "time,force\n-1,0\n": "time, line 3",
    HEAD + "time,contact_radius\n0,-1\n": "contact_radius, line 3",
    TIMED + "0,0\n" * 3: "has 4 rows; allowed: 1 to 3 rows",
    HEAD + TIMED: "header: code: is given twice",
    HEAD + "time;force\n0,5;0,1\n": "line 3: numbers have decimal commas",
    TIMED.replace("\n", "\r"): "a carriage return alone",
    TIMED.replace("", "\0"): "zero bytes",
    TIMED + "#" * 10_000_001: "",
    TIMED + "\udcff": "",
}


@pytest.mark.parametrize("content", FAULTS, ids=range(len(FAULTS)))
def test_a_fault_is_told_in_one_line(tmp_path, content, monkeypatch):
    monkeypatch.setattr(answer_module, "MOST_ROWS", 3)
    path = put(tmp_path, "")
    path.write_bytes(content.encode("utf-8", "surrogateescape"))
    answer = read_answer(path, "x/trace.csv")
    assert answer.problem.startswith("x/trace.csv: ")
    assert FAULTS[content] in answer.problem
    assert "\n" not in answer.problem
    assert str(tmp_path) not in answer.problem
    assert not answer.columns


def test_the_header_is_read_and_made_harmless(tmp_path):
    more = {"version": "2.0 $\\alpha$<b>", "seconds": 3.5, "resolution": 64, "tabor": 2, "colour": "red"}
    answer = read_answer(put(tmp_path, text(hertz(5), **more)), "x")
    assert (answer.problem, answer.header.version, answer.header.seconds) == ("", "2.0 alphab", 3.5)
    assert (answer.header.scene, answer.header.resolution) == (SCENE, "64")
    assert answer.header.transition == pytest.approx(2.314)
    assert "'colour' is no key" in answer.remarks[0]


def test_contact_is_lost_where_the_radius_says_so(tmp_path):
    columns = {name: column[:-1] for name, column in hertz(5).items()}
    held = read_answer(put(tmp_path, text(columns)), "x").trace()
    told = read_answer(put(tmp_path, text(columns, outcome="detached")), "x").trace()
    lost = read_answer(put(tmp_path, text(hertz(5))), "x").trace()
    assert [one.outcome.kind for one in (held, told, lost)] == [
        OutcomeKind.COMPLETED,
        OutcomeKind.DETACHED,
        OutcomeKind.DETACHED,
    ]
    assert lost.outcome.time == 6.0


def test_a_folder_of_answers(tmp_path):
    put(tmp_path / "a", text(hertz(5)))
    put(tmp_path / "a", text(hertz(5)), "trace-64.csv")
    put(tmp_path / "b", text(hertz(5), code="b", scene=SCENE), scene="anything")
    put(tmp_path / "c", text(hertz(5), code="c"), scene="no-such-scene")
    put(tmp_path / "d", "d: no viscosity\n", "declined.txt")
    (tmp_path / "code.toml").write_text('code = "e"\ndeclines = ["elastic", "no-tag"]\n')
    for folder, content in {
        "b": "code = [",
        "b/no": 'code = "<b>"',
        "b/lists": 'code = "f"\ndeclines = [["elastic"], 3]',
    }.items():
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / "code.toml").write_text(content)
    put(tmp_path / "a", text(hertz(5)), "trace-\n.csv")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    (tmp_path / "a" / SCENE / "trace-128.csv").symlink_to(tmp_path / "a" / SCENE / "trace.csv")
    (tmp_path / "answers.zip").write_bytes(b"PK")
    found = read_folder(tmp_path)
    assert [case.name for case in found.cases] == [SCENE]
    assert sorted(one.header.code for one in found.answers) == ["a code", "a code", "a code", "b"]
    assert f"a/{SCENE}/trace-?.csv" in {one.file for one in found.answers}
    assert found.declined == {("d", SCENE): "no viscosity", ("e", SCENE): "by tag: elastic"}
    told = "\n".join(found.remarks)
    for said in (
        "'no-such-scene' is no scene",
        "'no-tag' is no tag",
        "b/code.toml: not a TOML file",
        "b/no/code.toml: code: got '<b>'",
        "b/lists/code.toml: declines",
        "'trace-128.csv': symbolic links are not followed",
        "'answers.zip': archives are not unpacked",
    ):
        assert said in told
    assert all("\n" not in remark for remark in found.remarks)


def test_an_answer_to_another_version_of_the_scene_is_told(tmp_path):
    stated = expanded(case().scene)
    put(tmp_path / "same", text(hertz(5), problem=json.dumps(stated | {"title": "in other words"})))
    stated["loading"]["steps"][0]["rate"] = 0.02
    put(tmp_path / "other", text(hertz(5), problem=json.dumps(stated)))
    other, same = read_folder(tmp_path).answers
    assert same.problem == ""
    told = "answers another scene of this name: loading.steps.0.rate is 0.02 there, 0.01 here"
    assert other.problem == f"other/{SCENE}/trace.csv: {told}"
    assert not other.columns


def test_folders_that_cannot_be_judged(tmp_path):
    def refused(folder):
        return str(refusal(read_folder, folder))

    assert "is no folder" in refused(tmp_path / "none")
    assert "holds no answer;" in refused(tmp_path)
    put(tmp_path / "a" / "b" / "c" / "d", text(hertz(5)))
    assert "folders more than 4 deep are not looked into" in refused(tmp_path)
    for content in ("[1", "{}", '{"scenes": [{"name": "../x"}]}', '{"scenes": 3}'):
        (tmp_path / "exam.json").write_text(content)
        assert "exam.json" in refused(tmp_path)
