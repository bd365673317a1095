"""Grades: exact passes, two percent off fails, another sign is told, half an answer is judged on half."""

from __future__ import annotations

import json
import xml.etree.ElementTree as tree
from dataclasses import replace

import numpy as np
import pytest
from support.closed_forms.maugis_dugdale import MaugisDugdale
from support.exam_answers import SCENE, case, hertz, hertz_run, put, text
from support.unlaid_figures import without_layout

from contact_scene import COLUMNS, Adhesion, Machine, PowerRate
from validation.exam import grading, judge
from validation.exam.answer import Answer, Header, read_folder
from validation.exam.grading import Grade, balance_error, decade, grade
from validation.measure.difference import Difference

BASE = hertz_run()


def graded(columns: dict[str, np.ndarray]) -> Grade:
    return grade(Answer(Header("a code"), "x", columns), case().scene, BASE)


def test_the_exact_answer_passes():
    found = graded(hertz(800))
    assert found.decade >= 5
    names = {one.quantity for one in found.differences}
    assert {"force, curve", "approach_force", "loop_energy", "energy balance", "detachment_time"} <= names
    assert graded(hertz(60)).decade in (2, 3, 4)


@pytest.mark.parametrize("column", COLUMNS[1:-1])
def test_one_column_two_percent_off_fails(column):
    columns = hertz(400)
    columns[column] = 1.02 * columns[column]
    found = graded(columns)
    assert not found.passed
    assert found.error(f"{column}, curve") == pytest.approx(0.02, rel=1e-2)
    assert f"{column.replace('_', ' ')} is 1.02 times the reference throughout" in found.remarks
    columns[column] = columns[column] / 1.02 * 1.002
    assert graded(columns).passed


def test_another_sign_unit_or_diameter_is_told():
    columns = hertz(400)
    wrong = {
        "force": (-1.0, "force has the other sign: compression is positive"),
        "penetration": (-1.0, "penetration has the other sign: downwards is positive"),
        "contact_radius": (2.0, "contact radius is 2 times the reference throughout, a diameter?"),
        "stored_energy": (1e3, "stored energy is 1000 times the reference throughout, another unit or sign?"),
    }
    wrong["external_work"] = (0.0, "external work is zero throughout")
    for column, (factor, said) in wrong.items():
        found = graded(columns | {column: factor * columns[column]})
        assert said in found.remarks
        assert not found.passed


def test_missing_columns_are_not_graded():
    columns = hertz(400)
    found = graded({name: columns[name] for name in ("time", "force")})
    peak = {"peak_force", "peak_time"}
    assert {one.quantity for one in found.differences} == {
        "force, curve",
        "start_force",
        "time covered",
    } | peak
    assert found.passed
    assert graded({"time": columns["time"]} | {"dissipated_energy": 0 * columns["time"]}).decade >= 2


def test_what_stops_early_starts_late_or_never_lets_go_fails():
    columns = hertz(400)
    half = {name: column[:399] for name, column in columns.items()}
    later = {name: column[columns["time"] >= 1.8] for name, column in columns.items()}
    for rows, missing in ((half, 0.5), (later, 0.3)):
        found = graded({name: rows[name] for name in ("time", "force")})
        assert not found.passed
        assert found.error("time covered") == pytest.approx(missing, abs=0.01)
    held = graded(half)
    assert any(one.note == "does not lose contact" for one in held.differences)
    assert not held.passed


def test_energies_that_do_not_close_fail():
    columns = hertz(400)
    columns["dissipated_energy"] = 0.03 * columns["stored_energy"].max() * columns["time"] / 6.0
    found = graded(columns)
    assert found.error("energy balance") == pytest.approx(0.03, rel=0.1)
    assert not found.passed


def test_the_balance_knows_springs_and_an_edge_that_closes_for_less():
    base, columns = case().scene, hertz(400)
    rows = BASE.trace
    names = set(columns)
    assert balance_error(names, rows, base) < 1e-12
    sprung = replace(base, loading=replace(base.loading, machine=Machine(stiffness=0.05)))
    spring = 0.5 * rows.force**2 / 0.05
    on_stage = replace(rows, external_work=rows.external_work + spring)
    assert balance_error(names, on_stage, sprung) < 1e-12
    assert balance_error(names, rows, sprung) > 0.1
    assert balance_error(names - {"force"}, on_stage, sprung) is None
    area = np.pi * rows.contact_radius**2
    half = len(rows) // 2
    opening = np.arange(len(rows)) > half  # closes up to the middle, gives 1e-3 per area; opens for 2e-3
    spent = np.where(opening, 2e-3 * (area[half] - area) - 1e-3 * area[half], -1e-3 * area)
    edge = replace(base, adhesion=Adhesion(2e-3, 0.01, work_closing=1e-3))
    assert balance_error(names, replace(rows, external_work=rows.external_work + spent), edge) < 1e-12
    assert balance_error(names, rows, edge) > 0.1
    rated = replace(base, adhesion=Adhesion(2e-3, 0.01, rate=PowerRate(1e-3, 0.5)))
    assert balance_error(names, rows, rated) is None


def test_decades():
    exact = replace(BASE, errors={})
    assert decade([Difference("force", 0.9e-3), Difference("loop_energy", -0.9e-4)], exact) == 3
    assert decade([Difference("pull_off_radius", 0.03)], exact) == 3
    assert decade([Difference("force", 0.9e-3, known_to=1e-3)], exact) == 6
    assert decade([Difference("force", 1.1e-3, known_to=1e-3)], exact) == 2  # counts in full from there on
    assert decade([Difference("force", -2e-2, known_to=1e-3)], exact) == 1
    assert decade([Difference("force", 0.0)], replace(BASE, errors={"force": 0.5e-4})) == 4
    assert decade([Difference("force", np.inf)], exact) == decade([], exact) == 0


def test_verdicts_and_their_report(tmp_path, monkeypatch):
    """Four codes on a scene: a good one at two sizes, one off, one that declines, one that cannot be read."""
    columns = hertz(400)
    put(tmp_path / "good", text(columns, "good", seconds=2.0, resolution=400), "trace-1.csv")
    put(tmp_path / "good", text(hertz(12), "good", seconds=0.1, resolution=12))
    put(tmp_path / "off", text(columns | {"force": -columns["force"]}, "off", seconds=1.0))
    put(tmp_path / "shy", "shy: has <no> springs | at all", "declined.txt")
    put(tmp_path / "broken", "# code: broken\ntime,force\n0,x\n")
    monkeypatch.setattr(judge, "reference_runs", lambda cases, *rest: {SCENE: BASE})
    judgement = judge.judge_folder(read_folder(tmp_path))
    (scene,) = judgement.scenes
    verdicts = {one.code: one for one in scene.verdicts}
    kinds = {"broken": "failed", "good": "passed", "off": "failed", "shy": "declined"}
    assert {code: one.kind for code, one in verdicts.items()} == kinds
    assert verdicts["good"].verdict in ("passed at 1e-4", "passed at 1e-5")
    assert [one.answer.header.resolution for one in verdicts["good"].answers] == ["12", "400"]
    assert "the other sign" in verdicts["off"].reason
    assert "force, line 3: " in verdicts["broken"].reason
    assert [check.passed for check in judgement.checks] == [False, True, False]
    folder = tmp_path / "report"
    with without_layout():
        judge.write(judgement, folder, 1.0)
    page, summary = (folder / "index.html").read_text(), (folder / "exam.md").read_text()
    for said in ("passed at 1e-", "the other sign", "good", "broken", "declined"):
        assert said in page
        assert said in summary
    assert "has &lt;no&gt; springs" in page
    assert page.count("<svg") == 1
    assert (folder / "figures" / f"exam-{SCENE}.png").read_bytes().startswith(b"\x89PNG")
    suites = tree.parse(folder / "junit.xml").getroot()
    assert (suites.attrib["failures"], suites.attrib["tests"]) == ("2", "3")
    data = json.loads((folder / "exam.json").read_text())
    assert data["scenes"][0]["verdicts"][1]["answers"][1]["seconds"] == 2.0


def test_the_zone_of_a_transition_parameter_is_that_of_maugis():
    radius, modulus, work, transition, contact = 2.0, 3.0, 5e-4, 100.0, 0.3
    strength = 0.5 * transition * np.cbrt(np.pi * work * (4.0 * modulus / 3.0) ** 2 / radius)
    exact = MaugisDugdale(radius, modulus, work, strength)
    ring = (exact.ring_ratio(contact) - 1.0) * contact
    assert grading.zone_of(exact.transition, radius, modulus, work) == pytest.approx(ring, rel=1e-3)


@pytest.mark.parametrize(
    ("errors", "converges"),
    [
        ((0.2, 0.05, 0.0125), True),
        ((0.2, 0.15, 0.14), False),
        ((0.05, 0.2, 0.01), False),
        ((0.2, 0.2, 0.2), False),
    ],
)
def test_a_code_of_finite_range_has_to_converge(errors, converges):
    points = [grading.RangeError(x, x**-2, error) for x, error in zip((1.0, 2.0, 4.0), errors, strict=True)]
    assert grading.track_of(points).converges is converges
