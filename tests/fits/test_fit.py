"""Fits: what comes back of what was put in, and what a fit says of a model that is wrong."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.recorded import GUESS, MODULUS, elastic_scene, hertz_curve, settings_of
from support.unlaid_figures import without_layout

import crosscontact as cc
from contact_scene import (
    Adhesion,
    Branch,
    Loading,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Table,
    read_scene,
)
from crosscontact.fitting import fit_and_write
from validation.fits.curve_model import CurveModel
from validation.fits.fit import fit_curves
from validation.fits.fit_result import InterruptedFit
from validation.fits.page import document, drawings, statements
from validation.fits.parameters import ParameterSet, scene_parameter
from validation.fits.problem import FitProblem
from validation.fits.record import MeasuredCurve
from validation.fits.synthetic import synthetic
from validation.reference.ting import Ting
from validation.runs.store import Store

pytestmark = pytest.mark.usefixtures("closed_form")


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


@pytest.mark.slow
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

    with pytest.raises(InterruptedFit) as caught, without_layout():
        fit_and_write([curve], elastic_scene(GUESS), settings, tmp_path, None, stop)
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


@pytest.mark.slow
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
