"""Files of other codes are hostile input: each fault is told in one line, and nothing breaks."""

from __future__ import annotations

import pytest
from support.exam_answers import SCENE, hertz, put, text

from contact_scene import OutcomeKind, SceneError
from validation.exam import answer as answer_module
from validation.exam.answer import read_answer
from validation.exam.answer_folder import read_folder

HEAD = "# code: a code\n"
FAULTS = {
    "": "header: code: is missing",
    HEAD: "the file is empty",
    "time,force\n0,0\n": "header: code: is missing",
    "# code: <script>\ntime,force\n0,0\n": "header: code: got '<script>'",
    "# code: $x$\ntime,force\n0,0\n": "header: code",
    HEAD + "# seconds: -1\ntime,force\n0,0\n": "header: seconds: got '-1'",
    HEAD + "# seconds: nan\ntime,force\n0,0\n": "header: seconds: got 'nan'",
    HEAD + "# units: mm\ntime,force\n0,0\n": "header: units: got 'mm'; allowed: scene",
    HEAD + "# outcome: lost\ntime,force\n0,0\n": "header: outcome",
    HEAD + "# problem: [1\ntime,force\n0,0\n": "header: problem: is no JSON object",
    HEAD + "time,force [N]\n0,0\n": "column 'force [N]' states a unit",
    HEAD + "time,load\n0,0\n": "columns 'time,load'",
    HEAD + "force,force\n0,0\n": "two columns force",
    HEAD + "force,penetration\n0,0\n": "allowed: time and at least one of penetration",
    HEAD + "time,force\n": "has 0 rows",
    HEAD + "time,force\n0,0\n1\n": "line 4: has 1 cells",
    HEAD + "time,force\n0,0\n1,nan\n": "line 4, force: got 'nan'",
    HEAD + "time,force\n0,0\n1,inf\n": "line 4, force: got 'inf'",
    HEAD + "time,force\n0,0\n1,1e99\n": "line 4, force: got '1e99'",
    HEAD + "time,force\n0,0\n1,1_0\n": "line 4, force: got '1_0'",
    HEAD + "time,force\n0,0\n1,x\n": "line 4, force: got 'x'",
    HEAD + "time,force\n0,0\n2,0\n1,0\n": "line 5, time: runs backwards (2 -> 1)",
    HEAD + "time,force\n-1,0\n": "line 3, time: got -1",
    HEAD + "time,contact_radius\n0,-1\n": "line 3, contact_radius: got -1",
    HEAD + "time,force\n" + "0,0\n" * 4: "has 4 rows; allowed: 1 to 3 rows",
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


@pytest.mark.parametrize(
    "content", [b"\xff\xfe\x00", b"\x00" * 10, b"a" * 10_000_001], ids=["utf", "nul", "size"]
)
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
    found = read_folder(tmp_path)
    assert [case.name for case in found.cases] == [SCENE]
    assert sorted(one.header.code for one in found.answers) == ["a code", "a code", "b"]
    assert found.declined == {("d", SCENE): "no viscosity", ("e", SCENE): "by tag: elastic"}
    told = "\n".join(found.remarks)
    for said in ("'no-such-scene' is no scene", "'no-tag' is no tag", "b/code.toml: not a TOML file"):
        assert said in told


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
