"""Pages made from the program and from a saved report: nothing public is missing, numbers are as saved."""

from __future__ import annotations

import html
import json
import re
import sys
from dataclasses import fields, replace
from pathlib import Path

import pytest

import crosscontact as cc
from contact_scene import COLUMNS
from contact_scene.checked import fields_of
from contact_scene.loading import STEPS
from crosscontact.commands import __path__ as command_files
from fem_solver.recorder import EXTRA
from validation import scenes
from validation.cases import load
from validation.claims.claim import Finding, Part, Verdict
from validation.fits.result import Estimate
from validation.reference.path.recorder import EXTRA_COLUMNS

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs"))
import site_pages  # noqa: E402 - found by the path above


@pytest.fixture(scope="module")
def report():
    return site_pages.saved_report.read(site_pages.ARCHIVE)


def test_every_public_name_is_in_the_reference():
    named = re.findall(r":: crosscontact\.(\w+)", site_pages.api())
    assert sorted(named) == sorted(name for name in cc.__all__ if not name.startswith("__"))


def test_every_command_and_option_is_in_the_reference():
    page = site_pages.command_line()
    commands = re.findall(r"^## (\w+)$", page, flags=re.MULTILINE)
    written = {path.stem for folder in command_files for path in Path(folder).glob("*.py")}
    assert {"solve", "report", "study"} <= set(commands) <= written
    assert "--resolution N" in page
    assert "--quantity Q [Q ...]" in page


def test_every_key_is_in_the_reference():
    page = site_pages.scene_keys()
    kinds = [kind for part in site_pages.SCENE_KEYS.values() for kind in part]
    assert [step for step in STEPS if f"### `{step.kind}`" not in page] == []
    assert [name for kind in kinds for name in fields_of(kind) if f"| `{name}` |" not in page] == []
    assert "| `drift` | speed of retraction beside it | `length time-1` |" in page


def test_columns_of_traces_are_in_the_reference():
    page = (ROOT / "docs" / "reference" / "output.md").read_text("utf-8")
    columns = {*COLUMNS, *EXTRA, *EXTRA_COLUMNS, *cc.solve("relaxed-equilibrium", "bem").trace.extra}
    assert [name for name in sorted(columns) if f"| `{name}` |" not in page] == []
    assert len(columns) > len(COLUMNS)


def test_keys_of_a_summary_are_in_the_reference(tmp_path):
    page = (ROOT / "docs" / "reference" / "output.md").read_text("utf-8")
    cc.solve("relaxed-equilibrium", "bem").save(tmp_path)
    keys = json.loads((tmp_path / "summary.json").read_text("utf-8"))
    assert [name for name in keys if f"`{name}`" not in page] == []
    assert len(keys) > 30


def test_keys_of_a_fitted_number_are_in_its_guide():
    page = (ROOT / "docs" / "how-to" / "fit.md").read_text("utf-8")
    table = "".join(re.findall(r"^\| `.*?\|", page.partition("## What comes out")[2], re.MULTILINE))
    assert [one.name for one in fields(Estimate) if f"`{one.name}`" not in table] == []
    assert "where `logarithmic` that of the logarithm" in page


@pytest.mark.slow
def test_page_of_a_scene_holds_its_checks_and_their_sources(report):
    scene = next(one for one in report.scenes if one.case.name == "relaxed-equilibrium")
    page = html.unescape(site_pages.scene_page(scene.case, scene, "a note"))
    assert page.startswith("# relaxed-equilibrium\n")
    assert page.count("<svg") == 5
    assert page.count('<span class="pass">') == len(scene.checks) > 40
    force = next(check for check in scene.checks if check.quantity == "start_force" and check.solver == "bem")
    assert f"{force.found:.6g}" in page
    for one in load("relaxed-equilibrium").expected:
        assert one.source in page


def test_every_scene_is_in_the_gallery_though_the_report_lacks_it(report):
    pages = site_pages.gallery(replace(report, scenes=()), ())
    assert set(pages) == {*scenes.names(), "index", "statements"}
    assert [name for name in scenes.names() if pages["index"].count(f"({name}.md)") != 1] == []
    assert "does not hold this scene" in pages["sweep"]
    assert "Where the check values come from" in pages["sweep"]
    assert "judges none" in pages["statements"]


def test_judged_statements_show_what_was_found_and_the_figures():
    parts = (Part("4.5 > 1", True), Part("1 > 2", False))
    page = html.unescape(
        site_pages.statements_page([Finding("a", "Sec. 1", "it sticks", Verdict.IN_PART, parts)])
    )
    assert "1 statement: 1 hold in part; no verdict changed." in page
    assert "4.5 > 1; NOT: 1 > 2" in page
    assert "![Fig. 2" in page
    assert "](figures/fig2a.png)" in page
