"""Cost over the process zone: fits, skipped solvers, what is written, and the command."""

import json
from dataclasses import replace

import numpy as np
import pytest

from contact_scene import Counters, Outcome, OutcomeKind, SceneError, Trace
from crosscontact.cli import main
from validation import cases
from validation.report import terminal
from validation.runs.pool import TaskEnding, TaskResult
from validation.runs.run import Run
from validation.studies import zones
from validation.studies.zone_page import draw, section
from validation.studies.zones import MeasuredRun, ZoneRun, growth, zone_runs

ROWS = {name: np.array([0.0, 1.0]) for name in ("time", "penetration", "force", "contact_radius")}
ENERGIES = {name: np.zeros(2) for name in ("stored_energy", "external_work", "dissipated_energy")}


def answer(steps, seconds):
    counters = Counters(steps=steps, history_updates=10 * steps)
    outcome = Outcome(OutcomeKind.COMPLETED, "done", 1.0)
    trace = Trace(solver="one", outcome=outcome, counters=counters, **ROWS, **ENERGIES)
    measures = {"pull_off_force": 2.0 + seconds, "loop_energy": None}
    return Run("scene", "one", trace, cpu_seconds=seconds, measures=measures)


def test_growth_is_the_exponent_of_the_zone():
    runs = [ZoneRun(r, r, "one", answer(round(100.0 * r**-0.5), 1.0)) for r in (1e-2, 1e-4, 1e-6)]
    assert growth(runs, "steps") == pytest.approx(0.5, abs=1e-3)
    assert growth(runs, "seconds") == pytest.approx(0.0, abs=1e-12)
    assert growth(runs[:2], "steps") is None
    assert growth([*runs, ZoneRun(1e-8, 1e-8, "one", skipped="not run")], "updates") == pytest.approx(0.0)


def test_a_slow_solver_is_asked_no_further(monkeypatch):
    """One that took too long is not asked again; errors are those against the finer reference."""
    asked = []

    def run(case, solver, resolution=None, *given):
        asked.append((solver, case.scene.adhesion.zone, resolution))
        return answer(100, 1.0)

    def run_tasks(tasks, executor, store):
        assert all(task.time_limit == zones.PATIENCE for task in tasks)
        case, solver = tasks[0].arguments[1:3]
        slow = solver == "bem" and case.scene.adhesion.zone < 0.05
        value = None if slow else MeasuredRun(answer(100, 4.0), 2_000_000)
        ending = TaskEnding.TIMED_OUT if slow else TaskEnding.ANSWERED
        asked.append((solver, case.scene.adhesion.zone, None))
        return [TaskResult(tasks[0], value, "no answer within 60 s" if slow else "", ending=ending)]

    monkeypatch.setattr(zones, "run", run)
    monkeypatch.setattr(zones, "run_tasks", run_tasks)
    found = zone_runs(cases.load("cycle-v0.02"), ["reference", "bem"], (1e-1, 1e-2, 1e-3))
    assert [one.zone for one in found if one.solver == "bem"] == [0.1, 0.01, 0.001]
    late = ["", "no answer within 60 s", "not run: too long at a longer zone"]
    assert [one.skipped for one in found if one.solver == "bem"] == late
    assert found[0].errors == {"pull_off_force": 1.0}
    assert found[3].errors == {}
    assert ("bem", 0.001, None) not in asked
    text = terminal.text(section("scene", found))
    assert "no answer within 60 s" in text


def test_without_adhesion_there_is_no_zone():
    case = cases.load("cycle-v0.02")
    with pytest.raises(SceneError, match="adhesion"):
        zone_runs(replace(case, scene=replace(case.scene, adhesion=None)), ["reference"])


def test_a_zone_of_fixed_stress_is_not_set():
    case = cases.load("fixed-stress-si")
    with pytest.raises(SceneError, match=r"adhesion\.stress"):
        zone_runs(case, ["reference"])


def test_the_other_laws_of_adhesion_stay(monkeypatch):
    asked = []

    def run(case, solver, resolution=None):
        asked.append(case.scene.adhesion)
        return answer(100, 1.0)

    monkeypatch.setattr(zones, "run", run)
    taken = MeasuredRun(answer(100, 1.0), 1)
    monkeypatch.setattr(zones, "run_tasks", lambda tasks, *others: [TaskResult(tasks[0], taken)])
    case = cases.load("hysteresis-si")
    zone_runs(case, ["reference"], (1e-3,))
    own = case.scene.adhesion
    assert own.work_closing is not None
    assert asked[1] == replace(own, zone=1e-3)


def test_the_figure_shows_all_that_the_table_has():
    """Both errors among it; a solver's curves end where it was not run."""
    runs = [
        ZoneRun(
            r, r, name, answer(100, 1.0), errors={"pull_off_force": -1e-3, "loop_energy": r}, peak_memory=9
        )
        for r in (1e-2, 1e-4)
        for name in ("bem", "reference")
    ]
    runs.append(ZoneRun(1e-6, 1e-6, "bem", skipped="not run"))
    axes = draw(runs).axes
    assert len(axes) == 6
    assert all(len(one.lines) == 2 for one in axes)
    drawn = {one.get_ylabel(): one.lines[0].get_ydata() for one in axes}
    assert list(drawn["error of pull off force (relative)"]) == [1e-3, 1e-3]
    assert list(drawn["error of loop energy (relative)"]) == [1e-2, 1e-4]
    assert list(drawn["updates of the history in a step"]) == [10.0, 10.0]


@pytest.mark.filterwarnings("error")
def test_the_figure_of_runs_without_an_answer_is_empty():
    assert not any(axes.lines for axes in draw([ZoneRun(1e-2, 1e-2, "bem", skipped="too long")]).axes)


@pytest.mark.slow
def test_command_writes_table_figure_and_numbers(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(zones, "run", lambda case, solver, resolution=None: answer(100, 1.0))
    taken = MeasuredRun(answer(100, 1.0), 250_000_000)
    monkeypatch.setattr(zones, "run_tasks", lambda tasks, *others: [TaskResult(tasks[0], taken)])
    code = main(["study", "cycle-v0.02", "--zones", "1e-2", "1e-4", "1e-6", "--out", str(tmp_path)])
    assert code == 0
    shown = capsys.readouterr().out
    assert "growth of steps" in shown
    assert "250" in shown
    data = json.loads((tmp_path / "zones-cycle-v0.02.json").read_text())
    assert [one["zone_over_radius"] for one in data["runs"] if one["solver"] == "reference"] == [
        1e-2,
        1e-4,
        1e-6,
    ]
    assert {one["peak_memory_bytes"] for one in data["runs"]} == {250_000_000}
    assert (tmp_path / "zones-cycle-v0.02.png").stat().st_size > 1000
    assert "| zone / radius" in (tmp_path / "zones-cycle-v0.02.md").read_text()


def test_a_ratio_out_of_range_is_one_line(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["study", "cycle-v0.02", "--zones", "2"])
    assert stopped.value.code == 2
    assert "2e-9 to 0.2" in capsys.readouterr().err
