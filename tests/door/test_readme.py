"""The Python of the README, run as it stands there."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

README = Path(__file__).parents[2] / "README.md"


@pytest.mark.slow
def test_what_a_notebook_needs_in_ten_lines(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    (block,) = re.findall(r"```python\n(.*?)```", README.read_text("utf-8"), flags=re.DOTALL)
    assert len([line for line in block.splitlines() if line.strip()]) == 10
    names: dict = {}
    exec(block, names)
    result, again = names["result"], names["again"]
    assert names["force"] == result.pull_off.force
    assert (
        4.29 < names["force"] / (1.5 * np.pi * result.scene.adhesion.work) < 4.31
    )  # F_JKR, Fig. 2 of the paper
    assert 0.0 < names["error"] < 1e-3
    assert again.trace.force.tobytes() == result.trace.force.tobytes()
    assert again.measures == result.measures
    assert len(names["table"]) == len(result.trace)
    assert [len(axes.lines) for axes in names["axes"]] == [4, 4]
    assert "pull_off_force" in capsys.readouterr().out
