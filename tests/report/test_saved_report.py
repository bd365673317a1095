"""A report read back from its folder or archive: the same checks, figures and findings, nothing run."""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict
from pathlib import Path

import pytest

from benchmarks import saved_report as saved
from contact_scene import SceneError
from validation.claims import page as claims_page
from validation.claims.claim import Finding, Part, Verdict

ARCHIVE = Path(__file__).parents[2] / "docs" / "data" / "report.zip"


@pytest.fixture(scope="module")
def report():
    return saved.read(ARCHIVE)


def test_checks_and_runs_are_those_of_report_json(report):
    with zipfile.ZipFile(ARCHIVE) as archive:
        data = json.loads(archive.read("report.json"))
    checks = [*report.checks, *(one.check for one in saved.findings(data.get("claims", [])))]
    assert len(checks) == data["checks"] > 1000
    assert sum(not check.passed for check in checks) == data["failed"]
    by_name = {scene.case.name: scene for scene in report.scenes}
    for scene in data["scenes"]:
        assert [asdict(check) for check in by_name[scene["name"]].checks] == scene["checks"]
        assert by_name[scene["name"]].case.statement == scene["statement"]
    runs = {name: run for (name, solver), run in report.runs.items() if solver == "reference"}
    forces = {s["name"]: s["runs"]["reference"].get("pull_off_force") for s in data["scenes"]}
    assert {name: runs[name].measures.get("pull_off_force") for name in runs} == forces


@pytest.mark.slow
def test_a_packed_report_is_the_same_report(report, tmp_path):
    saved.unpack(ARCHIVE, tmp_path / "folder")
    (tmp_path / "folder" / "index.html").write_text("not packed")
    for run in (tmp_path / "folder" / "runs").glob("[!r]*/*/*"):  # few runs are enough
        run.unlink()
    saved.pack(tmp_path / "folder", tmp_path / "few.zip")
    with zipfile.ZipFile(ARCHIVE) as whole, zipfile.ZipFile(tmp_path / "few.zip") as few:
        names = [name for name in whole.namelist() if name.startswith("runs/r") or name[:5] != "runs/"]
        assert "report.json" in names
        assert few.namelist() == names
        assert [few.read(name) for name in names] == [whole.read(name) for name in names]


def test_findings_survive():
    finding = Finding("a", "Sec. 1", "it sticks", Verdict.IN_PART, (Part("1 > 2", False, {"x": 1.0}),))
    data = json.loads(json.dumps([claims_page.data(finding)]))
    assert saved.findings(data) == (finding,)


def test_what_is_damaged_is_said_in_one_line(tmp_path):
    with pytest.raises(SceneError, match=r"report\.json.*No such file"):
        saved.read(tmp_path)
    (tmp_path / "report.zip").write_text("no archive")
    with pytest.raises(SceneError, match="not a zip file"):
        saved.read(tmp_path / "report.zip")
    for text in ('{"scenes": []}', "[" * 200_000):
        (tmp_path / "report.json").write_text(text)
        with pytest.raises(SceneError, match="damaged"):
            saved.read(tmp_path)


def test_an_archive_is_unpacked_up_to_the_size_of_a_report(tmp_path, monkeypatch):
    monkeypatch.setattr(saved, "LARGEST", 1000)
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_LZMA) as bomb:
        bomb.writestr("report.json", b"0" * 1001)
    with pytest.raises(SceneError, match=r"more than 1\.0 kB"):
        saved.unpack(tmp_path / "bomb.zip", tmp_path / "out")
    assert not (tmp_path / "out").exists()
