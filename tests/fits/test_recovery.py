"""Blind recovery: what is drawn, and how its table is judged."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.fit_recovery import ENOUGH, VARIED, RecoveredMaterial, random_scenes, report
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


def material(number: int, low: float) -> RecoveredMaterial:
    ones = (1.0,) * len(VARIED)
    return RecoveredMaterial(
        number,
        ones,
        ones,
        (low,) * len(VARIED),
        (1.2,) * len(VARIED),
        (0.1,) * len(VARIED),
        1.0,
        True,
        True,
        1.0,
    )


def test_coverage_is_judged_from_enough_materials_on():
    sound = [material(n, 1.1 if n % 20 == 0 else 0.8) for n in range(ENOUGH)]
    assert ": pass" in report(sound, [])
    assert ": FAIL" in report([material(n, 1.1 if n % 5 == 0 else 0.8) for n in range(ENOUGH)], [])
    assert "judged from" in report(sound[:10], [])


def test_intervals_of_a_posterior_are_judged_beside_those_of_the_least_squares():
    sampled = ((0.8, 1.2), (1.1, 1.2)) * 2
    found = [replace(material(n, 0.8), sampled=sampled) for n in range(ENOUGH)]
    assert "50.0 % of the 95 % intervals" in report(found, []).split("Of the posterior")[1]
    told = report([material(ENOUGH, 0.8), *found], []).split("Of the posterior")[1]
    assert "50.0 % of the 95 % intervals" in told
    assert "1 materials have none" in told


@pytest.mark.parametrize("kept", ["recovery", "recovery-posterior"])
def test_the_documentation_states_what_the_kept_numbers_give(kept):
    entries = json.loads((DOCS / f"data/{kept}.json").read_text("utf-8"))
    found = [RecoveredMaterial(**entry) for entry in entries]
    assert report(found, []) in (DOCS / "explanation/fit-intervals.md").read_text("utf-8")
