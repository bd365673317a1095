"""Studies end to end, on made-up solvers: every form is written, failures stay, errors are one line."""

from __future__ import annotations

import dataclasses
import json
import os

import numpy as np
import pytest
from support.spring_solver import StudiedSolver, small_scene, spring
from support.unlaid_figures import without_layout

from contact_scene import Counters, OutcomeKind
from crosscontact.cli import main
from validation.cases import load
from validation.report import html
from validation.report.texts import markdown
from validation.runs.folder import to_json
from validation.runs.progress import Progress
from validation.studies import ladders as schemes
from validation.studies import study
from validation.studies.page import data as data_of
from validation.studies.page import document, draw

ORDERS = {"bem": 2.0, "paper-scheme": 1.0, "fem": 2.0, "reference": 4.0}


def converging(order: float, resolution_counts: bool = True):
    """A spring whose stiffness converges to 1 with the resolution, and whose work grows with it."""

    def solve(scene, resolution, **options):
        n = resolution if resolution_counts else 1
        trace = spring(1.0 + n**-order)(scene)
        return dataclasses.replace(trace, counters=Counters(steps=n, linear_solves=n * n))

    return solve


@pytest.fixture
def scene_file(tmp_path):
    return small_scene(tmp_path)


@pytest.fixture
def fakes(monkeypatch):
    """All schemes replaced; ``fakes(bem=function)`` replaces them again."""

    def put(**functions):
        for name, order in ORDERS.items():
            solve = functions.get(name.replace("-", "_"), converging(order))
            scheme = dataclasses.replace(schemes.SCHEMES[name], solver=StudiedSolver(solve))
            monkeypatch.setitem(schemes.SCHEMES, name, scheme)

    put()
    return put


def studied(scene_file) -> tuple[study.Study, dict]:
    """A study and its JSON, without the figures, which take their time."""
    found = study.study([load(scene_file)], 1, Progress("test"))
    return found, json.loads(to_json(data_of(found)))


def page_without_figures(found: study.Study) -> str:
    return html.text(document(found, figures=False))


def ladder_of(data: dict, scheme: str, kind: str = "together") -> dict:
    found = [e for e in data["scenes"][0]["ladders"] if (e["scheme"], e["kind"]) == (scheme, kind)]
    assert len(found) == 1
    return found[0]


def observable(ladder: dict, name: str) -> dict:
    return next(row for row in ladder["observables"] if row["observable"] == name)


def test_a_study_writes_every_form(capsys, tmp_path, scene_file, fakes):
    out = tmp_path / "out"
    with without_layout():
        assert main(["study", scene_file, "--jobs", "1", "--out", str(out)]) == 0
    data = json.loads((out / "study.json").read_text())
    assert sorted(file.name for file in out.glob("[!.]*")) == [
        "figures",
        "index.html",
        "study.json",
        "study.md",
    ]
    shown, progress = capsys.readouterr()
    assert "paper-scheme" in shown
    assert "is cheapest" in shown
    assert "small reference zone" in progress
    page, text = (out / "index.html").read_text(), (out / "study.md").read_text()
    for said in ("Observed orders", "Error against run time", "process zone", "At 1e-04"):
        assert said in page
        assert said in text
    for solver in ("bem", "fem", "reference"):  # the made-up answer does not hang on the zone
        assert f"| pull off force | {solver} | 0.010" in text.partition("no zone")[2]
    assert page.count("<svg") == 9  # the radius of what is made up has no error
    pictures = sorted(file.name for file in (out / "figures").iterdir())
    assert len(pictures) == 18
    assert (out / "figures" / "small-order-loop.png").read_bytes().startswith(b"\x89PNG")
    assert data["environment"]["threads"]["OMP_NUM_THREADS"] == os.environ["OMP_NUM_THREADS"]


def test_orders_come_out_as_they_went_in(scene_file, fakes):
    _, data = studied(scene_file)
    for scheme in ("bem", "paper-scheme"):
        row = observable(ladder_of(data, scheme), "pull_off_force")
        assert row["alone"]["orders"] == pytest.approx([ORDERS[scheme]] * 3, rel=1e-6)
        assert row["orders"] == pytest.approx([ORDERS[scheme]] * 4, rel=0.02)
        assert row["alone"]["richardson"] == pytest.approx(0.01)
        assert row["alone"]["verdict"] == "asymptotic"
        assert len(row["values"]) == 5
    growth = {(e["scheme"], e["work"]): e for e in data["scenes"][0]["growth"]}
    assert growth["bem", "linear_solves"]["with_resolution"] == pytest.approx(2.0)
    assert growth["paper-scheme", "linear_solves"]["with_error"] == pytest.approx(2.0, rel=0.05)
    zones = observable(ladder_of(data, "bem", "zone"), "pull_off_force")["errors"]
    assert [error is None for error in zones] == [True, False, True, True]  # another zone, another answer
    doubtful = data["scenes"][0]["reference_uncertainty"]["pull_off_force"]
    assert doubtful == pytest.approx((40.0**-4 - 80.0**-4) / 3.0, rel=0.01)


def test_a_scheme_that_is_missing_stays_visible(capsys, scene_file, fakes):
    def missing(*arguments, **options):
        raise ModuleNotFoundError("No module named 'bem_solver.paper_scheme'")

    fakes(paper_scheme=missing)
    assert main(["study", scene_file, "--jobs", "1"]) == 1
    err = capsys.readouterr().err
    assert "failed: small: paper-scheme: together 4: ModuleNotFoundError" in err
    assert "Traceback" not in err
    found, data = studied(scene_file)
    kinds = {(e["scheme"], e["kind"]) for e in data["scenes"][0]["ladders"]}
    assert {("fem", "domain"), ("bem", "step"), ("fem", "mesh"), ("reference", "zone")} <= kinds
    assert data["scenes"][0]["failed_levels"] == 5
    assert ladder_of(data, "paper-scheme")["levels"][0]["failure"].startswith("ModuleNotFoundError")
    assert "FAILED: ModuleNotFoundError" in page_without_figures(found)
    assert "FAILED: ModuleNotFoundError" in markdown(document(found, figures=False))
    for work in ("", "wall_seconds"):
        drawn = draw(found.scenes[0].timed, "force, RMS", work)
        assert drawn is not None
        labels = drawn.axes[0].get_legend_handles_labels()[1]
        assert "paper-scheme: 5 failed" in labels
        assert "paper-scheme" not in labels


def test_a_level_that_breaks_down_keeps_its_place(scene_file, fakes):
    def breaking(scene, resolution, step_tolerance, **options):
        trace = converging(2.0)(scene, resolution)
        if step_tolerance is not None:  # not the ladder of everything together
            return trace
        if resolution == 8:
            raise FloatingPointError("overflow")
        if resolution == 64:
            ending = dataclasses.replace(trace.outcome, kind=OutcomeKind.STEP_UNDERFLOW)
            return dataclasses.replace(trace, outcome=ending)
        if resolution == 32:
            return dataclasses.replace(trace, force=np.full_like(trace.force, np.nan))
        return trace

    fakes(bem=breaking)
    found, data = studied(scene_file)
    assert len(found.scenes[0].failed) == 3
    levels = ladder_of(data, "bem")["levels"]
    said = [level["failure"] for level in levels]
    assert said == ["", "FloatingPointError: overflow", "", "not finite: force", "step underflow: as told"]
    row = observable(ladder_of(data, "bem"), "pull_off_force")
    assert [value is None for value in row["values"]] == [False, True, False, True, True]
    assert row["orders"] == [None] * 4


def test_a_coarser_reference_serves_or_values_are_judged_alone(scene_file, fakes):
    def failing(at_least):
        def solve(scene, resolution, **options):
            if resolution >= at_least:
                raise FloatingPointError("too fine")
            return converging(2.0)(scene, resolution)

        return solve

    fakes(reference=failing(80))
    found, data = studied(scene_file)
    said = data["scenes"][0]["reference"]
    assert said.startswith("front tracking at resolution 60; 80 failed: FloatingPointError")
    assert said in markdown(document(found, figures=False))
    fakes(reference=failing(0))
    found, data = studied(scene_file)
    assert data["scenes"][0]["reference"].startswith("no reference")
    row = observable(ladder_of(data, "bem"), "pull_off_force")
    assert row["errors"] == [None] * 5
    assert row["alone"]["orders"] == pytest.approx([2.0] * 3, rel=1e-6)
    assert "No reference" in page_without_figures(found)


def test_what_knows_no_layer_is_not_studied_on_one():
    asked = {
        name: {(one.scheme, one.kind) for one in schemes.ladders(load(name).scene)}
        for name in ("cycle-v0.02", "layer-cycle")
    }
    left_out = {("paper-scheme", "together"), ("fem", "domain, far boundary held")}
    assert asked["cycle-v0.02"] - asked["layer-cycle"] == left_out


ASKED = {"bem": (1.8, 3.2, 5e-5), "paper-scheme": (0.7, 1.2, 3e-3), "fem": (1.8, 4.5, 5e-5)}
"""Annuli are of second order, the path of an opening edge of third: order and last error of the loop."""


@pytest.mark.exhaustive
def test_real_solvers_converge_as_promised(monkeypatch):
    """The ladders that refine everything, three or four levels, run once: run times are not looked at."""

    def short(scene):
        kept = [ladder for ladder in schemes.ladders(scene) if ladder.timed]
        return [
            dataclasses.replace(one, levels=one.levels[: 3 if one.scheme == "bem" else 4]) for one in kept
        ]

    monkeypatch.setattr(study, "ladders", short)
    monkeypatch.setattr(study, "REPEATS", 1)
    found = study.study([load("cycle-v0.02")], 1, Progress("test")).scenes[0]
    assert found.failed == []
    assert found.reference.startswith("front tracking")
    rows = {(e.ladder.scheme, row.observable): row for e in found.ladders for row in e.rows}
    for name, (low, high, last) in ASKED.items():
        row = rows[name, "loop_energy"]
        assert low <= row.fitted <= high
        assert abs(row.errors[-1]) <= last
    for name in (*ASKED, "reference"):
        row = rows[name, "loop_energy"]
        assert abs(row.errors[-1]) <= row.alone.bound
    known = [order for order in rows["reference", "loop_energy"].alone.orders if order is not None]
    assert min(known) >= 1.8  # a single one is large where a difference happens to be small
    assert 1.8 <= rows["reference", "pull_off_force"].fitted <= 5.0
