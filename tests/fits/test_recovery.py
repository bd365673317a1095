"""Blind recovery: what is drawn, and how its table is judged."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.fit_recovery import VARIED, RecoveredMaterial, random_scenes, report
from contact_scene.scene import value_at

DOCS = Path(__file__).parents[2] / "docs"
FACTOR = np.exp(0.4)
"""Farthest that a fit starts from the truth."""


def test_the_first_guess_is_wrong_by_the_stated_factor_and_nothing_else():
    scenes, guess = random_scenes(3)
    assert len({scene.material for scene in scenes}) == 1
    wrong = [value_at(guess, path) / value_at(scenes[0], path) for path in VARIED]
    assert all(1.0 / FACTOR <= one <= FACTOR for one in wrong)
    assert min(abs(one - 1.0) for one in wrong) > 1e-3
    assert guess.indenter == scenes[0].indenter
    assert guess.adhesion.zone == scenes[0].adhesion.zone


@pytest.mark.parametrize("kept", ["recovery", "recovery-posterior"])
def test_the_documentation_states_what_the_kept_numbers_give(kept):
    entries = json.loads((DOCS / f"data/{kept}.json").read_text("utf-8"))
    found = [RecoveredMaterial(**entry) for entry in entries]
    assert report(found, []) in (DOCS / "explanation/fit-intervals.md").read_text("utf-8")
