"""The judgement of the paper's statements: verdicts, what is measured for them, evidence, and the report."""

from __future__ import annotations

import dataclasses
import json
import xml.etree.ElementTree as tree
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from markupsafe import escape
from support.synthetic_traces import follow, half_ellipse, profile, trace
from support.unlaid_figures import without_layout

from contact_scene import OutcomeKind
from validation.cases import Case, load
from validation.claims import cycles, measures, retractions
from validation.claims import page as claims_page
from validation.claims.claim import FAILS, HOLDS, IN_PART, Finding, Part, Verdict, bell, claim, rising
from validation.claims.evidence import (
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
from validation.compare import page
from validation.compare.suite import SuiteComparison
from validation.measure.observables import measure
from validation.runs.pool import run_all
from validation.runs.run import Run
from validation.solvers import SOLVERS

GOOD, BAD = Part("as said", True), Part("otherwise", False)


@pytest.mark.parametrize(
    ("parts", "verdict"),
    [((GOOD, GOOD), HOLDS), ((GOOD, BAD), IN_PART), ((BAD,), FAILS), ((), Verdict.NOT_EVALUATED)],
)
def test_verdict_of_parts(parts, verdict):
    found = Finding("x", "here", "so it is", verdict, parts)
    assert found.verdict is verdict
    assert not found.changed
    assert Finding("x", "here", "so it is", HOLDS, parts).changed == (verdict is not HOLDS)


def test_what_does_not_hold_is_marked():
    assert Finding("x", "here", "", HOLDS, (GOOD, BAD)).shown == "as said; NOT: otherwise"


def test_a_missing_run_leaves_a_claim_unjudged():
    @claim("here", HOLDS)
    def it_holds(found):
        """It holds."""
        return [Part("never reached", bool(found.trace(cycle(0.1))))]

    finding = it_holds.finding(Evidence({}))
    assert finding.verdict is Verdict.NOT_EVALUATED
    assert finding.changed
    assert "not run" in finding.shown


def test_claims_are_stated_once_and_in_full():
    assert len(CLAIMS) >= 45
    assert len({one.name for one in CLAIMS}) == len({one.wording for one in CLAIMS}) == len(CLAIMS)
    assert all(one.place and len(one.wording) > 20 for one in CLAIMS)
    assert {one.recorded for one in CLAIMS} == {HOLDS, IN_PART, FAILS}


def test_claims_on_closed_forms_need_no_run():
    for one in (cycles.closure_is_griffith, cycles.creep_belongs_to_relaxation):
        assert one.finding(Evidence({})).verdict is HOLDS
    for one in (cycles.appendix_uses_the_same_time, cycles.plane_modulus_is_multiplied):
        assert one.finding(Evidence({})).verdict is FAILS


def test_rising_and_bell():
    assert rising([1.0, 2.0, 1.9999])
    assert not rising([1.0, 2.0, 1.9])
    assert bell([1.0, 3.0, 1.0])
    assert not bell([1.0, 2.0, 3.0])
    assert not bell([1.0, 3.0, 2.0, 3.0, 1.0])


def test_hysteresis_is_the_area_between_both_ways():
    there_and_back = trace(depth=[0.0, 1.0, 0.0], force=[0.0, 2.0, 0.0])
    assert measures.hysteresis(there_and_back) == pytest.approx(0.0, abs=1e-12)
    lower = trace(depth=[0.0, 1.0, 1.0, 0.0], force=[0.0, 2.0, 1.0, -1.0])
    assert measures.hysteresis(lower) == pytest.approx(1.0, rel=1e-6)


def test_slopes_about_a_reversal():
    bent = trace(depth=[0.0, 0.5, 1.0, 0.999, 0.5], force=[0.0, 1.5, 3.0, 2.99, -2.0])
    assert measures.last_slope(bent) == pytest.approx(3.0)
    assert measures.first_slope(bent, 1e-3) == pytest.approx(10.0)


def test_share_of_a_straight_withdrawal():
    d = np.array([1.0, 0.8, 0.6, 0.4, 0.2])
    straight = trace(depth=d, force=5.0 * (d - 1.0))
    assert measures.on_line(straight, 5.0) == pytest.approx(1.0)
    bent = trace(depth=d, force=[0.0, -1.0, -2.0, -2.5, -2.7])
    assert measures.on_line(bent, 5.0) == pytest.approx(0.5)
    assert measures.on_line(bent, 9.0) == 0.0


def test_release_rate_is_the_work_less_the_loss_over_area():
    a = np.linspace(0.3, 0.1, 41)
    loss = 0.25 * np.pi * (a[0] ** 2 - a**2)
    run = trace(depth=np.linspace(1, 0, 41), force=-np.ones(41), radius=a, loss=loss)
    assert measures.release_rate(run, 20, work=1.0) == pytest.approx(1.25)
    still = trace(depth=[1.0, 0.5, 0.0], force=[0, -1, 0], loss=[0.0, 1.0, 2.0])
    assert measures.release_rate(still, 1, work=0.7) == 0.7


def test_annular_peak():
    peak = measures.annular_peak(profile(lambda r: 1.0 + 4.0 * r**2 - 4.5 * r**8))
    assert peak is not None
    assert peak[0] == pytest.approx((4.0 / 18.0) ** (1 / 6), abs=0.02)
    assert peak[1] > 1.5
    assert measures.annular_peak(profile(half_ellipse)) is None


def test_exponents_at_the_edge():
    tip = profile(lambda r: -1.0 / np.sqrt(1.0 - r), gap=lambda s: s**1.5)
    assert measures.edge_exponent(tip) == pytest.approx(-0.5)
    assert measures.gap_exponents(tip, (0.01, 0.1, 0.5)) == pytest.approx([1.5, 1.5], rel=1e-3)
    assert measures.edge_exponent(profile(half_ellipse)) == 0.0


def test_crossing():
    assert measures.crossing([1.0, 100.0], [0.0, 1.0], 0.5) == pytest.approx(10.0)
    assert measures.crossing([1.0, 100.0], [0.0, 0.4], 0.5) is None


def evidence_of(*given):
    """Evidence of ``(scene, trace)`` as if the boundary elements had answered."""
    runs = {}
    for scene, found in given:
        runs[without_title(scene), "bem"] = Run("made up", "bem", found, measures=measure(found, scene, 0.0))
    return Evidence(runs)


def gather(tasks, executor=None):
    """Evidence of runs carried out here."""
    return collect(tasks, run_all(tasks, executor))


def springs(strength):
    """Cycles of a spring that lets go at ``strength(speed)`` JKR forces; the loop opens in between."""
    given = []
    for speed in cycles.CYCLE_SPEEDS:
        scene = cycle(speed)
        given.append((scene, follow(scene, strength(speed))))
    return evidence_of(*given)


def test_both_verdicts_on_intermediate_speeds():
    statement = cycles.intermediate_cycles_lose_and_hold
    assert statement.finding(springs(lambda v: 4.0 if 1e-3 < v < 0.1 else 1.0)).verdict is HOLDS
    assert statement.finding(springs(lambda v: 1.0 + 0.03 * v)).verdict is FAILS


def test_both_verdicts_on_the_elastic_limits():
    statement = cycles.limits_share_the_pull_off_force
    assert statement.finding(springs(lambda v: 1.0)).verdict is HOLDS
    assert statement.finding(springs(lambda v: 2.0 if v > 1.0 else 1.0)).verdict is FAILS


def test_both_verdicts_on_where_the_sweep_starts():
    scene = load("sweep").scene
    for force, verdict in ((0.0, HOLDS), (1e-6, IN_PART)):
        start = trace(depth=[5.7e-5, 5.7e-5], force=[force, force])
        assert retractions.starts_without_load.finding(evidence_of((scene, start))).verdict is verdict


def test_a_partial_run_is_no_evidence():
    scene = cycle(0.1)
    part = dataclasses.replace(
        follow(scene, 1.0), outcome=trace().outcome.__class__(OutcomeKind.STEP_BUDGET, "x", 1.0)
    )
    with pytest.raises(MissingRun, match="step budget"):
        evidence_of((scene, part)).trace(scene)
    with pytest.raises(MissingRun, match="no peak_cycle_loss"):
        evidence_of((scene, follow(scene, 1.0))).measure(scene, "peak_cycle_loss")


def test_questions_are_asked_once():
    asked = required_runs()
    assert len({(case.name, solver) for case, solver in asked}) == len(asked)
    assert len({(without_title(case.scene), solver) for case, solver in asked}) == len(asked)
    suite = [(load(name), solver) for name in ("cycle-v0.02", "cycle-v0.002") for solver in SOLVERS]
    left = missing_runs(suite)
    assert len(left) == len(asked) - 3  # one cycle by bem, the other with its surfaces by bem and reference
    assert all(task in asked for task in left)


def test_evidence_through_any_executor():
    case = Case("slow", cycle(0.1))
    with ThreadPoolExecutor(1) as executor:
        found = gather([(case, "nobody")], executor)
    with pytest.raises(MissingRun, match="KeyError"):
        found.trace(cycle(0.1), "nobody")
    assert collect([], {}).runs == {}


def test_dask_runs_a_sweep():
    distributed = pytest.importorskip("distributed", reason="the optional extra `dask` is not installed")
    tasks = [(Case(f"relaxed {name}", load(name).scene), "bem") for name in ("relaxed-equilibrium",)]
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
        client.get_executor() as executor,
    ):
        found = gather(tasks, executor)
    start = found.trace("relaxed-equilibrium")
    assert start.contact_radius[0] == pytest.approx(0.245149, rel=1e-3)


def test_a_real_claim():
    """Fast retraction from the relaxed contact, by boundary elements and reference."""
    scene = retraction(10.0)
    found = gather([(Case("fast", scene), solver) for solver in ("bem", "reference")])
    for statement in (
        retractions.point_b,
        retractions.fast_pull_off_is_large,
        retractions.fast_edge_is_griffith,
    ):
        finding = statement.finding(found)
        assert finding.verdict is HOLDS, finding.shown
    tips = [
        part.values[f"{solver}: K²/(2E∞* Δγ) at pull-off"]
        for solver, part in zip(("bem", "reference"), finding.parts[::2], strict=True)
    ]
    assert tips[0] == pytest.approx(tips[1], rel=5e-3)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A report of nothing but claims, most of them unjudged."""
    findings = claims_page.findings(springs(lambda v: 1.0))
    folder = tmp_path_factory.mktemp("claims")
    environment = {"python": "3", "processor": "none"}
    with without_layout():
        chapter = claims_page.chapter(findings, springs(lambda v: 1.0))
        page.write(SuiteComparison("paper", [], environment, 1.0), folder, others=[chapter])
    return findings, chapter.checks, folder


def test_report_tells_every_statement(written):
    findings, checks, folder = written
    assert len(checks) == len(CLAIMS)
    data = json.loads((folder / "report.json").read_text())
    assert [one["name"] for one in data["claims"]] == [one.name for one in CLAIMS]
    assert data["checks"] == len(CLAIMS)
    whole, short = (folder / "index.html").read_text(), (folder / "summary.md").read_text()
    for one in findings:
        assert str(escape(one.wording)) in whole
        assert one.verdict is HOLDS or one.wording in short
    root = tree.parse(folder / "junit.xml").getroot()
    assert len(root.findall(".//testcase")) == len(CLAIMS) == int(root.attrib["tests"])
    assert (
        len(root.findall(".//failure"))
        == sum(not one.passed for one in checks)
        == int(root.attrib["failures"])
    )


def test_only_a_changed_verdict_fails(written):
    findings, checks, _ = written
    changed = {one.name for one in findings if one.changed}
    assert {check.quantity for check in checks if not check.passed} == changed
    kept = {one.name: one for one in findings if not one.changed}
    assert kept["plane modulus is multiplied"].verdict is FAILS


def test_figures_are_drawn_where_their_runs_are_there(written):
    _, _, folder = written
    drawn = {file.name for file in (folder / "figures").iterdir()}
    assert drawn == {"fig2a.png", "fig2b.png", "fig2c.png", "fig7b.png"}
    assert (folder / "figures" / "fig2a.png").read_bytes().startswith(b"\x89PNG")
    assert "No figure: a run is missing." in (folder / "index.html").read_text()
