"""The judgement of the paper's statements: verdicts, what is measured for them, evidence, and the report."""

from __future__ import annotations

import dataclasses
import json
import xml.etree.ElementTree as tree

import numpy as np
import pytest
from markupsafe import escape
from support.synthetic_traces import follow, half_ellipse, profile, trace
from support.unlaid_figures import without_layout

from contact_scene import OutcomeKind
from validation.cases import Case, load
from validation.claims import claim, cycles, measures, page, retractions
from validation.claims.claim import FAILS, HOLDS, IN_PART, Claim, Finding, Part, Verdict
from validation.claims.evidence import (
    CYCLE_SPEEDS,
    SURFACES,
    Evidence,
    MissingRun,
    collect,
    cycle,
    missing_runs,
    required_runs,
    retraction,
    without_title,
)
from validation.claims.page import CLAIMS
from validation.compare import page as compare_page
from validation.compare.suite import SuiteComparison
from validation.measure.observables import measure
from validation.runs.pool import run_all
from validation.runs.run import Run
from validation.solvers import SOLVERS

GOOD, BAD = Part("as said", True), Part("otherwise", False)
DOWN = np.array([1.0, 0.8, 0.6, 0.4, 0.2])
SHRINKING = np.linspace(0.3, 0.1, 41)


@pytest.mark.parametrize(
    ("parts", "verdict"),
    [((GOOD, GOOD), HOLDS), ((GOOD, BAD), IN_PART), ((BAD,), FAILS), ((), Verdict.NOT_EVALUATED)],
)
def test_verdict_of_parts(parts, verdict):
    found = Finding("x", "here", "so it is", verdict, parts)
    assert (found.verdict, found.changed, found.check.passed) == (verdict, False, True)
    assert Finding("x", "here", "so it is", HOLDS, parts).changed == (verdict is not HOLDS)
    assert ("NOT: otherwise" in found.shown) == (BAD in parts)


@pytest.mark.parametrize(
    ("holds", "fails"),
    [
        ((claim.near, "", 9.6, 10.0), (claim.near, "", 9.4, 10.0)),
        ((claim.near, "", -0.51, -0.5), (claim.near, "", 0.5, -0.5)),
        ((claim.above, "", 1.3, 1.2), (claim.above, "", 1.2, 1.2)),
        ((claim.below, "", 1.2, 1.2), (claim.below, "", 1.3, 1.2)),
        ((claim.rises, "", {1: 1.0, 2: 2.0, 3: 1.9999}), (claim.rises, "", {1: 1.0, 2: 2.0, 3: 1.9})),
        ((claim.peaks, "", {1: 1.0, 2: 3.0, 3: 2.0}, 2.9), (claim.peaks, "", {1: 1.0, 2: 2.0, 3: 3.0})),
        ((claim.peaks, "", {3: 2.0, 2: 3.0, 1: 1.0}), (claim.peaks, "", {1: 1.0, 2: 3.0, 3: 2.0}, 3.0)),
    ],
)
def test_relations(holds, fails):
    for (relation, *given), expected in ((holds, True), (fails, False)):
        assert relation(*given).holds is expected


def test_a_bell_has_one_maximum_between_lower_ends():
    assert claim.bell([1.0, 3.0, 1.0])
    assert not claim.bell([1.0, 2.0, 3.0])
    assert not claim.bell([1.0, 3.0, 2.0, 3.0, 1.0])
    assert not claim.bell([1.0, 1.1, 1.0])


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (measures.hysteresis(trace(depth=[0.0, 1.0, 0.0], force=[0.0, 2.0, 0.0])), 0.0),
        (measures.hysteresis(trace(depth=[0.0, 1.0, 1.0, 0.0], force=[0.0, 2.0, 1.0, -1.0])), 1.0),
        (measures.hysteresis(trace(depth=[0.0, 1.0, 1.0, 0.5], force=[0.0, 2.0, 1.0, -1.0])), 1.0),
        (measures.last_slope(trace([0.0, 0.5, 1.0, 0.999, 0.5], [0.0, 1.5, 3.0, 2.99, -2.0])), 3.0),
        (measures.first_slope(trace([0.0, 0.5, 1.0, 0.999, 0.5], [0.0, 1.5, 3.0, 2.99, -2.0]), 1e-3), 10.0),
        (measures.on_line(trace(DOWN, 5.0 * (DOWN - 1.0)), 5.0), 1.0),
        (measures.on_line(trace(DOWN, [0.0, -1.0, -2.0, -2.5, -2.7]), 5.0), 0.5),
        (measures.on_line(trace(DOWN, [0.0, -1.0, -2.0, -2.5, -2.7]), 9.0), 0.0),
        (
            measures.release_rate(
                trace(
                    np.linspace(1, 0, 41),
                    -np.ones(41),
                    SHRINKING,
                    0.25 * np.pi * (SHRINKING[0] ** 2 - SHRINKING**2),
                ),
                20,
                work=1.0,
            ),
            1.25,
        ),
        (measures.release_rate(trace([1.0, 0.5, 0.0], [0, -1, 0], loss=[0.0, 1.0, 2.0]), 1, 0.7), 0.7),
        (measures.edge_exponent(profile(lambda r: -1.0 / np.sqrt(1.0 - r))), -0.5),
        (measures.edge_exponent(profile(half_ellipse)), 0.0),
        (measures.gap_exponents(profile(half_ellipse, gap=lambda s: s**1.5), (0.01, 0.1))[0], 1.5),
        (measures.annular_peak(profile(lambda r: 1.0 + 4.0 * r**2 - 4.5 * r**8))[0], (4.0 / 18.0) ** (1 / 6)),
        (measures.crossing([1.0, 100.0], [0.0, 1.0], 0.5), 10.0),
    ],
)
def test_measures(found, expected):
    assert found == pytest.approx(expected, rel=0.02 if 0.7 < expected < 0.8 else 1e-3, abs=1e-12)


def test_what_is_not_there_is_not_measured():
    assert measures.annular_peak(profile(half_ellipse)) is None
    assert measures.crossing([1.0, 100.0], [0.0, 0.4], 0.5) is None


def test_claims_are_stated_once_and_in_full():
    assert len(CLAIMS) >= 45
    assert len({one.name for one in CLAIMS}) == len({one.wording for one in CLAIMS}) == len(CLAIMS)
    assert all(one.place and len(one.wording) > 20 for one in CLAIMS)
    assert {one.recorded for one in CLAIMS} == {HOLDS, IN_PART, FAILS}


def test_without_runs_only_closed_forms_are_judged():
    found = page.findings(Evidence({}))
    assert {one.name: one.verdict for one in found if one.verdict is not Verdict.NOT_EVALUATED} == {
        "closure is griffith": HOLDS,
        "creep belongs to relaxation": HOLDS,
        "infinite crack has a plateau": HOLDS,
        "appendix uses the same time": FAILS,
        "plane modulus is multiplied": FAILS,
    }
    unjudged = retractions.point_b.finding(Evidence({}))
    assert unjudged.changed
    assert not unjudged.check.passed
    assert "not run" in unjudged.shown


def evidence_of(*given):
    """Evidence of ``(scene, trace)`` as if the boundary elements had answered."""
    runs = {}
    for scene, found in given:
        runs[without_title(scene), "bem"] = Run("made up", "bem", found, measures=measure(found, scene, 0.0))
    return Evidence(runs)


def springs(strength):
    """Cycles of a spring that lets go at ``strength(speed)`` JKR forces; the loop opens in between."""
    return evidence_of(*((cycle(v), follow(cycle(v), strength(v))) for v in CYCLE_SPEEDS))


def start(force):
    return evidence_of((load("sweep").scene, trace(depth=[5.7e-5, 5.7e-5], force=[force, force])))


@pytest.mark.parametrize(
    ("statement", "evidence", "given", "verdict"),
    [
        (cycles.intermediate_cycles_lose_and_hold, springs, lambda v: 4.0 if 1e-3 < v < 0.1 else 1.0, HOLDS),
        (cycles.intermediate_cycles_lose_and_hold, springs, lambda v: 1.0 + 0.03 * v, FAILS),
        (cycles.limits_share_the_pull_off_force, springs, lambda v: 1.0, HOLDS),
        (cycles.limits_share_the_pull_off_force, springs, lambda v: 2.0 if v > 1.0 else 1.0, FAILS),
        (retractions.starts_without_load, start, 0.0, HOLDS),
        (retractions.starts_without_load, start, 1e-6, IN_PART),
    ],
)
def test_both_verdicts(statement: Claim, evidence, given, verdict):
    assert statement.finding(evidence(given)).verdict is verdict


def test_a_partial_run_is_no_evidence():
    scene = cycle(0.1)
    part = dataclasses.replace(
        follow(scene, 1.0), outcome=trace().outcome.__class__(OutcomeKind.STEP_BUDGET, "x", 1.0)
    )
    with pytest.raises(MissingRun, match="step budget"):
        evidence_of((scene, part)).trace(scene)
    with pytest.raises(MissingRun, match="no peak_cycle_loss"):
        evidence_of((scene, follow(scene, 1.0))).measure(scene, "peak_cycle_loss")
    with pytest.raises(MissingRun, match="no surface"):
        evidence_of((load(SURFACES).scene, follow(scene, 1.0))).profiles()


def test_questions_are_asked_once():
    asked = required_runs()
    assert len({(case.name, solver) for case, solver in asked}) == len(asked)
    assert len({(without_title(case.scene), solver) for case, solver in asked}) == len(asked)
    suite = [(load(name), solver) for name in ("cycle-v0.02", SURFACES) for solver in SOLVERS]
    left = missing_runs(suite)
    assert len(left) == len(asked) - 3  # one cycle by bem, the other with its surfaces by bem and reference
    assert all(task in asked for task in left)


def test_a_real_claim():
    """Fast retraction from the relaxed contact, by boundary elements and reference."""
    tasks = [(Case("fast", retraction(10.0)), solver) for solver in ("bem", "reference")]
    evidence = collect(tasks, run_all(tasks))
    for statement in (retractions.point_b, retractions.fast_edge_is_griffith):
        finding = statement.finding(evidence)
        assert finding.verdict is HOLDS, finding.shown
    values = {name: value for part in finding.parts for name, value in part.values.items()}
    tips = [value for name, value in values.items() if "K²" in name]
    assert tips[0] == pytest.approx(tips[1], rel=5e-3)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A report of nothing but claims, most of them unjudged."""
    evidence = springs(lambda v: 1.0)
    findings, folder = page.findings(evidence), tmp_path_factory.mktemp("claims")
    with without_layout():
        chapter = page.chapter(findings, evidence)
        empty = SuiteComparison("paper", [], {"python": "3", "processor": "none"}, 1.0)
        compare_page.write(empty, folder, others=[chapter])
    return findings, chapter.checks, folder


def test_report_tells_every_statement_and_fails_changed_verdicts_alone(written):
    findings, checks, folder = written
    failed = {check.quantity for check in checks if not check.passed}
    assert failed == {one.name for one in findings if one.changed}
    data = json.loads((folder / "report.json").read_text())
    assert [one["name"] for one in data["claims"]] == [one.name for one in CLAIMS]
    assert data["checks"] == len(CLAIMS)
    whole, short = (folder / "index.html").read_text(), (folder / "summary.md").read_text()
    for one in findings:
        assert str(escape(one.wording)) in whole
        assert one.verdict is HOLDS or one.wording in short
    root = tree.parse(folder / "junit.xml").getroot()
    assert len(root.findall(".//testcase")) == len(CLAIMS) == int(root.attrib["tests"])
    assert len(root.findall(".//failure")) == sum(not one.passed for one in checks)


def test_figures_are_drawn_where_their_runs_are_there(written):
    _, _, folder = written
    drawn = {file.name for file in (folder / "figures").iterdir()}
    assert drawn == {"fig2a.png", "fig2b.png", "fig2c.png", "fig7b.png"}
    assert (folder / "figures" / "fig2a.png").read_bytes().startswith(b"\x89PNG")
    assert "No figure: a run is missing." in (folder / "index.html").read_text()
