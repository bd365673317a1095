"""The HTML report in a headless Chromium: no script errors, no missing pictures, no sideways scrolling."""

from __future__ import annotations

import pytest
from support.browser import CHROMIUM, NAMES, measure_page, measure_pages
from support.spring_solver import fake, named

from crosscontact import arguments
from validation import solvers
from validation.cases import load
from validation.compare.page import write
from validation.compare.suite import compare_scenes
from validation.report import html
from validation.report.document import DataTable, Document, Paragraph, Section
from validation.runs.progress import Progress

pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason=f"no Chromium on PATH (looked for {', '.join(NAMES)})"
)

WIDTHS = [375, 1280]
"""Of a telephone and of a screen, in pixels."""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    with pytest.MonkeyPatch.context() as patch:
        for name in arguments.names():
            patch.setitem(solvers.SOLVERS, name, named(name, fake(1.0 if name == "reference" else 1.1)))
        write(compare_scenes("quick", [load("cycle-v0.1")], None, Progress("test")), folder)
    return (folder / "index.html").read_text()


@pytest.fixture(scope="module")
def measured(page, tmp_path_factory):
    """The page at two widths, and a page spoilt on purpose at the smaller, by one browser."""
    spoilt = page.replace(
        "<main>", '<main><div style="width:900px">x</div><img src="gone.png"><script>nosuch()</script>'
    )
    shown = [(page, width) for width in WIDTHS] + [(spoilt, WIDTHS[0])]
    return measure_pages(tmp_path_factory.mktemp("browser"), shown)


@pytest.mark.parametrize("width", WIDTHS)
def test_page_fits_and_shows_everything(measured, width):
    seen = measured[WIDTHS.index(width)]
    assert seen["width"] == width
    assert seen["content"] <= width
    assert (seen["trouble"], seen["broken"], seen["flat"], seen["wide"]) == (0, 0, 0, 0)
    assert seen["figures"] == 6 + 1
    assert seen["labels"] > 50


def test_failures_stand_above_the_overview_and_name_the_solvers(page):
    overview = page.partition('id="overview"')[2]
    failures, scenes, methods = (
        overview.index(text) for text in ("Not passed", "closest to its limit", "how it works")
    )
    assert failures < scenes < methods
    assert all(f"<td>{name}</td>" in overview[methods:] for name in arguments.names())
    assert '<details class="section" id="scene-' not in page  # what failed is open


@pytest.mark.slow
def test_dark_page_has_light_ink(page, tmp_path):
    light = measure_page(tmp_path, page, 800, "--blink-settings=preferredColorScheme=1")
    dark = measure_page(tmp_path, page, 800, "--blink-settings=preferredColorScheme=0")
    assert sum(_rgb(light["paper"])) > 600 > 200 > sum(_rgb(light["ink"]))
    assert sum(_rgb(dark["paper"])) < 200 < 600 < sum(_rgb(dark["ink"]))


def test_the_probe_sees_a_page_that_is_too_wide_and_a_picture_that_is_missing(measured):
    seen = measured[-1]
    assert seen["content"] > 375
    assert seen["broken"] == 1
    assert seen["trouble"] >= 1


@pytest.mark.slow
def test_a_click_sorts_a_table_and_a_link_opens_its_fold(tmp_path):
    """The page clicks on itself and says what came of it in its title."""
    table = DataTable.of(
        [{"name": name, "value": value} for name, value in zip("bca", ("10", "9", "–"), strict=True)]
    )
    hidden = Section("Hidden", (Paragraph("here"),), "hidden", folded=True)
    parts = (Section("Numbers", (table,)), hidden)
    steps = """<script>addEventListener("load", () => {
      const heads = document.querySelectorAll("th");
      const cells = () => document.querySelectorAll("td:first-child");
      const order = () => [...cells()].map(cell => cell.textContent.trim()).join("");
      heads[0].click(); const byName = order(); heads[1].click(); const up = order(); heads[1].click();
      document.querySelector('nav a[href="#hidden"]').click();
      setTimeout(() => { document.title = JSON.stringify({ byName, up, down: order(),
        sorted: heads[1].ariaSort, open: document.getElementById("hidden").open }); }, 200);
    });</script></body>"""
    page = html.text(Document("T", (), parts)).replace("</body>", steps)
    seen = measure_page(tmp_path, page, 800)
    assert (seen["byName"], seen["up"], seen["down"]) == ("abc", "cba", "bca")
    assert (seen["sorted"], seen["open"]) == ("descending", True)


def _rgb(text: str) -> list[int]:
    return [int(part) for part in text[text.index("(") + 1 : text.index(")")].split(",")[:3]]
