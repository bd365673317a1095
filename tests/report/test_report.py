"""The report in all its forms, on fake solvers: nothing is lost, failures show, a browser shows all of it."""

from __future__ import annotations

import dataclasses
import json
import re
import xml.etree.ElementTree as tree
from html.parser import HTMLParser

import pytest
from support.browser import CHROMIUM, measure_page, measure_pages
from support.commands import stand_in
from support.spring_solver import SCENE, FunctionSolver, fake
from support.unlaid_figures import without_layout

from contact_scene import OutcomeKind
from crosscontact import arguments
from crosscontact.cli import main
from validation.cases import load
from validation.compare import scene_page
from validation.compare.page import write
from validation.compare.suite import compare_scenes
from validation.report import html
from validation.report.document import Bullets, DataTable, Document, Paragraph, Section
from validation.runs.pool import processes
from validation.runs.progress import Progress

in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on PATH")
WIDTHS = [375, 1280]
"""Of a telephone and of a screen, in pixels."""


def refuse(*arguments, **options):
    raise FloatingPointError("broke <b>down</b> & more")


def compared(monkeypatch, names=("cycle-v0.1",), estimate=True, **factories):
    """Scenes compared with fakes in place of the solvers, ten per cent too stiff where nothing is said."""
    stand_in(monkeypatch, fake(1.1), **{"reference": fake(), **factories})
    return compare_scenes("quick", [load(name) for name in names], None, Progress("test"), estimate=estimate)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A report of two scenes: a user's own and a built-in one."""
    folder = tmp_path_factory.mktemp("report")
    own = folder / "a<b>&c.toml"
    own.write_text(SCENE.replace("A small scene", "A <small> & odd scene"))
    with pytest.MonkeyPatch.context() as patch:
        report = compared(patch, (str(own), "cycle-v0.1"))
    with without_layout():
        write(report, folder / "out")
    return report, folder / "out", (folder / "out/index.html").read_text()


def test_files_and_numbers(built):
    report, folder, text = built
    names = ["index.html", "junit.xml", "report.json", "runs", "summary.md"]
    assert sorted(file.name for file in folder.iterdir()) == names
    runs = [folder / "runs" / scene.case.name / s for scene in report.scenes for s in scene.runs]
    assert all((run / "trace.csv").exists() and (run / "summary.json").exists() for run in runs)
    data = json.loads((folder / "report.json").read_text())
    assert (data["suite"], data["passed"], data["failed"]) == ("quick", False, len(report.failures))
    assert sum(len(scene["checks"]) for scene in data["scenes"]) == data["checks"] == len(report.checks)
    assert data["scenes"][0]["runs"]["bem"]["pull_off_force"] == pytest.approx(0.011)
    assert data["scenes"][1]["runs"]["bem"]["counters"]["steps"] == 39
    assert all("fem: no closure was evaluated" in scene["left_out"] for scene in data["scenes"])
    spent = text.rpartition("Where the time went")[2].partition("</section>")[0]
    assert spent.count("<tr>") == 1 + len(arguments.names()) + 1 + len(report.runs) == 11


def test_junit_and_markdown_have_every_check_and_failure(built):
    report, folder, _ = built
    root = tree.parse(folder / "junit.xml").getroot()
    assert len(root.findall(".//testcase")) == len(report.checks) == int(root.attrib["tests"])
    assert len(root.findall(".//failure")) == len(report.failures) == int(root.attrib["failures"]) > 0
    for suite in root.iter("testsuite"):
        times = [float(case.attrib["time"]) for case in suite.iter("testcase")]
        assert sum(times) == pytest.approx(float(suite.attrib["time"]), abs=1e-4 * len(times))
    head, _, failed = (folder / "summary.md").read_text().partition("## Not passed")
    assert "cycle-v0.1" in head
    rows = [line for line in failed.splitlines() if line.startswith("|")]
    assert len(rows) == len(report.failures) + 2
    assert len({line.count("|") - line.count("\\|") for line in rows}) == 1


class Page(HTMLParser):
    """Collects what matters: balance of tags, ids, links, text."""

    VOID = frozenset({"meta", "br", "link", "img", "hr", "input"})

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.targets, self.loads = [], [], [], []

    def handle_starttag(self, tag, attributes):
        self.ids += [v for k, v in attributes if k == "id"]
        addresses = [(k, v) for k, v in attributes if k in ("src", "href", "xlink:href")]
        self.targets += [v.removeprefix("#") for k, v in addresses if v.startswith("#")]
        self.loads += [v for k, v in addresses if k != "xlink:href" and not v.startswith(("#", "data:"))]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        before = list(self.open)
        self.handle_starttag(tag, attributes)
        self.open = before

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_whole_self_contained_and_follows_the_colours_of_its_reader(built):
    report, _, text = built
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    assert set(page.targets) <= set(page.ids)
    assert page.loads == []
    assert "url(http" not in text
    assert "@import" not in text
    assert re.findall(r"<script[^>]*>", text) == ["<script>"]  # its own, which loads nothing
    assert "A &lt;small&gt; &amp; odd scene" in text
    assert text.count("<svg") == (6 + 1) * len(report.scenes)  # and a small one, which leads to the scene
    assert text.count('<figure class="linked"><a href="#scene-') == len(report.scenes)
    drawn = "".join(re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL))
    assert "var(--bem)" in drawn
    assert not re.search(r"#0a0a0a|#0072b2", drawn)
    rows = 0
    for table in re.findall(r"<table[^>]*><thead>.*?</table>", text, flags=re.DOTALL):
        head, *body = re.findall(r"<tr>(.*?)</tr>", table, flags=re.DOTALL)
        assert {len(re.findall("<td[ >]", line)) for line in body} == {len(re.findall("<th[ >]", head))}
        rows += len(body) if "tolerance" in head else 0
    assert rows == len(report.checks) + len(report.failures)
    overview = text.partition('id="overview"')[2]
    places = [overview.index(part) for part in ("Not passed", "closest to its limit", "how it works")]
    assert places == sorted(places)
    assert '<details class="section" id="scene-' not in text  # what failed is open


@pytest.mark.slow
def test_pages_drawn_by_two_processes_are_the_same(built, tmp_path):
    shares: list[float] = []
    for name, workers in (("here", 1), ("there", 2)):
        with processes(workers) as executor:
            write(built[0], tmp_path / name, executor, shares.append)
    assert (tmp_path / "there/index.html").read_text() == (tmp_path / "here/index.html").read_text()
    assert shares == [0.5, 1.0] * 2


def test_a_page_does_not_outlive_the_runs_it_shows(built, tmp_path, monkeypatch):
    (tmp_path / "index.html").write_text("of an earlier report")
    monkeypatch.setattr(scene_page, "drawn", lambda scene: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write(built[0], tmp_path)
    assert (tmp_path / "runs").exists()
    assert not (tmp_path / "index.html").exists()


def test_a_run_without_an_answer_is_shown(tmp_path, monkeypatch):
    stopped = fake(kind=OutcomeKind.STEP_BUDGET)
    report = compared(monkeypatch, bem=FunctionSolver(refuse), reference=stopped)
    with without_layout():
        write(report, tmp_path)
    text = (tmp_path / "index.html").read_text()
    assert "broke &lt;b&gt;down&lt;/b&gt; &amp; more" in text
    assert "step budget exhausted" in text
    data = json.loads((tmp_path / "report.json").read_text())
    assert "FloatingPointError" in data["scenes"][0]["runs"]["bem"]["traceback"]
    assert {check.quantity for check in report.failures} >= {"outcome", "pull_off_force", "reference"}
    report = compared(monkeypatch, **dict.fromkeys(arguments.names(), FunctionSolver(refuse)))
    write(report, tmp_path)
    assert "No run gave a curve" in (tmp_path / "index.html").read_text()


def test_what_makes_a_run_doubtful_stands_with_its_scene(built):
    scene = built[0].scenes[0]
    doubtful = dataclasses.replace(scene.runs["bem"], warnings=("one", "two"))
    with without_layout():
        section, _ = scene_page.drawn(dataclasses.replace(scene, runs={"bem": doubtful}))
    assert Bullets(("bem: one", "bem: two")) in section.parts[-2].parts


@pytest.mark.parametrize(("estimate", "seen"), [(True, (False, 0.0, 0.0)), (False, (True, None, None))])
def test_estimates_stand_beside_differences_unless_left_out(monkeypatch, estimate, seen):
    """A fake gives the same answer at any resolution: it estimates no error, and a difference counts."""
    report = compared(monkeypatch, estimate=estimate, bem=fake(1.001), fem=fake())
    name = ("bem", "loop_energy", "front tracking")
    (found,) = [c for c in report.checks if (c.solver, c.quantity, c.source) == name]
    assert (found.passed, found.estimate, found.base_estimate) == seen


def test_report_command(tmp_path, monkeypatch, capsys):
    compared(monkeypatch, (), bem=fake(), fem=fake())
    monkeypatch.setattr("validation.scenes.suite", lambda suite: ["relaxed-equilibrium"])
    assert main(["report", "--out", str(tmp_path / "r"), "--jobs", "1"]) == 1
    out, err = capsys.readouterr()
    assert "index.html" in out
    assert "failed: relaxed-equilibrium: bem: start_force" in err


@in_a_browser
def test_the_page_fits_and_shows_everything(tmp_path, monkeypatch):
    """At two widths; and a page spoilt on purpose shows that the browser would tell."""
    write(compared(monkeypatch), tmp_path)
    page = (tmp_path / "index.html").read_text()
    trouble = '<main><div style="width:900px">x</div><img src="gone.png"><script>nosuch()</script>'
    shown = [*((page, width) for width in WIDTHS), (page.replace("<main>", trouble), WIDTHS[0])]
    *whole, spoilt = measure_pages(tmp_path, shown)
    for seen, width in zip(whole, WIDTHS, strict=True):
        assert seen["width"] == width
        assert seen["content"] <= width
        assert (seen["trouble"], seen["broken"], seen["flat"], seen["wide"]) == (0, 0, 0, 0)
        assert seen["figures"] == 6 + 1
        assert seen["labels"] > 50
    assert spoilt["content"] > WIDTHS[0]
    assert (spoilt["broken"], spoilt["trouble"] >= 1) == (1, True)
    for scheme, darker, lighter in ((1, "ink", "paper"), (0, "paper", "ink")):
        seen = measure_page(tmp_path, page, 800, f"--blink-settings=preferredColorScheme={scheme}")
        assert _brightness(seen[darker]) < 200 < 600 < _brightness(seen[lighter])


@in_a_browser
@pytest.mark.slow
def test_a_click_sorts_a_table_and_a_link_opens_its_fold(tmp_path):
    """The page clicks on itself and says what came of it in its title."""
    table = DataTable.of(
        [{"name": name, "value": value} for name, value in zip("bca", ("10", "9", "–"), strict=True)]
    )
    hidden = Section("Hidden", (Paragraph("here"),), "hidden", folded=True)
    page = html.text(Document("T", (), (Section("Numbers", (table,)), hidden)))
    steps = """<script>addEventListener("load", () => {
      const heads = document.querySelectorAll("th");
      const cells = () => document.querySelectorAll("td:first-child");
      const order = () => [...cells()].map(cell => cell.textContent.trim()).join("");
      heads[0].click(); const byName = order(); heads[1].click(); const up = order(); heads[1].click();
      document.querySelector('nav a[href="#hidden"]').click();
      setTimeout(() => { document.title = JSON.stringify({ byName, up, down: order(),
        sorted: heads[1].ariaSort, open: document.getElementById("hidden").open }); }, 200);
    });</script></body>"""
    seen = measure_page(tmp_path, page.replace("</body>", steps), 800)
    assert (seen["byName"], seen["up"], seen["down"]) == ("abc", "cba", "bca")
    assert (seen["sorted"], seen["open"]) == ("descending", True)


def _brightness(colour: str) -> int:
    return sum(int(part) for part in colour[colour.index("(") + 1 : colour.index(")")].split(",")[:3])
