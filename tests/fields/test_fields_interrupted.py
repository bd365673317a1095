"""What a ``fields`` command announces, refuses, and says where it is interrupted."""

from __future__ import annotations

import pytest
from support.scene_text import DOWN_AND_UP

from crosscontact.cli import main
from crosscontact.commands import fields
from validation.fields.figures import figure_set
from validation.fields.request import record_fields


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


@pytest.mark.slow
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
