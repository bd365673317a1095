"""The kept map of the page on the end of small-scale viscoelasticity, against the command that makes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks import small_scale
from validation.reference.jkr import JKR


@pytest.fixture(scope="module")
def kept():
    with np.load(Path(__file__).parents[2] / "docs/data/small-scale.npz") as file:
        return {name: file[name].astype(float) for name in file.files}


def test_all_of_the_map_is_there_but_cycles_that_begin_shorter_than_their_zone(kept):
    """Nothing comes off without a force."""
    assert all(np.isfinite(kept[name]).all() for name in kept if name != "cycle")
    assert all(np.nanmin(kept[name]) > 0.0 for name in small_scale.RUNS)
    points = small_scale.drawn(20_000)
    none = np.flatnonzero((kept["depth"] > 0.0) & np.isnan(kept["cycle"]))
    assert len(none) > 400
    for row in none:
        contact = JKR(points[row].indenter, 1.0 / points[row].k, points[row].work).at_penetration(0.0)
        assert points[row].zone * points[row].reach * small_scale.THRESHOLD > contact.contact_radius


@pytest.mark.slow
def test_the_map_is_that_of_its_command(kept):
    """Also a retraction that the reference solves, and a cycle that there is not."""
    points, rows = small_scale.drawn(20_000), [*range(8), 38, 16_616]
    assert np.isnan(kept["cycle"][38])
    for name, column in small_scale.solved([points[row] for row in rows]).items():
        assert column == pytest.approx(kept[name][rows], rel=1e-4, nan_ok=True)
