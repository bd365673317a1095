"""An instrument's test from the command line: columns, measures, and a level that is not reached."""

from __future__ import annotations

import json

import pytest
from support.scene_text import GOOD

from contact_scene import read_columns
from crosscontact.cli import main

ELASTIC = GOOD.replace("branches = [{ modulus = 6.75, time = 1.0 }, { modulus = 1, time = 10 }]\n", "")
HEAD = ELASTIC[: ELASTIC.index("[[loading.steps]]")] + "[[loading.steps]]\n"
APPROACH = 'kind = "approach"\nrate = 1\nforce = {force}\nto = 0.1\n\n[machine]\nstiffness = 0.2\n'


def run(tmp_path, force):
    (tmp_path / "scene.toml").write_text(HEAD + APPROACH.format(force=force))
    code = main(["solve", str(tmp_path / "scene.toml"), "--resolution", "4", "--out", str(tmp_path / "out")])
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    return code, summary, read_columns(tmp_path / "out" / "trace.csv")


def test_trace_and_summary_of_a_spring(tmp_path):
    code, summary, columns = run(tmp_path, 0.003)
    assert (code, summary["outcome"]) == (0, "detached")
    assert columns["force"].max() == pytest.approx(0.003, rel=1e-12)
    assert columns["stage"] == pytest.approx(columns["penetration"] + columns["force"] / 0.2, abs=1e-12)
    assert summary["stage_at_detachment"] == pytest.approx(columns["stage"].min(), rel=1e-12)
    assert summary["instability_loss"] == columns["instability_loss"][-1] > 0.0


def test_level_out_of_reach_is_said_and_ends_with_1(tmp_path, capsys):
    code, summary, columns = run(tmp_path, 30)
    assert (code, summary["outcome"]) == (1, "trigger not reached")
    assert "the load step ended before the force was 30" in capsys.readouterr().err
    assert columns["stage"][-1] == pytest.approx(0.1)
