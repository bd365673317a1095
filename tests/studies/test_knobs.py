"""Studies of process zones and of the bulk modulus: what is run, subtracted, written and refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.closed_forms.separate_bulk import equivalent_material
from support.synthetic_traces import DETACHED, by_hand
from support.unlaid_figures import without_layout

from contact_scene import Branch, Counters, Material, SceneError
from crosscontact.cli import main
from validation import cases
from validation.measure.curves import CURVES
from validation.measure.observables import measure
from validation.runs import pool
from validation.runs.pool import TaskEnding, TaskResult
from validation.runs.run import Run
from validation.studies import knobs
from validation.studies.knobs import ASSUMPTIONS, KnobRun, Poisson, Zones, growth

GLASSY = 9.0  # G(0)/G(infinity) - 1
RUBBER = Material(3.0, 0.45, (Branch(5.0, 0.2), Branch(7.0, 3.0)))
CYCLE = cases.load("cycle-v0.02")


def carson(material, s):
    """``s`` times the Laplace transform of a relaxation modulus."""
    branches = ((b.modulus, s * b.time) for b in material.branches)
    return material.modulus + sum(modulus * t / (1.0 + t) for modulus, t in branches)


def test_moduli_are_those_of_the_correspondence_principle():
    """All materials of a study have one shear modulus; full and surface one bulk modulus."""
    separate = knobs.with_bulk(RUBBER, 40.0)
    s = np.geomspace(1e-4, 1e4, 17)
    g = carson(RUBBER, s) / (2.0 * (1.0 + RUBBER.poisson))
    k = 40.0 * RUBBER.modulus / (2.0 * (1.0 + RUBBER.poisson))
    assert knobs.bulk_modulus(separate) == pytest.approx(k)
    assert_allclose(carson(separate, s) / (2.0 * (1.0 + separate.poisson)), g)
    felt = equivalent_material(separate)
    assert_allclose(carson(felt, s) / (1.0 - felt.poisson**2), 4.0 * g * (3.0 * k + g) / (3.0 * k + 4.0 * g))
    assert_allclose(carson(knobs.tension(separate), s), 9.0 * k * g / (3.0 * k + g))
    assert_allclose(carson(knobs.incompressible(separate), s), 3.0 * g)
    assert knobs.constant(separate) == replace(separate, bulk=None)
    ratio = (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g))
    assert_allclose(ratio[[-1, 0]], [knobs.glassy_poisson(separate), separate.poisson], atol=1e-3)
    assert knobs.tension(separate).poisson == separate.poisson


def answered(case, solver, resolution=None, progress=None, estimate=False, max_steps=None, **others):
    """A run as stiff as its material is at first; compressible ones know the modulus of the surface."""
    material = case.scene.material
    if material.bulk is not None:
        material = equivalent_material(material)
    steps = np.arange(3.0)
    force = material.glassy_plane_modulus * np.array([0.0, 2.0, -1.0])
    rows = {"penetration": 1.0 - (steps - 1.0) ** 2, "force": force, "contact_radius": [1.0, 2.0, 0.5]}
    trace = by_hand(steps, DETACHED, solver, **rows)
    errors = dict.fromkeys((*Poisson.observed, *CURVES), 1e-6)
    return Run(case.name, solver, trace, measures=measure(trace, case.scene, 0.0), errors=errors)


def careless(case, solver, *rest, **others):
    """Finite elements that overlook the bulk modulus."""
    material = case.scene.material
    wrong = knobs.incompressible(material) if solver == "fem" else material
    return answered(replace(case, scene=replace(case.scene, material=wrong)), solver)


def test_poisson_prints_a_table_and_leaves_every_number(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(pool, "run", answered)
    assert main(["study", "cycle-v0.02", "--poisson", "100", "--jobs", "1", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "pull off force" in printed
    assert "+0.0e+00" in printed
    kept = json.loads((tmp_path / "poisson-cycle-v0.02.json").read_text("utf-8"))
    (only,) = kept["compressibilities"]
    assert only["bulk_to_shear"] == 100.0
    assert list(only["runs"]) == ["full", "surface", *ASSUMPTIONS]
    cost = {name: run["differences"]["pull_off_force"] for name, run in only["runs"].items()}
    assert cost["full"] == 0.0
    assert_allclose(cost["shear"], GLASSY / 100.0, rtol=0.1)
    assert_allclose(cost["tension"], GLASSY / 150.0, rtol=0.1)
    assert_allclose(cost["incompressible"], (GLASSY + 1.0) / 100.0, rtol=0.12)
    assert (tmp_path / "poisson-cycle-v0.02.md").read_text("utf-8").count("| 100 |") == 6


def test_disagreement_and_failure_are_exit_code_1(monkeypatch, capsys):
    monkeypatch.setattr(pool, "run", careless)
    assert main(["study", "cycle-v0.02", "--jobs", "1", "--poisson", "10"]) == 1
    said = capsys.readouterr().err
    assert "failed: cycle-v0.02: K/G = 10: approach_force: beyond the error estimates" in said
    assert "radius: beyond" not in said
    monkeypatch.setattr(pool, "run", lambda of, solver, *rest, **named: Run("x", solver, failure="no"))
    assert main(["study", "cycle-v0.02", "--jobs", "1", "--poisson"]) == 1
    assert capsys.readouterr().err.count("full: failed: no") == len(Poisson.values)


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--poisson", "0.5", "above 2/3"),
        ("--poisson", "nan", "above 2/3"),
        ("--zones", "2", "2e-9 to 0.2"),
    ],
)
def test_an_impossible_value_is_bad_input(option, value, said, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["study", "cycle-v0.02", option, value])
    assert said in capsys.readouterr().err


@pytest.mark.exhaustive
@pytest.mark.parametrize("ratio", [10.0, 100.0])
def test_finite_elements_with_elastic_bulk_meet_the_modulus_of_the_surface(ratio):
    """Two methods for nu(t); a constant ratio takes the fast response too stiff, far beyond any error."""
    study = Poisson(resolution=4)
    runs = study.runs(CYCLE, (ratio,))
    assert list(study.failures(runs)) == []
    errors = {one.label: one.differences(study.observed) for one in runs}
    assert all(abs(one.error) < 2e-4 for one in errors["full"].values())
    cost = {name: errors[name]["pull_off_force"].error for name in ASSUMPTIONS}
    assert 0.0 < cost["tension"] < cost["shear"] < cost["incompressible"]
    assert cost["tension"] > 20.0 * errors["full"]["pull_off_force"].own
    assert 0.5 < cost["shear"] / (GLASSY / ratio) < 1.1


def answer(steps, seconds):
    rows = dict.fromkeys(("penetration", "force", "contact_radius"), (0.0, 1.0))
    counters = Counters(steps=steps, history_updates=10 * steps)
    trace = by_hand([0.0, 1.0], solver="one", counters=counters, **rows)
    measures = {"pull_off_force": 2.0 + seconds, "loop_energy": None}
    return Run("scene", "one", trace, cpu_seconds=seconds, measures=measures)


def of_zone(ratio, label="bem", **others):
    return KnobRun(ratio, label, CYCLE, **others)


def test_growth_is_the_exponent_of_the_zone():
    runs = [of_zone(r, run=answer(round(100.0 * r**-0.5), 1.0)) for r in (1e-2, 1e-4, 1e-6)]
    assert growth(runs, "steps") == pytest.approx(0.5, abs=1e-3)
    assert growth(runs[:2], "steps") is None
    assert growth([*runs, of_zone(1e-8, skipped="not run")], "updates") == pytest.approx(0.0)


def test_a_slow_solver_is_asked_no_further(monkeypatch):
    """Errors are those against the finer reference; the other laws of adhesion stay."""
    asked = []

    def run(case, solver, resolution=None, *given):
        asked.append((case.scene.adhesion, resolution))
        return answer(100, 1.0)

    def run_tasks(tasks, executor, store):
        assert all(task.time_limit == knobs.PATIENCE for task in tasks)
        case, solver = tasks[0].arguments[:2]
        slow = solver == "bem" and case.scene.adhesion.zone < 0.05
        value = None if slow else answer(100, 4.0)
        ending = TaskEnding.TIMED_OUT if slow else TaskEnding.ANSWERED
        return [TaskResult(tasks[0], value, "no answer within 60 s" if slow else "", ending=ending)]

    monkeypatch.setattr(knobs, "run", run)
    monkeypatch.setattr(knobs, "run_tasks", run_tasks)
    case = cases.load("hysteresis-si")
    found = Zones(("reference", "bem")).runs(case, (1e-2, 1e-1, 1e-3))
    own, zones = case.scene.adhesion, (0.1, 0.01, 0.001)
    assert own.work_closing is not None
    assert [one for one, _ in asked] == [own, *(replace(own, zone=zone) for zone in zones)]
    assert [finer is not None for _, finer in asked] == [False, True, True, True]
    by_bem = [one for one in found if one.label == "bem"]
    late = ["", "no answer within 60 s", "not run: too long at a longer zone"]
    assert [one.skipped for one in by_bem] == late
    assert [Zones().errors(one) for one in by_bem] == [{"pull_off_force": 1.0}, {}, {}]


@pytest.mark.parametrize("without", ["adhesion", "stress"])
def test_zones_need_adhesion_of_a_given_length(without):
    case = cases.load("fixed-stress-si")
    if without == "adhesion":
        case = replace(case, scene=replace(case.scene, adhesion=None))
    with pytest.raises(SceneError, match=r"adhesion" if without == "adhesion" else r"adhesion\.stress"):
        Zones(("reference",)).runs(case, (1e-2,))


@pytest.mark.filterwarnings("error")
def test_zones_write_table_figure_and_numbers(tmp_path, capsys, monkeypatch):
    """A solver's curves end where it was not run; without an answer the figure is empty."""
    monkeypatch.setattr(knobs, "run", lambda case, solver, resolution=None: answer(100, 1.0))
    taken = replace(answer(100, 2.0), peak_memory=250_000_000)
    monkeypatch.setattr(knobs, "run_tasks", lambda tasks, *others: [TaskResult(tasks[0], taken)])
    ratios = ["1e-2", "1e-4", "1e-6"]
    with without_layout():
        assert main(["study", "cycle-v0.02", "--zones", *ratios, "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "growth of steps" in shown
    assert "250" in shown
    data = json.loads((tmp_path / "zones-cycle-v0.02.json").read_text())
    of_reference = [one for one in data["runs"] if one["solver"] == "reference"]
    assert [one["zone_over_radius"] for one in of_reference] == [1e-2, 1e-4, 1e-6]
    assert {one["peak_memory_bytes"] for one in data["runs"]} == {250_000_000}
    assert (tmp_path / "zones-cycle-v0.02.png").stat().st_size > 1000
    assert "| zone / radius" in (tmp_path / "zones-cycle-v0.02.md").read_text()
    runs = [of_zone(r, run=answer(100, 2.0), base=answer(100, 1.0)) for r in (1e-2, 1e-4)]
    axes = Zones().draw([*runs, of_zone(1e-6, skipped="not run")]).axes
    drawn = {one.get_ylabel(): list(one.lines[0].get_ydata()) for one in axes if one.lines}
    assert drawn["error of pull off force (relative)"] == pytest.approx([1 / 3] * 2)
    assert drawn["updates of the history in a step"] == [10.0, 10.0]
    assert not any(one.lines for one in Zones().draw([of_zone(1e-2, skipped="too long")]).axes)
