"""Pages made from the program and from a saved report: nothing public is missing, numbers are as saved."""

from __future__ import annotations

import html
import json
import re
import sys
from dataclasses import fields
from pathlib import Path

import pytest

import crosscontact as cc
from benchmarks import saved_report as saved
from contact_scene import COLUMNS
from contact_scene.load_steps import STEPS
from crosscontact.commands import __path__ as command_files
from fem_solver.recorder import EXTRA
from validation import scenes
from validation.claims.all import CLAIMS
from validation.claims.claim import Finding, Part, Verdict
from validation.fits.statistics import Estimate
from validation.reference.tracking.recorder import EXTRA_COLUMNS
from validation.solvers import SOLVERS
from validation.stability.runner import StabilityMatrix
from validation.stability.verdict import Cell, CellVerdict

ROOT = Path(__file__).parents[2]
ARCHIVE = ROOT / "docs" / "data" / "report.zip"
sys.path.append(str(ROOT / "docs"))


def test_every_public_name_is_in_the_reference():
    from site_pages import api

    named = set(re.findall(r":: crosscontact\.(\w+)", api.page()))
    assert named == {name for name in cc.__all__ if not name.startswith("__")}


def test_every_command_and_option_is_in_the_reference():
    from site_pages import command_line

    page = command_line.page()
    commands = re.findall(r"^## (\w+)$", page, flags=re.MULTILINE)
    written = {path.stem for folder in command_files for path in Path(folder).glob("*.py")}
    assert {"solve", "report", "study"} <= set(commands) <= written
    assert "| `--resolution N` | divisions per process zone" in page
    assert "`--quantity Q [Q ...]`" in page


def test_every_kind_of_step_is_in_the_reference():
    from site_pages import scene_keys

    page = scene_keys.page()
    assert [kind for kind in STEPS if f"| `{kind}` |" not in page] == []
    assert "| `oscillate` | `amplitude`, `angular_frequency`, `duration`, `drift` = 0.0 |" in page
    assert "| `sphere` | `radius` |" in page


def test_costs_of_every_solver_over_the_zone():
    from site_pages import costs

    page = costs.page()
    rows = [line.split(" | ") for line in page.splitlines() if re.match(r"\| \de-\d\d \|", line)]
    assert len(rows) == len(costs.RATIOS) == 9
    assert all(len(row) == 1 + len(SOLVERS) for row in rows)
    assert "steps" in rows[-1][list(SOLVERS).index("reference") + 1]
    assert "| `bem` | boundary elements | refuses it |" in page


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
def test_page_of_a_scene_holds_its_checks_and_their_sources():
    from site_pages import gallery

    from validation.cases import load

    report = saved.read(ARCHIVE)
    scene = next(one for one in report.scenes if one.case.name == "relaxed-equilibrium")
    page = html.unescape(gallery._scene_page(load("relaxed-equilibrium"), scene, report))
    assert page.startswith("# relaxed-equilibrium\n")
    assert page.count("<svg") == 5
    assert page.count('<span class="pass">') == len(scene.checks) > 40
    force = next(check for check in scene.checks if check.quantity == "start_force" and check.solver == "bem")
    assert f"{force.found:.6g}" in page
    for one in load("relaxed-equilibrium").expected:
        assert one.source in page


def test_a_scene_outside_the_report_says_so():
    from site_pages import gallery

    from validation.cases import load

    page = gallery._scene_page(load("sweep"), None, saved.read(ARCHIVE))
    assert "does not hold this scene" in page
    assert "Where the check values come from" in page


def test_statements_have_their_recorded_verdicts():
    from site_pages import gallery

    page = html.unescape(gallery._statements(None, []))
    assert page.count("<tr>") == 1 + len(CLAIMS)
    assert CLAIMS[0].wording in page


@pytest.mark.exhaustive
def test_gallery_has_a_page_for_every_scene(tmp_path):
    from site_pages import gallery

    gallery.write(tmp_path / "gallery", ARCHIVE)
    made = {path.stem for path in (tmp_path / "gallery").glob("*.md")}
    assert made == {*scenes.names(), "index", "statements", "stability", "studies"}
    index = (tmp_path / "gallery" / "index.md").read_text()
    assert [name for name in scenes.names() if index.count(f"({name}.md)") != 2] == []  # by topic, by figure


def test_judged_statements_show_what_was_found_and_the_figures():
    from site_pages import gallery

    judged = (
        Finding("a", "Sec. 1", "it sticks", Verdict.IN_PART, (Part("4.5 > 1", True), Part("1 > 2", False))),
    )
    page = html.unescape(gallery._statements(judged, ["fig2a.png", "another.png"]))
    assert "1 statement: 1 hold in part; no verdict changed." in page
    assert "4.5 > 1; NOT: 1 > 2" in page
    assert "![Fig. 2" in page
    assert "](figures/fig2a.png)" in page
    assert "another" not in page


@pytest.mark.slow
def test_saved_stability_has_a_map_for_each_solver():
    from site_pages import gallery

    cells = tuple(
        Cell(
            "stiff",
            label,
            solver,
            CellVerdict.WITHIN,
            "completed",
            "",
            errors={"force": 1e-3},
            tolerance=1e-2,
        )
        for solver in ("bem", "fem")
        for label in ("1e3", "1e6")
    )
    page = gallery._stability(StabilityMatrix(cells, 2.0))
    assert page.count("<svg") == 2
    assert "All 4 cells" in page
    assert "holds none" in gallery._stability(None)
