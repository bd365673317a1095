"""Blind recovery: how its table is judged."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.fit_recovery import RecoveredMaterial, report

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("kept", ["recovery", "recovery-posterior"])
def test_the_documentation_states_what_the_kept_numbers_give(kept):
    entries = json.loads((DOCS / f"data/{kept}.json").read_text("utf-8"))
    found = [RecoveredMaterial(**entry) for entry in entries]
    assert report(found, []) in (DOCS / "explanation/fit-intervals.md").read_text("utf-8")
