"""What is exported: a twin that holds the whole scene, a page, tags; a whole exam up to the verdict."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from support.exam_answers import SCENE, case, hertz, text

from contact_scene import Scene, SceneError, load_steps, read_scene
from contact_scene.checked import fields_of
from crosscontact.cli import main
from validation.cases import load
from validation.exam import judge
from validation.exam.answer import Header, read_header
from validation.exam.export import exam_cases, export_reference, export_scenes
from validation.exam.judge import reference_runs
from validation.exam.scene_json import expanded, scene_of
from validation.exam.statement import SHAPES, STEPS, page
from validation.exam.tags import POSSIBLE, tags
from validation.scenes import suite

SCRIPT = Path(__file__).parents[2] / "docs" / "how-to" / "closed_forms.py"
SCENES = ("cycle-v0.02", "punch-programme", "repressed-profile", "three-branches", "cone-pull", "sweep")


@pytest.mark.parametrize("name", SCENES)
def test_the_twin_holds_the_whole_scene(name):
    scene = load(name).scene
    data = json.loads(json.dumps(expanded(scene)))
    assert scene_of(data) == scene
    assert '"file"' not in json.dumps(data)
    assert {"branches", "bulk"} <= set(data["material"])
    assert data["derived"]["glassy_modulus"] == scene.material.glassy_modulus


def test_twins_that_are_none_are_told():
    for wrong in (None, 3, {}, {"material": 1}, {**expanded(load("punch-programme").scene), "extra": 1}):
        with pytest.raises(SceneError):
            scene_of(wrong)
    data = expanded(load("repressed-profile").scene)
    data["indenter"]["heights"] = 3
    with pytest.raises(SceneError, match=r"indenter\.heights: got 3"):
        scene_of(data)


def test_tags():
    assert tags(load("cycle-v0.02").scene) == ("adhesive", "ramp", "sphere", "viscoelastic")
    assert {"punch", "force-control", "spectrum", "table", "oscillation", "hold"} <= set(
        tags(load("punch-programme").scene)
    )
    assert {"elastic", "adhesionless"} <= set(tags(case().scene))
    assert {tag for name in SCENES for tag in tags(load(name).scene)} <= POSSIBLE


def test_the_page_of_results_has_a_scene_of_every_tag():
    text = SCRIPT.with_name("exam-results.md").read_text("utf-8")
    shown = re.findall(r"^\| ([\w.-]+) \|", text.partition("## Verdicts")[2].partition("\n| code |")[0], re.M)
    shown = [name for name in shown if name != "scene"]
    assert len(shown) == 15
    answered = {tag for name in shown for tag in tags(load(name).scene)}
    of_exams = {tag for name in suite("full") for tag in tags(load(name).scene)}
    assert of_exams - answered == {"sweep", "separate-bulk"}  # minutes long; not answered by the reference
    assert {"work-closing", "rate", "stress", "spring", "profile", "punch", "cone"} <= answered


def test_the_page_states_the_scene_in_words():
    words = page(load("punch-programme"))
    for said in ("flat-ended cylinder of radius `100.0`", "modulus 0.9, time 1.1", "1. the penetration goes"):
        assert said in words
    assert "7. the force" not in words
    assert "6. the force goes linearly to `1000.0` at `200.0`" in words
    assert "`zone = 0.013`" in page(load("cycle-v0.02"))
    assert "No adhesion" in page(case())
    assert "the step ends as soon as the force is" in page(load("spring-elastic"))
    assert set(STEPS) | set(SHAPES) == {step.kind for step in load_steps.STEPS} | {
        shape.shape for shape in fields_of(Scene)["indenter"].kinds
    }


def test_a_header_says_all_that_is_needed_to_compute_it_again():
    scene = load("repressed-profile").scene
    header = Header("reference", resolution="32", seconds=0.25, scene="x", problem=expanded(scene))
    again, odd = read_header(header.lines())
    assert odd == []
    assert again == header
    assert scene_of(again.problem) == scene


def test_an_exported_exam(tmp_path):
    cases = exam_cases("quick")
    names = [one.name for one in cases]
    assert {"cycle-v0.02", "adhesionless-force", SCENE} <= set(names)
    assert "bulk-punch" not in names
    export_scenes(tmp_path, cases[:3])
    for one in cases[:3]:
        assert read_scene(tmp_path / one.name / "scene.toml") == one.scene
        assert json.loads((tmp_path / one.name / "scene.json").read_text())["tags"] == [*tags(one.scene)]
    listed = json.loads((tmp_path / "exam.json").read_text())["scenes"]
    assert [entry["name"] for entry in listed] == names[:3]


def test_bad_input_is_told_in_a_line(tmp_path, capsys):
    for command in (
        ["judge", str(tmp_path / "none")],
        ["judge", str(tmp_path)],
        ["exam", "answer", str(tmp_path), "--solvers", "bem"],
        ["exam", "reproduce", str(tmp_path / "none.csv")],
    ):
        assert main(command) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    stated = json.dumps(expanded(case().scene))
    wrong = {
        text(hertz(5)): "header: problem: is missing",
        text(hertz(5), problem=stated): "header: code: got 'a code'; allowed: one of bem, fem, reference",
        text(hertz(5), "bem", problem='{"a": 1}'): "wrong.csv: header: problem: a: unknown key",
        text(hertz(5), "bem", problem=stated, resolution="x"): "header: resolution: got 'x'",
        text(hertz(5), "bem", problem=stated, resolution="2"): "resolution",
    }
    for content, said in wrong.items():
        (tmp_path / "wrong.csv").write_text(content)
        assert main(["exam", "reproduce", str(tmp_path / "wrong.csv")]) == 2
        (told,) = capsys.readouterr().err.splitlines()
        assert said in told
        assert told.count("allowed:") <= 1
    with pytest.raises(SystemExit) as ended:
        main(["exam", "answer", str(tmp_path), "--solvers", "bem,nobody"])
    assert ended.value.code == 2
    assert "'nobody'" in capsys.readouterr().err


@pytest.fixture
def _usual_reference(monkeypatch):
    """The reference at its default resolution, of half the steps: what is asked is where its numbers go."""
    monkeypatch.setattr(judge, "FINER", 1)


@pytest.mark.slow
@pytest.mark.usefixtures("_usual_reference")
def test_a_whole_exam_by_a_script_in_plain_numpy(tmp_path, capsys):
    """Export, answer by the script of the page, judge; the reference computed again from its header."""
    lines = SCRIPT.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 30
    assert max(map(len, lines)) <= 100
    export_scenes(tmp_path, [one for one in exam_cases("quick") if one.name in ("adhesionless-cycle", SCENE)])
    subprocess.run([sys.executable, str(SCRIPT), str(tmp_path)], check=True)
    (tmp_path / SCENE / "trace.csv").unlink()  # half of the scenes: judged on those
    assert main(["judge", str(tmp_path), "--out", str(tmp_path / "report"), "--jobs", "1"]) == 0
    assert "1 verdict on answers: all passed" in capsys.readouterr().out
    data = json.loads((tmp_path / "report" / "exam.json").read_text())
    assert [one["verdicts"][0]["verdict"] for one in data["scenes"]] == ["passed at 1e-5", "no answer"]
    assert main(["exam", "answer", str(tmp_path), "--solvers", "reference", "--resolution", "4"]) == 0
    written = tmp_path / "answers" / "reference-4" / SCENE / "trace.csv"
    assert main(["exam", "reproduce", str(written)]) == 0
    assert "the same bit for bit" in capsys.readouterr().out
    written.write_text(written.read_text().replace("# resolution: 4", "# resolution: 5"))
    assert main(["exam", "reproduce", str(written)]) == 1


@pytest.mark.slow
@pytest.mark.usefixtures("_usual_reference")
def test_a_reference_trace_is_reproduced_from_its_header_alone(tmp_path, capsys):
    """A scene with a spring and a trigger, all of which the header holds; no file beside it."""
    asked = [replace(load("spring-elastic"), profile_times=())]
    export_scenes(tmp_path, asked)
    runs = reference_runs(asked)
    export_reference(tmp_path, asked, runs)
    folder = tmp_path / "spring-elastic"
    known = json.loads((folder / "reference.json").read_text())
    assert known["outcome"] == "detached"
    assert known["measures"]["pull_off_force"] == runs["spring-elastic"].measures["pull_off_force"]
    assert 0.0 < known["relative_errors"]["force"] < 1e-4
    alone = tmp_path / "elsewhere" / "x.csv"
    alone.parent.mkdir()
    content = (folder / "reference.csv").read_text()
    alone.write_text(content)
    assert main(["exam", "reproduce", str(alone)]) == 0
    assert "the same bit for bit" in capsys.readouterr().out
    assert content.count('"modulus": 0.75') == 1
    alone.write_text(content.replace('"modulus": 0.75', '"modulus": 0.76'))
    assert main(["exam", "reproduce", str(alone)]) == 1
