"""The page of a study in a headless Chromium, as that of a report: whole, and no wider than a phone."""

from __future__ import annotations

import dataclasses

import pytest
from support.browser import CHROMIUM, measure_page
from support.converging_schemes import ORDERS, converging
from support.spring_solver import SCENE, StudiedSolver
from support.unlaid_figures import without_layout

from crosscontact.cli import main
from validation.studies import schemes

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on PATH")


@pytest.mark.slow
def test_page_fits_a_phone_and_shows_everything(tmp_path, monkeypatch):
    for name, order in ORDERS.items():
        made_up = dataclasses.replace(schemes.SCHEMES[name], solver=StudiedSolver(converging(order)))
        monkeypatch.setitem(schemes.SCHEMES, name, made_up)
    own = tmp_path / "small.toml"
    own.write_text(SCENE)
    with without_layout():
        assert main(["study", str(own), "--jobs", "1", "--out", str(tmp_path / "out")]) == 0
    seen = measure_page(tmp_path, (tmp_path / "out" / "index.html").read_text(), 375)
    assert seen["width"] == 375
    assert seen["content"] <= 375
    assert (seen["trouble"], seen["broken"], seen["flat"], seen["wide"]) == (0, 0, 0, 0)
    assert seen["figures"] == 9
