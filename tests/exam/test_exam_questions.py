"""What is exported: the whole scene as JSON and in words, its tags; a whole exam up to the verdict."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from support.exam_answers import SCENE, case, hertz, text

from contact_scene import SceneError, read_scene
from crosscontact.cli import main
from validation.cases import load
from validation.exam import own_answers
from validation.exam.answer import Header, read_header
from validation.exam.own_answers import export_reference
from validation.exam.question import POSSIBLE, exam_cases, expanded, export_scenes, page, scene_of, tags
from validation.scenes import names

SCRIPT = Path(__file__).parents[2] / "docs" / "how-to" / "closed_forms.py"


@pytest.mark.parametrize("name", names())
def test_json_and_page_state_the_whole_scene(name):
    """Every number of loading and indenter stands on the page, unless it names the table that has it."""
    scene = load(name).scene
    data = json.loads(json.dumps(expanded(scene)))
    assert scene_of(data) == scene
    assert '"file"' not in json.dumps(data)
    words = page(load(name))
    steps = [value for step in data["loading"]["steps"] for value in step.values()]
    numbers = [value for value in [*steps, *data["indenter"].values()] if isinstance(value, float)]
    assert all(f"{value}" in words for value in numbers if value)
    assert {tag for tag in tags(scene) if tag not in POSSIBLE} <= {
        "body",
        "machine",
        "rate",
        "stress",
        "work-closing",
    }
    header = Header("reference", resolution="32", seconds=0.25, scene="x", problem=expanded(scene))
    assert read_header(header.lines()) == (header, [])


def test_what_is_no_scene_is_told():
    for wrong in (None, 3, {}, {"material": 1}, {**expanded(load("punch-programme").scene), "extra": 1}):
        with pytest.raises(SceneError):
            scene_of(wrong)


def test_an_exported_exam(tmp_path):
    cases = exam_cases("quick")
    listed = [one.name for one in cases]
    assert {"cycle-v0.02", "adhesionless-force", "bulk-punch", SCENE} <= set(listed)
    assert tags(load("cycle-v0.02").scene) == ("adhesive", "ramp", "sphere", "viscoelastic")
    export_scenes(tmp_path, cases[:3])
    for one in cases[:3]:
        assert read_scene(tmp_path / one.name / "scene.toml") == one.scene
        assert json.loads((tmp_path / one.name / "scene.json").read_text())["tags"] == [*tags(one.scene)]
    entries = json.loads((tmp_path / "exam.json").read_text())["scenes"]
    assert [entry["name"] for entry in entries] == listed[:3]


def test_bad_input_is_told_in_a_line(tmp_path, capsys):
    stated, wrong = json.dumps(expanded(case().scene)), str(tmp_path / "wrong.csv")
    for command, content, said in (
        (["judge", str(tmp_path / "none")], "", "is no folder"),
        (["exam", "answer", str(tmp_path), "--solvers", "bem"], "", "exam.json"),
        (["exam", "reproduce", str(tmp_path / "none.csv")], "", "FILE"),
        (["exam", "reproduce", wrong], text(hertz(5)), "header: problem: is missing"),
        (["exam", "reproduce", wrong], text(hertz(5), problem=stated), "header: code: got 'a code'"),
        (["exam", "reproduce", wrong], text(hertz(5), "bem", problem='{"a": 1}'), "problem: a: unknown key"),
        (["exam", "reproduce", wrong], text(hertz(5), "bem", problem=stated, resolution="x"), "got 'x'"),
        (["exam", "reproduce", wrong], text(hertz(5), "bem", problem=stated, resolution="2"), "resolution"),
    ):
        Path(wrong).write_text(content)
        assert main(command) == 2
        (told,) = capsys.readouterr().err.splitlines()
        assert said in told
        assert told.count("allowed:") <= 1
    with pytest.raises(SystemExit) as ended:
        main(["exam", "answer", str(tmp_path), "--solvers", "bem,nobody"])
    assert ended.value.code == 2
    assert "'nobody'" in capsys.readouterr().err


@pytest.mark.slow
def test_a_whole_exam_by_a_script_in_plain_numpy(tmp_path, capsys):
    """Export, answer by the script of the page, judge; the reference computed again from its header."""
    export_scenes(tmp_path, [one for one in exam_cases("quick") if one.name in ("adhesionless-cycle", SCENE)])
    subprocess.run([sys.executable, str(SCRIPT), str(tmp_path)], check=True)
    (tmp_path / SCENE / "trace.csv").unlink()  # half of the scenes: judged on those
    assert main(["judge", str(tmp_path), "--out", str(tmp_path / "report"), "--jobs", "1"]) == 0
    assert "1 verdict on answers: all passed" in capsys.readouterr().out
    data = json.loads((tmp_path / "report" / "exam.json").read_text())
    # between its rows the script's radius is off by 1.3e-6, next to what the reference knows
    verdict, other = (one["verdicts"][0]["verdict"] for one in data["scenes"])
    assert verdict in ("passed at 1e-5", "passed at 1e-6")
    assert other == "no answer"
    assert main(["exam", "answer", str(tmp_path), "--solvers", "reference", "--resolution", "4"]) == 0
    written = tmp_path / "answers" / "reference-4" / SCENE / "trace.csv"
    assert main(["exam", "reproduce", str(written)]) == 0
    assert "the same bit for bit" in capsys.readouterr().out
    written.write_text(written.read_text().replace("# resolution: 4", "# resolution: 5"))
    assert main(["exam", "reproduce", str(written)]) == 1


@pytest.mark.slow
def test_a_reference_trace_is_reproduced_from_its_header_alone(tmp_path, monkeypatch):
    """A scene with a spring and a trigger, all of which the header holds; no file beside it."""
    monkeypatch.setattr(own_answers, "FINER", 1)
    asked = [replace(load("spring-elastic"), profile_times=())]
    export_scenes(tmp_path, asked)
    (run,) = export_reference(tmp_path, asked)
    folder = tmp_path / "spring-elastic"
    known = json.loads((folder / "reference.json").read_text())
    assert known["outcome"] == "detached"
    assert known["measures"]["pull_off_force"] == run.measures["pull_off_force"]
    assert 0.0 < known["relative_errors"]["force"] < 1e-4
    alone = tmp_path / "x.csv"
    content = (folder / "reference.csv").read_text()
    for written, code in ((content, 0), (content.replace('"modulus": 0.75', '"modulus": 0.76'), 1)):
        alone.write_text(written)
        assert main(["exam", "reproduce", str(alone)]) == code
