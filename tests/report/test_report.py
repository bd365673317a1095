"""The report in all its forms, on fake solvers: nothing is lost, and failures show."""

from __future__ import annotations

import dataclasses
import json
import re
import xml.etree.ElementTree as tree
from html.parser import HTMLParser

import pytest
from support.spring_solver import SCENE, FunctionSolver, fake, named
from support.unlaid_figures import without_layout

from contact_scene import OutcomeKind
from crosscontact import arguments
from crosscontact.cli import main
from validation import solvers
from validation.cases import load
from validation.compare import scene_page as scene_section
from validation.compare.page import write
from validation.compare.suite import compare_scenes
from validation.report.document import Bullets
from validation.runs.pool import processes
from validation.runs.progress import Progress


def refuse(*arguments, **options):
    raise FloatingPointError("broke <b>down</b> & more")


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A report of two scenes: a user's own and a built-in one; the reference breaks down on nothing."""
    folder = tmp_path_factory.mktemp("report")
    own = folder / "a<b>&c.toml"
    own.write_text(SCENE.replace("A small scene", "A <small> & odd scene"))
    with pytest.MonkeyPatch.context() as patch:
        for name in arguments.names():
            patch.setitem(solvers.SOLVERS, name, named(name, fake(1.0 if name == "reference" else 1.1)))
        report = compare_scenes("quick", [load(str(own)), load("cycle-v0.1")], None, Progress("test"))
    with without_layout():
        write(report, folder / "out")
    return report, folder / "out"


def test_all_forms_are_there(built):
    report, folder = built
    assert sorted(file.name for file in folder.iterdir()) == [
        "index.html",
        "junit.xml",
        "report.json",
        "runs",
        "summary.md",
    ]
    runs = [folder / "runs" / scene.case.name / s for scene in report.scenes for s in scene.runs]
    assert all((run / "trace.csv").exists() and (run / "summary.json").exists() for run in runs)
    assert report.failures


@pytest.mark.slow
def test_pages_drawn_by_two_processes_are_the_same(built, tmp_path):
    report, _ = built
    shares: list[float] = []
    for name, workers in (("here", 1), ("there", 2)):
        (tmp_path / name).mkdir()
        with processes(workers) as executor:
            write(report, tmp_path / name, executor, shares.append)
    assert (tmp_path / "there/index.html").read_text() == (tmp_path / "here/index.html").read_text()
    assert shares == [0.5, 1.0] * 2


def test_a_page_does_not_outlive_the_runs_it_shows(built, tmp_path, monkeypatch):
    (tmp_path / "index.html").write_text("of an earlier report")
    monkeypatch.setattr(scene_section, "drawn", lambda scene: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write(built[0], tmp_path)
    assert (tmp_path / "runs").exists()
    assert not (tmp_path / "index.html").exists()


def test_json_has_every_check(built):
    report, folder = built
    data = json.loads((folder / "report.json").read_text())
    assert (data["suite"], data["passed"]) == ("quick", False)
    assert sum(len(scene["checks"]) for scene in data["scenes"]) == data["checks"] == len(report.checks)
    assert data["failed"] == len(report.failures)
    assert data["environment"]["python"]
    assert data["scenes"][0]["runs"]["bem"]["pull_off_force"] == pytest.approx(0.011)
    assert data["scenes"][1]["runs"]["bem"]["counters"]["steps"] == 39


def test_junit_has_one_case_per_check(built):
    report, folder = built
    root = tree.parse(folder / "junit.xml").getroot()
    assert len(root.findall(".//testcase")) == len(report.checks) == int(root.attrib["tests"])
    assert len(root.findall(".//failure")) == len(report.failures) == int(root.attrib["failures"])
    for suite in root.iter("testsuite"):
        times = [float(case.attrib["time"]) for case in suite.iter("testcase")]
        assert sum(times) == pytest.approx(float(suite.attrib["time"]), abs=1e-4 * len(times))


def test_markdown_names_every_failure(built):
    report, folder = built
    text = (folder / "summary.md").read_text()
    head, _, failed = text.partition("## Not passed")
    assert "cycle-v0.1" in head
    assert len([line for line in failed.splitlines() if "FAIL" in line or "missing" in line]) == len(
        report.failures
    )
    columns = [line.count("|") - line.count("\\|") for line in failed.splitlines() if line.startswith("|")]
    assert len(set(columns)) == 1


class Page(HTMLParser):
    """Collects what matters: balance of tags, ids, links, text."""

    VOID = frozenset({"meta", "br", "link", "img", "hr", "input"})

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.targets, self.loads = [], [], [], []

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        if "id" in values:
            self.ids.append(values["id"])
        self.targets += [
            v.removeprefix("#") for k, v in attributes if k.endswith("href") and v.startswith("#")
        ]
        self.loads += [v for k, v in attributes if k in ("src", "href") and not v.startswith(("#", "data:"))]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        before = list(self.open)
        self.handle_starttag(tag, attributes)
        self.open = before

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_html_is_whole_and_self_contained(built):
    report, folder = built
    text = (folder / "index.html").read_text()
    page = Page()
    page.feed(text)
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    assert set(page.targets) <= set(page.ids)
    assert page.loads == []
    assert "url(http" not in text
    assert re.findall(r"<script[^>]*>", text) == ["<script>"]  # its own, which loads nothing
    assert "@import" not in text
    assert "A &lt;small&gt; &amp; odd scene" in text
    assert text.count("<svg") == (6 + 1) * len(report.scenes)  # and a small one, which leads to the scene
    assert text.count('<figure class="linked"><a href="#scene-') == len(report.scenes)
    assert text.count('class="fail"') >= len(report.failures)
    assert "prefers-color-scheme: dark" in text
    drawn = "".join(re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL))
    assert "var(--bem)" in drawn
    assert "currentColor" in drawn
    assert not re.search(r"#0a0a0a|#0072b2", drawn)


def test_tables_are_rectangular_and_hold_every_check(built):
    report, folder = built
    text = (folder / "index.html").read_text()
    rows = 0
    for table in re.findall(r"<table[^>]*><thead>.*?</table>", text, flags=re.DOTALL):
        head, *body = re.findall(r"<tr>(.*?)</tr>", table, flags=re.DOTALL)
        assert {len(re.findall("<td[ >]", line)) for line in body} == {len(re.findall("<th[ >]", head))}
        rows += len(body) if "tolerance" in head else 0
    assert rows == len(report.checks)


def test_a_run_without_an_answer_is_shown(tmp_path, monkeypatch):
    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(refuse))
    monkeypatch.setitem(solvers.SOLVERS, "fem", named("fem", fake(1.1)))
    monkeypatch.setitem(solvers.SOLVERS, "reference", named("reference", fake(kind=OutcomeKind.STEP_BUDGET)))
    report = compare_scenes("quick", [load("cycle-v0.1")], None, Progress("test"))
    with without_layout():
        write(report, tmp_path)
    text = (tmp_path / "index.html").read_text()
    assert "broke &lt;b&gt;down&lt;/b&gt; &amp; more" in text
    assert "step budget exhausted" in text
    assert text.count("missing") >= 5
    data = json.loads((tmp_path / "report.json").read_text())
    assert "FloatingPointError" in data["scenes"][0]["runs"]["bem"]["traceback"]
    assert {check.quantity for check in report.failures} >= {"outcome", "pull_off_force", "reference"}
    assert "step budget exhausted" in (tmp_path / "junit.xml").read_text()


def test_no_curve_at_all(tmp_path, monkeypatch):
    for name in arguments.names():
        monkeypatch.setitem(solvers.SOLVERS, name, FunctionSolver(refuse, name))
    report = compare_scenes("quick", [load("cycle-v0.1")], None, Progress("test"))
    write(report, tmp_path)
    assert "No run gave a curve" in (tmp_path / "index.html").read_text()


def test_every_scene_says_what_was_left_out_and_where_the_time_went(built):
    """The fakes evaluate no closure and carry no history."""
    report, folder = built
    text, short = (folder / "index.html").read_text(), (folder / "summary.md").read_text()
    said = "Left out because the scene did not need it, by the counters: bem: no closure was evaluated, "
    assert text.count(said) == short.count(said) == len(report.scenes) == 2
    scenes = json.loads((folder / "report.json").read_text())["scenes"]
    assert all(
        "fem: no closure was evaluated, no history was carried, no solution" in s["left_out"] for s in scenes
    )
    spent = text.rpartition("Where the time went")[2].partition("</section>")[0]
    assert spent.count("<tr>") == 1 + len(arguments.names()) + 1 + len(report.runs) == 11
    assert "cycle-v0.1 by fem" in spent


def test_what_makes_a_run_doubtful_stands_with_its_scene(built):
    scene = built[0].scenes[0]
    doubtful = {name: dataclasses.replace(run, warnings=("one", "two")) for name, run in scene.runs.items()}
    for runs, said in ((scene.runs, []), ({"bem": doubtful["bem"]}, [Bullets(("bem: one", "bem: two"))])):
        parts = scene_section.section(dataclasses.replace(scene, runs=runs)).parts[-2].parts
        assert [part for part in parts if isinstance(part, Bullets)] == said


def test_estimates_stand_beside_differences_unless_left_out(tmp_path, monkeypatch):
    """A fake gives the same answer at any resolution: it estimates no error, and a difference counts."""
    for name in arguments.names():
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, fake(1.001 if name == "bem" else 1.0)))
    found = {}
    for estimate in (True, False):
        report = compare_scenes("quick", [load("cycle-v0.1")], None, Progress("test"), estimate=estimate)
        (found[estimate],) = [c for c in report.checks if (c.solver, c.quantity) == ("bem", "loop_energy")
                              and c.source == "front tracking"]  # fmt: skip
    assert (found[True].passed, found[True].estimate, found[True].base_estimate) == (False, 0.0, 0.0)
    assert (found[False].passed, found[False].estimate) == (True, None)


def test_report_command(tmp_path, monkeypatch, capsys):
    for name in arguments.names():
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, fake()))
    monkeypatch.setattr("validation.scenes.suite", lambda suite: ["relaxed-equilibrium"])
    assert main(["report", "--out", str(tmp_path / "r"), "--jobs", "1"]) == 1
    out, err = capsys.readouterr()
    assert "index.html" in out
    assert "failed: relaxed-equilibrium: bem: start_force" in err
    assert "report: runs: 1/" in err
