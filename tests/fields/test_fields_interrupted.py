"""What a ``fields`` command announces, refuses, and says where it is interrupted."""

from __future__ import annotations

import pytest
from support.scene_text import DOWN_AND_UP

from contact_scene import read_scene
from crosscontact.cli import main
from crosscontact.commands import fields
from validation.cases import Case
from validation.fields.figures import figure_set
from validation.fields.figures.figure_set import FigureSet
from validation.fields.request import FieldRequest, record_fields
from validation.solvers import Cost


@pytest.fixture(scope="module")
def recorded():
    """One run for all commands: it is the same to the bit each time."""
    runs = {}

    def once(scene, request, *rest):
        key = request.times, request.every
        if key not in runs:
            runs[key] = record_fields(scene, request, *rest)
        return runs[key]

    return once


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "down-and-up.toml"
    path.write_text(DOWN_AND_UP, encoding="utf-8")
    return str(path)


SHORT = Cost(1000.0, 5.0, 1e6)
ANNOUNCED = {
    "14 s, 1.0 MB of memory, 23 moments of 2 MB for ParaView, 0 pictures": (
        FieldRequest((0.0, 0.1), pull_off=True, every=50),
        None,
    ),
    "49 s, 1.0 MB of memory, 1 moment of 2 MB for ParaView, 32 pictures": (
        FieldRequest((0.0,)),
        FigureSet(("von_mises", "stress_zz"), animate=True, frames=30),
    ),
    "": (FieldRequest((0.0,)), None),
}


@pytest.mark.parametrize("said", ANNOUNCED)
def test_files_and_pictures_are_announced(scene_file, capsys, said):
    """A moment takes 0.4 s, a picture a second; frames are no files for ParaView."""
    case = Case("pressed", read_scene(scene_file))
    fields.FieldsCommand(case, *ANNOUNCED[said], None, None, False).announce(SHORT)
    expected = f"crosscontact: expected: about 1e3 steps, {said}\n" if said else ""
    assert capsys.readouterr().err == expected


def test_interrupted_in_the_run(scene_file, tmp_path, monkeypatch, capsys):
    def stop(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr(fields, "record_fields", stop)
    assert main(["fields", scene_file, "--at", "0", "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().err.splitlines() == [
        "crosscontact: the same command begins anew",
        "crosscontact: interrupted",
    ]
    assert not (tmp_path / "out").exists()


def test_another_scenes_fields_are_refused(scene_file, tmp_path, monkeypatch, recorded, capsys):
    monkeypatch.setattr(fields, "record_fields", recorded)
    out = str(tmp_path / "out")
    given = ["--at", "0.06", "--resolution", "4", "--no-figures", "--out", out]
    assert main(["fields", scene_file, *given]) == 0
    other = tmp_path / "other.toml"
    other.write_text(DOWN_AND_UP.replace("poisson = 0.4", "poisson = 0.3"), encoding="utf-8")
    capsys.readouterr()
    assert main(["fields", str(other), *given]) == 2
    assert "results of another scene" in capsys.readouterr().err
    assert main(["fields", str(other), *given, "--fresh"]) == 0


def test_an_animation_alone_writes_no_files_for_paraview(scene_file, tmp_path, monkeypatch, recorded, capsys):
    monkeypatch.setattr(fields, "record_fields", record_fields)
    monkeypatch.setattr(figure_set.animation, "film", lambda *given: b"GIF" * 700)
    out = tmp_path / "out"
    given = ["fields", scene_file, "--animate", "--resolution", "4", "--out", str(out)]
    assert main(given) == 0
    assert {path.name for path in out.rglob("*") if path.is_file()} == {"scene.toml", "cycle_von_mises.gif"}
    said = capsys.readouterr().out
    assert "cycle_von_mises.gif (2.1 kB)" in said
    assert "ParaView" not in said
