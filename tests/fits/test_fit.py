"""Fits: what comes back of what was put in, and what a fit says of a model that is wrong."""

from __future__ import annotations

import json
import math
import signal
from dataclasses import replace

import numpy as np
import pytest
from support.recorded import DEPTH, GUESS, MODULUS, RATE, elastic_scene, hertz_curve, settings_of
from support.unlaid_figures import without_layout

import crosscontact as cc
from contact_scene import (
    Adhesion,
    Branch,
    Layer,
    Loading,
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
from crosscontact.fitting import FitWork
from validation.fits.fit import fit_curves
from validation.fits.model import NO_CONTACT, CurveModel, run_of
from validation.fits.page import document, draw_curves, statements
from validation.fits.parameters import FitSettings, first_guess, question, unknowns
from validation.fits.problem import FitProblem
from validation.fits.readers import write_csv
from validation.fits.record import MeasuredCurve
from validation.fits.result import InterruptedFit, correlation, covariance, independent
from validation.fits.synthetic import synthetic
from validation.reference.ting import Ting
from validation.runs.folder import claim
from validation.runs.process import interrupting
from validation.runs.store import Store

pytestmark = pytest.mark.usefixtures("closed_form")


def problem_of(curves, scene, settings):
    models = [CurveModel.of(curve, scene) for curve in curves]
    return FitProblem(models, unknowns(models, scene, settings), settings)


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
    assert profile["low"] == pytest.approx(modulus.low, rel=0.1 * modulus.deviation)
    assert profile["high"] == pytest.approx(modulus.high, rel=0.1 * modulus.deviation)


def test_a_fit_in_python_prints_no_number_without_its_error(elastic, tmp_path):
    found = cc.Fit(elastic)
    assert "±" in repr(found)
    assert found["material.modulus"].low < found["material.modulus"].value
    with pytest.raises(SceneError, match="no parameter"):
        found["adhesion.work"]
    with without_layout():
        found.save(tmp_path)
    data = json.loads((tmp_path / "fit.json").read_text())
    assert all("deviation" in one for one in data["parameters"])
    assert data["goodness"]["degrees"] > 100
    assert data["question"] == elastic.question
    assert set(elastic.question) == {"curves", "first guess", "parameters"}
    assert read_scene(tmp_path / "scene.toml").material.modulus == pytest.approx(found.scene.material.modulus)
    page = (tmp_path / "index.html").read_text()
    assert "posterior" not in page.lower()
    assert "explains the data" in page
    assert (tmp_path / "fit.png").stat().st_size > 1000


def background_of(curve):
    """What an instrument adds to a record: a level, 5 % of tilt, 0.5 % of drag."""
    reach, speed = np.ptp(curve.force), np.where(curve.time < 2.0, RATE, -RATE)
    return {"baseline": 0.3 * reach, "tilt": 0.05 * reach / DEPTH, "drag": 0.005 * reach / RATE}, speed


def test_a_background_is_found_beside_the_modulus_and_biases_it_without():
    """The whole of it is free of cost: as many parameters are searched as without."""
    inside = []
    for seed in range(5):
        curve = hertz_curve(noise=2e-4, seed=seed)
        parts, speed = background_of(curve)
        added = parts["baseline"] + parts["tilt"] * (curve.motion - curve.motion[0]) + parts["drag"] * speed
        recorded = replace(curve, force=curve.force + added)
        free = settings_of("material.modulus", free=("background",))
        found = fit_curves([recorded], elastic_scene(GUESS), free)
        truths = {"material.modulus": MODULUS} | {f"{name}@hertz": at for name, at in parts.items()}
        inside += [one.low <= truths[one.name] <= one.high for one in found.estimates]
    assert found.goodness.explained
    assert sum(inside) >= len(inside) - 3  # 20 intervals of 95 %
    level = settings_of("material.modulus", free=("baseline",), starts=1)
    [modulus, _] = fit_curves([recorded], elastic_scene(GUESS), level).estimates
    assert modulus.low > MODULUS


def test_a_wave_of_the_laser_on_the_baseline_is_part_of_the_background():
    time = np.linspace(0.0, 12.0, 600)
    motion = DEPTH - RATE * np.abs(time - 6.0)
    force = 4.0 / 3.0 * MODULUS / 0.75 * np.maximum(motion, 0.0) ** 1.5
    size = 0.01 * force.max()
    force += size * np.sin(2.0 * np.pi * motion / DEPTH) + 2e-5 * np.random.default_rng(0).standard_normal(
        600
    )
    curve = MeasuredCurve(time, force, motion, name="waved")
    waved, level = (
        fit_curves([curve], elastic_scene(GUESS), settings_of("material.modulus", free=(free,), starts=1))
        for free in ("background", "baseline")
    )
    found = {one.name: one for one in waved.estimates}
    assert found["material.modulus"].low < MODULUS < found["material.modulus"].high
    sizes = [found[f"wave_{name}@waved"].value for name in ("cosine", "sine")]
    assert np.hypot(*sizes) == pytest.approx(size, rel=0.2)
    assert waved.estimates[0].deviation < 0.5 * level.estimates[0].deviation


def test_parts_of_a_background_that_others_make_up_are_left_out():
    whole = hertz_curve(noise=2e-4)
    approach = whole.between(0, 60)  # at one speed: the drag is a level, the tilt a drift
    settings = settings_of("material.modulus", free=("background", "drift"))
    found = fit_curves([approach], elastic_scene(GUESS), settings)
    assert [one.name for one in found.estimates] == ["material.modulus", "baseline@hertz", "drift@hertz"]


def test_contact_lost_early_or_never_made_is_a_residual():
    curve = hertz_curve(noise=2e-4)
    problem = problem_of([curve], elastic_scene(), settings_of("loading.penetration=-1:1:linear"))
    assert np.sqrt(np.mean(problem.residuals(problem.start) ** 2)) < 2.0
    never = problem.residuals(np.array([0.5]) / problem.unknowns[0].scale)
    [model] = problem.models
    force = np.where(model.moments.compared, curve.force, 0.0)
    assert never[: curve.time.size] == pytest.approx(-force / model.moments.noise)


def test_rows_in_contact_for_one_side_only_are_masked_and_the_moment_of_the_loss_leads():
    truth = Scene(Material(0.9, 0.5), Sphere(1.0), visco().loading, Adhesion(5e-4, 1e-6))
    recorded = replace(truth, loading=Loading("jump-in", 0.0, (Table((0.0, 1.0, 3.0), (0.0, 0.03, -0.03)),)))
    problem = problem_of(
        [synthetic(recorded, 0.01, solver="closed-form")], truth, settings_of("adhesion.work")
    )
    for factor, sign in ((0.5, -1.0), (2.0, 1.0)):  # contact is lost early, or late
        [beside] = problem.curves_at(np.log([factor * 5e-4]))
        masked = ~beside.hold
        assert masked.sum() > 5
        assert not beside.values[masked].any()
        assert sign * beside.values[-1] > 10.0  # the moment of the loss
        assert problem.derivatives(np.log([factor * 5e-4]), following=True)[-1, 0] > 0.0


def test_a_measured_contact_radius_tells_the_sphere_from_its_modulus():
    """The force alone holds one number of both."""
    curve, scatter = hertz_curve(noise=2e-4), np.random.default_rng(1).standard_normal(120)
    radius = np.sqrt(np.maximum(curve.motion, 0.0)) + 1e-3 * scatter
    settings = settings_of("material.modulus", "indenter.radius", starts=1)
    found = fit_curves([replace(curve, contact_radius=radius)], elastic_scene(GUESS), settings)
    for one, truth in zip(found.estimates, (MODULUS, 1.0), strict=True):
        assert abs(np.log(one.value / truth)) < 4.0 * one.deviation
        assert one.deviation < 0.02
    [unknown, _] = fit_curves([curve], elastic_scene(GUESS), settings).combinations
    assert set(unknown.powers) == {"material.modulus", "indenter.radius"}


def test_a_smooth_force_that_leaves_a_quiet_baseline_has_no_moment():
    """It changes by eight deviations from row to row, yet jumps nowhere: a moment would mislead the model."""
    curve, free = hertz_curve(noise=1e-6, rows=80), ("contact_point",)
    found = fit_curves([curve], elastic_scene(GUESS), settings_of("material.modulus", free=free, starts=1))
    assert found.goodness.explained


def test_a_solver_that_refuses_one_of_two_curves_is_told_at_once(monkeypatch):
    """The other curve would be fitted, and what the first has to say would be missing."""

    def refused(scene, *asked):
        blunt = scene.indenter.radius == 2.0
        return replace(NO_CONTACT, failure="too blunt") if blunt else run_of(scene, *asked)

    monkeypatch.setattr("validation.fits.problem.run_of", refused)
    curves = [hertz_curve(name="a"), replace(hertz_curve(name="b"), indenter_radius=2.0)]
    with pytest.raises(SceneError, match="first guess: too blunt"):
        fit_curves(curves, elastic_scene(GUESS), settings_of("material.modulus"))


def test_a_value_that_no_scene_takes_is_a_residual_too():
    problem = problem_of([hertz_curve(noise=2e-4)], elastic_scene(), settings_of("material.poisson"))
    [beside] = problem.curves_at(np.array([0.7 / problem.unknowns[0].scale]))
    assert "poisson" in beside.failure
    assert not beside.touching.any()


def test_a_fit_says_that_it_moves_from_its_first_run_on():
    said = []
    settings = settings_of("material.modulus")
    fit_curves([hertz_curve(noise=2e-4)], elastic_scene(GUESS), settings, progress=said.append)
    assert said[0].endswith("run 1")
    assert any("misfit" in text for text in said)


def test_an_interrupted_fit_has_its_best_point_and_goes_on_from_its_runs(tmp_path):
    """By Ctrl-C; the errors of the best point need runs of their own."""
    curve, settings = hertz_curve(noise=2e-4), settings_of("material.modulus")
    said = []

    def stop(text):
        said.append(text)
        if len(said) == 6:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(InterruptedFit) as caught, interrupting(), without_layout():
        FitWork([curve], elastic_scene(GUESS), settings, tmp_path, None, stop).fit()
    best = caught.value.result
    assert best is not None
    assert not best.converged
    assert np.isfinite(best.estimates[0].deviation)
    [written] = json.loads((tmp_path / "fit.json").read_text())["parameters"]
    assert written["value"] == best.estimates[0].value
    assert "interrupted: the best so far" in (tmp_path / "index.html").read_text()
    again = Store(tmp_path)
    found = fit_curves([curve], elastic_scene(GUESS), settings, store=again)
    assert again.taken_over >= 4
    assert found.converged
    fresh = fit_curves([curve], elastic_scene(GUESS), settings)
    assert found.estimates == fresh.estimates


def test_tied_numbers_keep_their_ratio_and_each_curve_may_have_its_own():
    scene = replace(visco((3.0, 1.0)), loading=Loading("jump-in", 0.0, (Ramp(0.03, 0.02),)))
    tie = ("material.branches[0].modulus=material.modulus",)
    curves = [hertz_curve(name="a"), hertz_curve(name="b")]
    varied = settings_of("material.modulus=0.1:10", tie=tie, per_curve=("indenter.radius",))
    found = problem_of(curves, scene, varied)
    values = found.values(np.log([2.0, 4.0, 5.0]), 1)
    assert values == pytest.approx(
        {"material.modulus": 2.0, "material.branches[0].modulus": 6.0, "indenter.radius": 5.0}
    )
    assert found.values(np.log([2.0, 4.0, 5.0]), 0)["indenter.radius"] == pytest.approx(4.0)
    assert "indenter.radius" not in found.values(np.log([2.0, 4.0, 5.0]))
    with pytest.raises(SceneError, match="varied twice"):
        problem_of(curves, scene, replace(varied, vary=(*varied.vary, "material.branches[0].modulus")))


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
    assert any(f"after {2.6:.3g}" in text for text in statements(found))  # how long the record is


@pytest.mark.slow
def test_two_branches_fitted_with_one_are_seen_and_explain_the_share_that_is_asked_for():
    """Residuals of a wrong model are correlated, and deviations larger by the root of that length."""
    curve = triangle(visco((20.0, 0.03), (2.0, 1.0)).material, 0.003)
    settings = settings_of(*BRANCH, starts=1)
    found = fit_curves([curve], visco((3.0, 0.3)), settings)
    assert not found.goodness.explained
    assert any("misses the shape" in text for text in statements(found))
    assert any("missed most from time" in text for text in statements(found))
    assert found.curves[0].rows_correlated > 3.0
    within = fit_curves([curve], visco((3.0, 0.3)), replace(settings, within=0.03))
    assert within.goodness.explained
    assert within.goodness.rms_over_range < 0.03
    strict = fit_curves([curve], visco((3.0, 0.3)), replace(settings, within=0.001))
    assert not strict.goodness.explained


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
    assert found.goodness.runs_tests[0]["probability"] < 1e-6


@pytest.mark.slow
def test_further_starts_come_to_the_same_place():
    """Of a model that explains nothing; one of three points drawn singly would begin without contact."""
    scene = replace(visco((9.0, 1.0)), adhesion=Adhesion(7e-4, 0.013))
    guess = replace(scene, material=Material(3.0, 0.5))
    settings = settings_of("adhesion.work", "material.modulus", starts=3)
    found = fit_curves([synthetic(scene, 0.01, resolution=4)], guess, settings)
    assert len(found.starts) == 3
    assert max(found.starts) < 1.01 * min(found.starts)


def test_a_regularisation_without_weight_adds_no_residuals():
    """They would count as degrees of freedom, and rows that are met whatever the parameters."""
    curve, grid = triangle(visco((4.0, 0.5)).material, 0.01), (0.05, 0.5, 5.0, 50.0)
    sizes = {}
    for weight in (0.0, 0.1):
        settings = settings_of("material.modulus", prony=grid, regularisation=weight)
        asked = problem_of([curve], first_guess([curve], visco(), settings), settings)
        sizes[weight] = asked.residuals(asked.start).size
    assert sizes == {0.0: curve.time.size, 0.1: curve.time.size + 2}


@pytest.mark.slow
def test_weights_on_a_fixed_grid_are_fitted_and_their_regularisation_is_stated():
    curve = triangle(visco((4.0, 0.5)).material, 0.01)
    grid = settings_of(prony=(0.05, 0.5, 5.0), starts=1)
    found = fit_curves([curve], visco((2.0, 1.0)), grid)
    weights = [one.value for one in found.estimates]
    assert max(weights) == weights[1]
    assert found.goodness.explained
    page = document(found, draw_curves(found))
    assert "squared second differences of their logarithms, times 0.1" in str(page)


def test_many_curves_are_fitted_each_from_the_answer_before_it(tmp_path):
    curves = [hertz_curve(noise=2e-4, seed=seed, name=f"spot {seed}") for seed in range(3)]
    silent = replace(curves[0], force=0.0 * curves[0].force, name="nothing")
    asked = [curves[0], silent, *curves[1:]], elastic_scene(GUESS), settings_of("material.modulus")
    with without_layout():
        found = FitWork(*asked, tmp_path).each()
    starts = [one.result.estimates[0].start for one in found if one.result is not None]
    assert starts[0] == GUESS
    before = found[0].result.estimates[0].value, found[2].result.estimates[0].value
    assert starts[1:] == pytest.approx(before, rel=1e-12)
    assert "no contact" in found[1].failure
    import xarray

    data = xarray.load_dataset(tmp_path / "map.nc")
    modulus = data["value"].sel(parameter="material.modulus").values
    assert modulus[[0, 2, 3]] == pytest.approx(MODULUS, rel=0.05)
    assert np.isnan(modulus[1])
    assert data["explained"].values.tolist() == [1, 0, 1, 1]
    rows = (tmp_path / "table.csv").read_text().splitlines()
    assert rows[0].startswith("curve,material.modulus,material.modulus deviation")
    assert len(rows) == 5
    with pytest.raises(SceneError, match="no contact"):
        cc.fit_each(silent, elastic_scene(), "material.modulus", solver="closed-form")


def first_alone_and_all(curves, guess, settings):
    """A fit of curves, and the covariances at its best point of the first curve alone and of all."""
    problem = problem_of(curves, guess, settings)
    problem.search()
    point = problem.at(problem.best)
    slopes = problem.derivatives(problem.best) * independent(point)[:, None]
    return problem, *(covariance(slopes[:rows], 1.0)[0] for rows in (point[0].raw.size, None))


@pytest.mark.slow
def test_a_second_speed_fixes_the_zone_that_one_speed_leaves_open():
    """At one speed the zone and the relaxation time stand for each other."""
    truth = replace(visco((9.0, 1.0)), adhesion=Adhesion(7e-4, 0.013))
    curves = [
        synthetic(replace(truth, loading=Loading("jump-in", 0.0, (Ramp(0.03, v), Ramp(-0.5, v)))), 0.01)
        for v in (0.05, 0.005)
    ]
    wrong = replace(truth, adhesion=Adhesion(7e-4, 0.016), material=visco((9.0, 1.2)).material)
    settings = FitSettings(
        vary=("adhesion.zone", "adhesion.work", "material.branches[0].time"), check_solver=None, starts=1
    )
    problem, one, two = first_alone_and_all(curves, wrong, settings)
    assert one[0, 0] > 9.0 * two[0, 0]
    assert abs(problem.best[0] - math.log(0.013)) < 2.0 * math.sqrt(two[0, 0])


def test_a_file_is_read_with_the_options_of_the_reader(tmp_path, capsys):
    """Columns that nothing names, of millimetres and millinewtons."""
    curve = hertz_curve(noise=2e-4)
    rows = zip(1e3 * curve.force, 1e3 * curve.motion, curve.time, strict=True)
    (tmp_path / "a.txt").write_text("\n".join(",".join(map(repr, map(float, row))) for row in rows))
    write_scene(elastic_scene(GUESS), tmp_path / "scene.toml")
    asked = ["fit", str(tmp_path / "a.txt"), str(tmp_path / "scene.toml"), "--solver", "closed-form"]
    asked += ["--vary", "material.modulus", "--check-solver", "none", "--jobs", "1"]
    columns = "time=3,penetration=2:1e-3,force=1:1e-3"
    assert main([*asked, "--columns", columns]) == 0
    assert "material.modulus" in capsys.readouterr().out
    assert main([*asked, "--columns", columns, "--segment", "pause"]) == 2
    assert "has no pause" in capsys.readouterr().err


def test_a_folder_of_another_fit_is_refused_and_that_of_the_same_is_not(tmp_path, capsys):
    write_csv(hertz_curve(), tmp_path / "a.csv")
    write_scene(elastic_scene(), tmp_path / "scene.toml")
    [curve], out = cc.read_curves(tmp_path / "a.csv"), tmp_path / "out"
    out.mkdir()
    claim(out, "a fit", question([curve], elastic_scene(), settings_of("material.modulus")))
    (out / "fit.json").write_text("{}")
    renamed = question([replace(curve, name="b")], elastic_scene(), settings_of("material.modulus"))
    claim(out, "a fit", renamed)
    arguments = ["fit", str(tmp_path / "a.csv"), str(tmp_path / "scene.toml"), "--out", str(out)]
    assert main([*arguments, "--vary", "indenter.radius"]) == 2
    assert "holds a fit (other parameters)" in capsys.readouterr().err
    with pytest.raises(
        SceneError, match=r"out: .* holds a fit \(other parameters\); allowed: another folder$"
    ):
        cc.fit(curve, elastic_scene(), ["indenter.radius"], solver="closed-form", check_solver=None, out=out)
    assert main([*arguments, "--vary", "material.modulos", "--fresh"]) == 2
    assert "material has no modulos" in capsys.readouterr().err


def test_means_of_rows_stand_in_the_report(monkeypatch):
    monkeypatch.setattr("validation.fits.fit.MOST_ROWS", 60)
    found = fit_curves([hertz_curve(noise=2e-4)], elastic_scene(GUESS), settings_of("material.modulus"))
    assert "hertz: fitted are means of 2 rows" in statements(found)
    assert found.curves[0].curve.time.size == 60


def bead_on_gel(radius, depth, adhesion=None):
    loading = Loading("relaxed", 0.0, (Ramp(depth, 1.0), Ramp(-3.0 * depth, 1.0)))
    return Scene(Material(1e-3, 0.5), Sphere(radius), loading, adhesion, body=Layer(5.0, "bonded"))


ON_GEL = FitSettings(vary=("material.modulus", "body.thickness"), check_solver=None, starts=1)


def guess_of(truth):
    """A modulus and a thickness that are a tenth too large."""
    return replace(truth, material=Material(1.1e-3, 0.5), body=Layer(5.5, "bonded"))


@pytest.mark.slow
def test_modulus_thickness_and_work_from_one_record_of_a_bead_that_adheres():
    truth = bead_on_gel(5.0, 1.0, Adhesion(1e-4, 0.06))
    settings = replace(ON_GEL, vary=(*ON_GEL.vary, "adhesion.work"))
    found = fit_curves([synthetic(truth, 0.01, 0.02)], guess_of(truth), settings)
    for one, value in zip(found.estimates, (1e-3, 5.0, 1e-4), strict=True):
        assert abs(math.log(one.value / value)) < 4.0 * one.deviation
        assert one.deviation < 0.02
    assert found.correlations[0, 1] > 0.9


@pytest.mark.slow
def test_a_small_bead_beside_the_large_one_tells_modulus_from_thickness():
    truth = bead_on_gel(5.0, 1.0)
    large, small = synthetic(truth, 0.01, 0.04), synthetic(bead_on_gel(0.5, 0.2), 0.01, 0.008)
    curves = [large, replace(small, name="small", indenter_radius=0.5)]
    problem, alone, both = first_alone_and_all(curves, guess_of(truth), ON_GEL)
    assert correlation(alone)[0, 1] > 0.98 > 0.9 > correlation(both)[0, 1]
    assert (np.diag(alone) > np.array([16.0, 9.0]) * np.diag(both)).all()
    off = np.abs(problem.best - np.log([1e-3, 5.0]))
    assert (off < 4.0 * np.sqrt(np.diag(both))).all()
