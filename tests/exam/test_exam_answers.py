"""Files of other codes are hostile input: each fault is told in one line, and nothing breaks."""

from __future__ import annotations

import json

import pytest
from support.exam_answers import SCENE, case, hertz, put, text

from contact_scene import OutcomeKind, SceneError
from validation.exam import answer as answer_module
from validation.exam.answer import read_answer
from validation.exam.answer_folder import read_folder
from validation.exam.scene_json import expanded

HEAD = "# code: a code\n"
TIMED = HEAD + "time,force\n0,0\n"
FAULTS = {
    "": "header: code: is missing",
    HEAD: "no rows of numbers",
    "# code: <script>\ntime,force\n0,0\n": "header: code: got '<script>'",
    "# code: $x$\ntime,force\n0,0\n": "header: code",
    **{
        HEAD + f"# seconds: {value}\n{TIMED[9:]}": "header: seconds" for value in ("-1", "nan", "1e-300", "x")
    },
    **{HEAD + f"# {key}: -1\n{TIMED[9:]}": f"header: {key}" for key in ("tabor", "transition", "outcome")},
    HEAD + "# units: mm\ntime,force\n0,0\n": "header: units: got 'mm'; allowed: scene",
    HEAD + "# problem: [1\ntime,force\n0,0\n": "header: problem",
    HEAD + "time,force [N]\n0,0\n": "column 'force' states a unit",
    HEAD + "time,load\n0,0\n": "columns: got 'time,load'",
    HEAD + "force,force\n0,0\n": "columns: force stands twice",
    HEAD + "force,penetration\n0,0\n": "allowed: time and at least one of penetration",
    HEAD + "time,force\n": "no rows of numbers",
    TIMED + "1\n": "line 4: 1 cells; allowed: 2",
    **{TIMED + f"1,{cell}\n": "force, line 4" for cell in ("nan", "inf", "1e99", "1_0", "x")},
    TIMED + "2,0\n1,0\n": "time, line 5: runs backwards (2 -> 1)",
    HEAD + "time,force\n-1,0\n": "time, line 3",
    HEAD + "time,contact_radius\n0,-1\n": "contact_radius, line 3",
    TIMED + "0,0\n" * 3: "has 4 rows; allowed: 1 to 3 rows",
    HEAD + TIMED: "header: code: is given twice",
    HEAD + "time;force\n0,5;0,1\n": "line 3: cells are separated by semicolons and numbers have",
    TIMED.replace("\n", "\r"): "a carriage return alone",
    TIMED.replace("", "\0"): "zero bytes",
}


@pytest.mark.parametrize("content", FAULTS, ids=range(len(FAULTS)))
def test_a_fault_is_told_in_one_line(tmp_path, content, monkeypatch):
    monkeypatch.setattr(answer_module, "MOST_ROWS", 3)
    answer = read_answer(put(tmp_path, content), "x/trace.csv")
    assert answer.problem.startswith("x/trace.csv: ")
    assert FAULTS[content] in answer.problem
    assert "\n" not in answer.problem
    assert str(tmp_path) not in answer.problem
    assert not answer.columns


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"a" * 10_000_001], ids=["utf", "size"])
def test_a_file_that_is_no_text(tmp_path, content):
    path = put(tmp_path, "")
    path.write_bytes(content)
    problem = read_answer(path, "x").problem
    assert problem
    assert "\n" not in problem


def test_the_header_is_read_and_made_harmless(tmp_path):
    more = {"version": "2.0 $\\alpha$<b>", "seconds": 3.5, "resolution": 64, "transition": 5, "colour": "red"}
    answer = read_answer(put(tmp_path, text(hertz(5), **more)), "x")
    assert answer.problem == ""
    assert (answer.header.label, answer.header.seconds) == ("a code 2.0 alphab", 3.5)
    assert (answer.header.resolution, answer.header.transition) == ("64", 5.0)
    assert "'colour' is no key" in answer.remarks[0]
    many = "".join(f"# key{number}: 1\n" for number in range(500))
    (told,) = read_answer(put(tmp_path, many + text(hertz(5))), "x").remarks
    assert "'key0' and 499 more are no keys" in told
    tabor = read_answer(put(tmp_path, text(hertz(5), tabor=2)), "x").header.transition
    assert tabor == pytest.approx(2.314)


def test_contact_is_lost_where_the_radius_says_so(tmp_path):
    columns = {name: column[:-1] for name, column in hertz(5).items()}
    held = read_answer(put(tmp_path, text(columns)), "x").trace()
    told = read_answer(put(tmp_path, text(columns, outcome="detached")), "x").trace()
    assert (held.outcome.kind, told.outcome.kind) == (OutcomeKind.COMPLETED, OutcomeKind.DETACHED)
    lost = read_answer(put(tmp_path, text(hertz(5))), "x").trace()
    assert lost.outcome.kind is OutcomeKind.DETACHED
    assert lost.outcome.time == 6.0


def test_a_folder_of_answers(tmp_path):
    put(tmp_path / "a", text(hertz(5)))
    put(tmp_path / "a", text(hertz(5)), "trace-64.csv")
    put(tmp_path / "b", text(hertz(5), code="b", scene=SCENE), scene="anything")
    put(tmp_path / "c", text(hertz(5), code="c"), scene="no-such-scene")
    put(tmp_path / "d", "d: no viscosity\n", "declined.txt")
    (tmp_path / "code.toml").write_text('code = "e"\ndeclines = ["elastic", "no-tag"]\n')
    (tmp_path / "b" / "code.toml").write_text("code = [")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    (tmp_path / "b" / "no").mkdir()
    (tmp_path / "b" / "no" / "code.toml").write_text('code = "<b>"')
    (tmp_path / "b" / "lists").mkdir()
    (tmp_path / "b" / "lists" / "code.toml").write_text('code = "f"\ndeclines = [["elastic"], 3]')
    put(tmp_path / "a", text(hertz(5)), "trace-\n.csv")
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
    assert other.problem == (
        f"other/{SCENE}/trace.csv: answers another scene of this name: loading.steps.0.rate is 0.02 there, "
        "0.01 here"
    )
    assert not other.columns


def test_why_a_folder_holds_no_answer(tmp_path):
    put(tmp_path / "a" / "b" / "c" / "d", text(hertz(5)))
    with pytest.raises(SceneError, match=r"no answer \(.*folders more than 4 deep are not looked into"):
        read_folder(tmp_path)
    put(tmp_path, text(hertz(5)), scene="no-such-scene")
    with pytest.raises(SceneError, match=r"no answer \(no-such-scene/trace.csv: 'no-such-scene' is no scene"):
        read_folder(tmp_path)


def test_folders_that_cannot_be_judged(tmp_path):
    with pytest.raises(SceneError, match="is no folder"):
        read_folder(tmp_path / "none")
    with pytest.raises(SceneError, match="holds no answer"):
        read_folder(tmp_path)
    for content in ("[1", "{}", '{"scenes": [{"name": "../x"}]}', '{"scenes": 3}'):
        (tmp_path / "exam.json").write_text(content)
        with pytest.raises(SceneError, match=r"exam\.json") as raised:
            read_folder(tmp_path)
        assert "\n" not in str(raised.value)
