"""Fits: what comes back of what was put in, and what a fit says of a model that is wrong."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.closed_form_solver import registered
from support.recorded import MODULUS, elastic_scene, hertz_curve

import crosscontact as cc
from contact_scene import (
    Adhesion,
    Branch,
    Loading,
    Machine,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Table,
    read_scene,
    write_scene,
)
from crosscontact.cli import main
from validation.execution.store import Store
from validation.fits.curve_files import write_csv
from validation.fits.curve_model import CurveModel
from validation.fits.fit import fit_curves
from validation.fits.fit_question import check_folder, question
from validation.fits.fit_result import InterruptedFit
from validation.fits.fit_settings import FitSettings
from validation.fits.measured_curve import MeasuredCurve
from validation.fits.parameters import ParameterSet, scene_parameter
from validation.fits.problem import FitProblem
from validation.fits.synthetic import synthetic
from validation.reference.ting import Ting
from validation.report.sections.fit import document, drawings
from validation.report.sections.fit_statements import statements

GUESS = 1.3 * MODULUS


@pytest.fixture(scope="module", autouse=True)
def closed_form():
    """The runs of these fits are closed forms."""
    with registered() as name:
        yield name


def settings_of(*vary, **more):
    return FitSettings(vary=vary, **{"solver": "closed-form", "check_solver": None} | more)


@pytest.fixture(scope="module")
def elastic(closed_form):
    options = {"profile": ("material.modulus",), "free": ("contact_point", "baseline")}
    curve = hertz_curve(noise=2e-4, offset=0.004)
    return fit_curves([curve], elastic_scene(GUESS), settings_of("material.modulus", **options))


def test_an_elastic_fit_finds_modulus_and_contact_point_within_its_errors(elastic):
    modulus, contact, baseline = elastic.estimates
    assert abs(np.log(modulus.value / MODULUS)) < 3.0 * modulus.deviation
    assert 1e-4 < modulus.deviation < 0.02
    assert abs(contact.value - 0.004) < 3.0 * contact.deviation
    assert abs(baseline.value) < 3.0 * baseline.deviation
    assert elastic.goodness.explained
    assert elastic.scene.material.modulus == modulus.value


def test_the_profile_of_a_linear_problem_is_the_covariance_again(elastic):
    [profile], modulus = elastic.profiles, elastic.estimates[0]
    assert profile.low == pytest.approx(modulus.low, rel=0.1 * modulus.deviation)
    assert profile.high == pytest.approx(modulus.high, rel=0.1 * modulus.deviation)


def test_a_fit_in_python_prints_no_number_without_its_error(elastic, tmp_path):
    found = cc.Fit(elastic)
    assert "±" in repr(found)
    assert found["material.modulus"].low < found["material.modulus"].value
    with pytest.raises(SceneError, match="no parameter"):
        found["adhesion.work"]
    found.save(tmp_path)
    data = json.loads((tmp_path / "fit.json").read_text())
    assert all("deviation" in one for one in data["parameters"])
    assert data["goodness"]["degrees"] > 100
    assert data["question"] == elastic.question
    assert set(elastic.question) == {"curves", "first guess", "parameters"}
    assert read_scene(tmp_path / "scene.toml").material.modulus == pytest.approx(found.scene.material.modulus)
    page = (tmp_path / "index.html").read_text()
    assert "explains the data" in page
    assert (tmp_path / "fit.png").stat().st_size > 1000


def test_contact_lost_early_or_never_made_is_a_residual():
    curve = hertz_curve(noise=2e-4)
    scene = elastic_scene()
    model = CurveModel.of(curve, scene)
    parameters = ParameterSet((scene_parameter(scene, "loading.penetration=-1:1:linear"),))
    problem = FitProblem([model], parameters, "closed-form", None)
    assert np.sqrt(np.mean(problem.residuals(parameters.start) ** 2)) < 2.0
    never = problem.residuals(np.array([0.5]) / parameters.parameters[0].scale)
    kept = problem.compared[0]
    assert never[: kept.sum()] == pytest.approx((-curve.force / model.features.noise)[kept])


def test_a_value_that_no_scene_takes_is_a_residual_too():
    curve, scene = hertz_curve(noise=2e-4), elastic_scene()
    parameters = ParameterSet((scene_parameter(scene, "material.poisson"),))
    problem = FitProblem([CurveModel.of(curve, scene)], parameters, "closed-form", None)
    [prediction] = problem.predictions(
        [(0, ({"material.poisson": 0.7}, problem.parameters.of_curve(parameters.start, 0)[1]))]
    )
    assert "poisson" in prediction.failure
    assert not prediction.touching.any()


def test_an_interrupted_fit_has_its_best_point_and_goes_on_from_its_runs(tmp_path):
    curve, settings = hertz_curve(noise=2e-4), settings_of("material.modulus")
    said = []

    def stop(text):
        said.append(text)
        if len(said) == 3:
            raise KeyboardInterrupt

    with pytest.raises(InterruptedFit) as caught:
        fit_curves([curve], elastic_scene(GUESS), settings, store=Store(tmp_path), progress=stop)
    best = caught.value.result
    assert best is not None
    assert not best.converged
    assert np.isfinite(best.estimates[0].deviation)
    again = Store(tmp_path)
    found = fit_curves([curve], elastic_scene(GUESS), settings, store=again)
    assert again.taken_over >= 4
    assert found.converged
    fresh = fit_curves([curve], elastic_scene(GUESS), settings)
    assert found.estimates == fresh.estimates


def test_tied_numbers_keep_their_ratio_and_each_curve_may_have_its_own():
    scene = Scene(
        Material(1.0, 0.5, (Branch(3.0, 1.0),)), Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.03, 0.02),))
    )
    one = scene_parameter(scene, "material.modulus=0.1:10", ("material.branches[0].modulus",))
    own = scene_parameter(scene, "indenter.radius", (), (1, "b"))
    both = ParameterSet((one, own))
    values = both.of_curve(np.log([2.0, 5.0]), 1)[0]
    assert values == pytest.approx(
        {"material.modulus": 2.0, "material.branches[0].modulus": 6.0, "indenter.radius": 5.0}
    )
    assert "indenter.radius" not in both.of_curve(np.log([2.0, 5.0]), 0)[0]
    with pytest.raises(SceneError, match="varied twice"):
        ParameterSet((one, scene_parameter(scene, "material.branches[0].modulus")))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "material.modulos"], "material has no modulos"),
        (["--vary", "material.modulus=2:1"], "bounds"),
        (["--vary", "material.modulus=a:b"], "two finite numbers"),
        ([], "vary: is empty"),
        (["--vary", "material.modulus", "--free", "tilt"], "contact_point"),
        (["--vary", "material.modulus", "--check-solver", "x"], "--check-solver"),
        (["--vary", "material.modulus", "--tie", "indenter.radius=adhesion.work"], "is not varied"),
        (["--vary", "material.modulus", "--profile", "x", "--check-solver", "none"], "x is not varied"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_2(arguments, words, tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    files = str(tmp_path / "a.csv"), str(tmp_path / "scene.toml")
    assert main(["fit", *files, "--jobs", "1", "--solver", "closed-form", *arguments]) == 2
    said = capsys.readouterr().err.strip().split("\n")[-1]
    assert words in said
    assert said.startswith("crosscontact: error:")


def test_a_folder_of_another_fit_is_refused_and_that_of_the_same_is_not(tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    [curve], out = cc.read_curves(tmp_path / "a.csv"), tmp_path / "out"
    out.mkdir()
    asked = question([curve], elastic_scene(), settings_of("material.modulus"))
    (out / "fit.json").write_text(json.dumps({"question": asked}))
    renamed = question([replace(curve, name="b")], elastic_scene(), settings_of("material.modulus"))
    check_folder(out, renamed, elastic_scene())
    arguments = ["fit", str(tmp_path / "a.csv"), str(tmp_path / "scene.toml"), "--out", str(out)]
    assert main([*arguments, "--vary", "indenter.radius"]) == 2
    assert "holds another fit (other parameters)" in capsys.readouterr().err
    (out / "fit.json").write_text("{}")
    assert main([*arguments, "--vary", "material.modulus"]) == 2
    said = capsys.readouterr().err
    assert "not of a fit of this program; allowed: another folder, or --fresh" in said
    assert main([*arguments, "--vary", "material.modulos", "--fresh"]) == 2
    assert "material has no modulos" in capsys.readouterr().err


def test_a_first_guess_from_which_no_parameter_matters_is_refused():
    away = Loading("relaxed", 0.0, (Ramp(1.0, 1.0),))  # the first row of the record is out of contact
    scene = replace(elastic_scene(), loading=away, adhesion=Adhesion(1e-6, 1e-7))
    with pytest.raises(SceneError, match=r"no parameter changes the force at the first guess: \w+"):
        fit_curves([hertz_curve()], scene, settings_of("material.modulus"))


def test_means_of_rows_stand_in_the_report(monkeypatch):
    monkeypatch.setattr("validation.fits.decimation.MOST_ROWS", 60)
    found = fit_curves([hertz_curve(noise=2e-4)], elastic_scene(GUESS), settings_of("material.modulus"))
    assert "hertz: fitted are means of 2 rows" in statements(found)
    assert found.curves[0].curve.time.size == 60


def triangle(material, noise, rows=240, seed=3):
    """A record of Ting's triangle: pressed in for a time of one, pulled out as fast."""
    rate = 0.03
    time = np.linspace(-0.3, 2.3, rows)
    law = Ting(material, Sphere(1.0), rate, 1.0, rate)
    force = np.where(time > 0.0, law.force(np.maximum(time, 1e-9)), 0.0)
    force += noise * force.max() * np.random.default_rng(seed).standard_normal(rows)
    return MeasuredCurve(time - time[0], force, rate * (1.0 - np.abs(time - 1.0)), name="ting")


def visco(*branches):
    """A scene with these branches (modulus, time) over a relaxed modulus of one."""
    material = Material(1.0, 0.5, tuple(Branch(*one) for one in branches))
    return Scene(material, Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.03, 0.03), Ramp(-0.1, 0.03))))


BRANCH = ("material.modulus", "material.branches[0].modulus", "material.branches[0].time")


def test_one_branch_is_found_and_explains_its_own_curve():
    found = fit_curves([triangle(visco((4.0, 0.5)).material, 0.01)], visco((2.0, 1.0)), settings_of(*BRANCH))
    assert found.goodness.explained
    for one, truth in zip(found.estimates, (1.0, 4.0, 0.5), strict=True):
        assert abs(np.log(one.value / truth)) < 3.0 * one.deviation
        assert one.deviation < 0.2


def test_two_branches_fitted_with_one_are_seen():
    curve = triangle(visco((20.0, 0.03), (2.0, 1.0)).material, 0.003)
    found = fit_curves([curve], visco((3.0, 0.3)), settings_of(*BRANCH))
    assert not found.goodness.explained
    assert any("misses the shape" in text for text in statements(found))


def test_elastic_data_show_no_branch():
    found = fit_curves([hertz_curve(noise=2e-4)], visco((0.5, 0.5)), settings_of(*BRANCH))
    said = [text for text in statements(found) if text.startswith("material.branches[0]")]
    assert any("may be zero" in text for text in said), said
    assert found.goodness.explained


def test_adhesion_hysteresis_that_is_ignored_is_seen():
    scene = replace(visco((9.0, 1.0)), adhesion=Adhesion(7e-4, 0.013))
    curve = synthetic(scene, 0.01, resolution=4)
    guess = replace(scene, material=Material(3.0, 0.5))
    found = fit_curves([curve], guess, settings_of("adhesion.work", "material.modulus", starts=1))
    assert not found.goodness.explained
    assert found.goodness.runs[0].probability < 1e-6
    assert any("misses the shape" in text for text in statements(found))


@pytest.mark.slow
def test_weights_on_a_fixed_grid_are_fitted_and_their_regularisation_is_stated():
    curve = triangle(visco((4.0, 0.5)).material, 0.01)
    grid = settings_of("material.modulus", prony=(0.05, 0.5, 5.0), starts=1)
    found = fit_curves([curve], visco((2.0, 1.0)), grid)
    weights = [one.value for one in found.estimates[1:]]
    assert max(weights) == weights[1]
    assert found.goodness.explained
    page = document(found, drawings(found))
    assert "squared second differences of their logarithms, times 0.1" in str(page)


def test_a_record_of_the_stage_drives_the_stage_of_its_spring():
    curve = hertz_curve(noise=0.0)
    stage = curve.motion + curve.force / 2.0
    noisy = curve.force + 2e-4 * np.random.default_rng(0).standard_normal(curve.time.size)
    record = MeasuredCurve(curve.time, noisy, stage=stage, stiffness=2.0)
    found = fit_curves([record], elastic_scene(GUESS), settings_of("material.modulus"))
    [modulus] = found.estimates
    assert abs(np.log(modulus.value / MODULUS)) < 4.0 * modulus.deviation
    assert modulus.deviation < 0.01
    run_scene, _ = CurveModel.of(record, elastic_scene()).scene_of({})
    assert run_scene.machine == Machine(2.0)
    assert max(run_scene.loading.steps[0].values) == pytest.approx(stage.max(), rel=1e-2)


def spring_scene(stiffness, work=5e-4, modulus=0.9):
    """An elastic sphere that sticks, on a spring soft enough for contact to be lost in a jump."""
    stage = Table((0.0, 1.0, 6.0), (0.0, 0.05, -0.3))
    loading = Loading("jump-in", 0.0, (stage,), Machine(stiffness))
    return Scene(Material(modulus, 0.5), Sphere(1.0), loading, Adhesion(work, 1e-6))


SPRING_SEEDS = range(3)


@pytest.mark.parametrize("stiffness", [0.02, 0.2])
def test_on_a_soft_spring_adhesion_is_found_within_its_interval_snap_off_included(stiffness):
    truth = spring_scene(stiffness)
    inside = []
    for seed in SPRING_SEEDS:
        sampling = 0.0131 + 0.00037 * seed
        curve = synthetic(
            truth, 0.01, sampling, seed=seed, contact_point=3e-3, baseline=2e-4, solver="closed-form"
        )
        assert curve.stiffness == pytest.approx(stiffness)
        snap_off = np.abs(np.diff(curve.force)).max()
        assert snap_off > 0.7 * (2e-4 - curve.force.min())  # pull-off, all at once
        guess = spring_scene(stiffness, 7e-4, 0.7)
        options = settings_of("adhesion.work", "material.modulus", free=("contact_point", "baseline"))
        found = fit_curves([curve], guess, options)
        assert found.goodness.explained
        for one, at in zip(found.estimates, (5e-4, 0.9, 3e-3, 2e-4), strict=True):
            inside.append(one.low <= at <= one.high)
        lost = np.flatnonzero(found.curves[0].force < 0.5 * found.curves[0].force.min())[-1]
        assert abs(int(lost) - int(np.argmax(np.abs(np.diff(curve.force))))) <= 1
    assert sum(inside) >= len(inside) - 2  # 24 intervals of 95 %


def test_each_record_may_have_a_spring_of_its_own():
    springs = 0.2, 0.1
    curves = [
        replace(synthetic(spring_scene(k), 0.01, 0.0137, solver="closed-form"), name=f"{k}") for k in springs
    ]
    rigid = replace(spring_scene(1.0), loading=replace(spring_scene(1.0).loading, machine=None))
    options = settings_of("adhesion.work", per_curve=("machine.stiffness",), starts=1)
    found = fit_curves(curves, rigid, options)
    assert [one.start for one in found.estimates[1:]] == pytest.approx(springs)
    with pytest.raises(SceneError, match="the scene has no loading"):
        fit_curves(curves, rigid, settings_of("adhesion.work", "machine.stiffness"))
    tied = settings_of("adhesion.work", tie=("machine.stiffness=adhesion.work",), starts=1)
    assert fit_curves(curves[:1], spring_scene(0.1), tied).warnings == ()


def test_where_between_two_rows_contact_begins_and_ends_is_drawn():
    truth, places = spring_scene(0.2), []
    for seed in range(12):
        curve = synthetic(truth, 0.0, seed=seed, solver="closed-form")
        begin = np.flatnonzero(curve.force)[0]
        before, after = curve.position[begin - 1 : begin + 1]
        assert before < 0.0 <= after
        places.append(-before / (after - before))
    assert 0.3 < np.mean(places) < 0.7
    assert 0.1 < np.std(places) < 0.4  # of a uniform distribution 0.29


def test_the_spring_itself_may_be_varied_and_is_the_records_where_the_scene_has_none():
    truth = spring_scene(0.2)
    curve = synthetic(truth, 0.01, 0.0137, solver="closed-form")
    rigid = replace(truth, loading=replace(truth.loading, machine=None))
    found = fit_curves([curve], rigid, settings_of("machine.stiffness", "adhesion.work"))
    stiffness = found.estimates[0]
    assert stiffness.start == pytest.approx(0.2)
    assert stiffness.low <= 0.2 <= stiffness.high
    assert found.scene.machine.stiffness == stiffness.value
    other = replace(truth, loading=replace(truth.loading, machine=Machine(0.1)))
    found = fit_curves([curve], other, settings_of("adhesion.work", starts=1))
    assert any("0.2, not the scene's 0.1" in text for text in found.warnings)


@pytest.mark.parametrize(
    ("path", "words"),
    [("machine.stiffness", "not that of a stage"), ("loading.steps[0].rate", "measured motion takes")],
)
def test_numbers_that_play_no_part_are_refused(path, words):
    scene = elastic_scene()
    scene = replace(scene, loading=replace(scene.loading, machine=Machine(1.0)))
    with pytest.raises(SceneError, match=words):
        fit_curves([hertz_curve()], scene, settings_of("material.modulus", path))


@pytest.mark.exhaustive
def test_stated_intervals_hold_the_truth_about_as_often_as_they_say():
    inside = []
    for number in range(50):
        draw = np.random.default_rng([7, number])
        modulus, work = 0.9 * np.exp(draw.uniform(-0.5, 0.5)), 5e-4 * np.exp(draw.uniform(-0.7, 0.7))
        truth = Scene(Material(modulus, 0.5), Sphere(1.0), visco().loading, Adhesion(work, 1e-6))
        table = Table((0.0, 1.0, 3.0), (0.0, 0.03, -0.03))
        recorded = replace(truth, loading=Loading("jump-in", 0.0, (table,)))
        curve = synthetic(recorded, 0.01, seed=number, solver="closed-form")
        guess = replace(truth, material=Material(0.8, 0.5), adhesion=Adhesion(6e-4, 1e-6))
        options = settings_of("adhesion.work", "material.modulus", free=("baseline",))
        found = fit_curves([curve], guess, options)
        both = zip(found.estimates, (work, modulus), strict=False)
        inside += [one.low <= at <= one.high for one, at in both]
    assert 0.90 <= np.mean(inside) <= 0.99
