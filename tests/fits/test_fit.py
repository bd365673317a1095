"""Fits: what comes back of what was put in, and what a fit says of a model that is wrong."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.recorded import MODULUS, elastic_scene, hertz_curve

import crosscontact as cc
from contact_scene import (
    Branch,
    Loading,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    read_scene,
    write_scene,
)
from crosscontact.cli import main
from validation.execution.store import Store
from validation.fits.curve_files import write_csv
from validation.fits.curve_model import CurveModel
from validation.fits.fit import FitSettings, InterruptedFit, fit_curves
from validation.fits.parameters import ParameterSet, scene_parameter
from validation.fits.problem import FitProblem

GUESS = 1.3 * MODULUS


def fitted(**options):
    settings = {"vary": ("material.modulus",), "free": ("contact_point",), "check_solver": None} | options
    curve = hertz_curve(noise=2e-4, offset=0.004)
    return fit_curves([curve], elastic_scene(GUESS), FitSettings(**settings))


@pytest.fixture(scope="module")
def elastic():
    return fitted(profile=("material.modulus",), free=("contact_point", "baseline"), check_solver="reference")


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
    assert read_scene(tmp_path / "scene.toml").material.modulus == pytest.approx(found.scene.material.modulus)
    page = (tmp_path / "index.html").read_text()
    assert "explains the data" in page
    assert (tmp_path / "fit.png").stat().st_size > 1000


def test_contact_lost_early_or_never_made_is_a_residual():
    curve = hertz_curve(noise=2e-4)
    scene = elastic_scene()
    model = CurveModel.of(curve, scene)
    parameters = ParameterSet((scene_parameter(scene, "loading.penetration=-1:1:linear"),))
    problem = FitProblem([model], parameters, "reference", None, 1.6e-4)
    assert np.sqrt(np.mean(problem.residuals(parameters.start) ** 2)) < 2.0
    never = problem.residuals(np.array([0.5]) / parameters.parameters[0].scale)
    kept = problem.compared[0]
    assert never[: kept.sum()] == pytest.approx((-curve.force / model.features.noise)[kept])


def test_a_value_that_no_scene_takes_is_a_residual_too():
    curve, scene = hertz_curve(noise=2e-4), elastic_scene()
    parameters = ParameterSet((scene_parameter(scene, "material.poisson"),))
    problem = FitProblem([CurveModel.of(curve, scene)], parameters, "reference", None, 1.6e-4)
    [prediction] = problem.predictions(
        [(0, ({"material.poisson": 0.7}, problem.parameters.of_curve(parameters.start, 0)[1]))]
    )
    assert "poisson" in prediction.failure
    assert not prediction.touching.any()


def test_an_interrupted_fit_has_its_best_point_and_goes_on_from_its_runs(tmp_path):
    curve, settings = hertz_curve(noise=2e-4), FitSettings(vary=("material.modulus",), check_solver=None)
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
    assert (
        main(["fit", str(tmp_path / "a.csv"), str(tmp_path / "scene.toml"), "--jobs", "1", *arguments]) == 2
    )
    said = capsys.readouterr().err.strip().split("\n")[-1]
    assert words in said
    assert said.startswith("crosscontact: error:")
