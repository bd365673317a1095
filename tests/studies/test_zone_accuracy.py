"""Errors of a solver over zones and kinds of loading: what is compared, and the printed table."""

from dataclasses import replace

import numpy as np
import pytest

from contact_scene import Counters, Outcome, OutcomeKind, Trace
from validation import cases
from validation.execution.runs import Run
from validation.studies import zone_accuracy
from validation.studies.zone_accuracy import SCENES, accuracies, main


def answer(force, resolution):
    times = np.linspace(0.0, 1.0, 5)
    zero = np.zeros(5)
    trace = Trace(
        solver="one",
        outcome=Outcome(OutcomeKind.COMPLETED, "done", 1.0),
        counters=Counters(steps=resolution or 7),
        time=times,
        penetration=times,
        force=np.full(5, force),
        contact_radius=np.full(5, 0.5),
        stored_energy=zero,
        external_work=zero,
        dissipated_energy=zero,
    )
    return Run("scene", "one", trace, cpu_seconds=1.0, measures={"pull_off_force": force})


@pytest.fixture
def asked(monkeypatch):
    """Scenes that were run: solver, zone, resolution; the reference has a force of 2, others one of 2.1."""
    calls = []

    def run(case, name, resolution=None):
        calls.append((name, case.scene.adhesion.zone, resolution))
        return answer(2.0 if name == "reference" else 2.1, resolution)

    monkeypatch.setattr(zone_accuracy, "run", run)
    return calls


def test_errors_are_those_against_the_finer_reference_with_the_same_zone(asked):
    case = cases.load("cycle-v0.02")
    short, long = 0.5e-3, 0.5e-1
    made = list(accuracies("bem", [case], (1e-3, 1e-1), times=3))
    assert [one.ratio for one in made] == [1e-1, 1e-3]
    assert asked[0][0] == "reference"
    assert [(name, zone) for name, zone, _ in asked[1:]] == [
        ("reference", long),
        ("bem", long),
        ("reference", short),
        ("bem", short),
    ]
    finer, three_times = asked[1][2], asked[2][2]
    assert finer % 2 == 0
    assert three_times % 3 == 0
    assert made[0].steps == three_times
    for one in made:
        assert one.errors["pull_off_force"] == pytest.approx(0.05)
        assert one.errors["force, RMS"] == pytest.approx(0.05)
        assert one.errors["contact_radius, RMS"] == pytest.approx(0.0, abs=1e-12)


def test_a_run_without_an_answer_has_no_errors(asked, monkeypatch):
    def run(case, name, resolution=None):
        return Run("scene", name, failure="refused") if name == "fem" else answer(2.0, resolution)

    monkeypatch.setattr(zone_accuracy, "run", run)
    (one,) = accuracies("fem", [cases.load("cycle-v0.02")], (1e-2,))
    assert one.errors == {}
    assert one.ending == "refused"


def test_what_has_no_zone_is_one_line(asked, capsys):
    assert main(["bem", "elastic-press"]) == 2
    assert capsys.readouterr().err == "elastic-press: adhesion: a study of zones needs adhesion\n"
    assert main(["bem", "no-such-scene"]) == 2
    assert "no-such-scene" in capsys.readouterr().err
    assert asked == []


def test_table_names_the_largest_errors_and_their_place(asked, capsys):
    assert main(["bem", "cycle-v0.02", "--zones", "1e-2"]) == 0
    shown = capsys.readouterr().out
    assert "largest error of pull_off_force: 5.0e-02 (cycle-v0.02, 1e-02)" in shown


def test_scenes_are_built_in_and_have_a_zone():
    for case in cases.load_all(SCENES):
        assert replace(case.scene.adhesion, zone=0.1).zone == 0.1
        assert case.scene.is_adhesive
