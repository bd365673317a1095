"""Posteriors: intervals of walkers where those of the least squares hold, and runs in batches."""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from numpy.linalg import norm
from numpy.testing import assert_allclose
from support.recorded import GUESS, elastic_scene, hertz_curve, settings_of
from support.unlaid_figures import without_layout

import crosscontact as cc
from contact_scene import Adhesion, Branch, Hold, Loading, Material, Ramp, Scene, SceneError, Sphere, Table
from contact_scene.scene import with_values
from validation.fits import posterior, problem
from validation.fits.fit import fit_curves
from validation.fits.model import CurveModel, run_of
from validation.fits.problem import (
    ERROR_SHARE,
    TOLERANCES,
    BatchProblem,
    FitProblem,
    FitSettings,
    as_ramps,
    unknowns,
)
from validation.fits.result import rms
from validation.fits.synthetic import synthetic
from validation.reference import batch
from validation.reference.batch import solve

WORK, ZONE = "adhesion.work", "adhesion.zone"


@pytest.fixture
def few_samples(monkeypatch):
    """Intervals to a third of a deviation."""
    pytest.importorskip("emcee", reason="the optional extra `fit` is not installed")
    for name, value in (("WALKERS", 16), ("CHECKED", 50), ("ENOUGH", 50)):
        monkeypatch.setattr(posterior, name, value)


def test_intervals_of_a_nearly_linear_fit_are_those_of_the_least_squares(closed_form, few_samples, tmp_path):
    settings = settings_of("material.modulus", free=("contact_point", "baseline"), posterior=True)
    found = fit_curves([hertz_curve(noise=2e-4, offset=0.004)], elastic_scene(GUESS), settings)
    assert found.posterior is not None
    assert found.posterior.solver == "closed-form"
    for one in found.estimates[:2]:
        sampled, size = found.posterior.intervals[one.name], (one.high - one.low) / 3.92
        for end, at in (("low", one.low), ("median", one.value), ("high", one.high)):
            assert sampled[end] == pytest.approx(at, abs=0.7 * size)
    with without_layout():
        cc.Fit(found).save(tmp_path)
    written = json.loads((tmp_path / "fit.json").read_text())["posterior"]
    assert written["intervals"] == found.posterior.intervals
    assert "samples" not in written
    assert "posterior from" in (tmp_path / "index.html").read_text()


def retraction(rate=0.02, work=5e-4, zone=0.013):
    """A relaxed contact pulled off at one speed."""
    loading = Loading("relaxed", 0.02, (Ramp(-0.3, rate),))
    return Scene(Material(0.75, 0.5, (Branch(6.75, 1.0),)), Sphere(1.0), loading, Adhesion(work, zone))


def problem_of(scene, tolerance=4e-5):
    settings = FitSettings(vary=(WORK, ZONE), check_solver=None)
    models = [CurveModel.of(synthetic(scene, 0.01), scene)]
    return FitProblem(models, unknowns(models, scene, settings), settings, tolerance=tolerance)


def test_a_retraction_is_solved_in_batches_as_the_reference_solves_it():
    asked = problem_of(retraction())
    x = asked.unknowns.start
    together = BatchProblem.of(asked)
    assert together is not None
    points = [x + shift for shift in np.random.default_rng(0).normal(0.0, 0.1, (4, 2))]
    for point, own in zip(points, together.all_at(points), strict=True):
        assert rms(own.residuals - asked.residuals(point)) < ERROR_SHARE * (1.0 + rms(own.residuals))
    assert together.runs == 7  # with the first guess and its two differences
    resting = replace(retraction().loading, steps=(Hold(0.5), Ramp(-0.3, 0.02)))
    rested = problem_of(replace(retraction(), loading=resting))
    by_batch = BatchProblem.of(rested)
    assert by_batch is not None
    x = rested.unknowns.start
    assert rms(by_batch.residuals(x) - rested.residuals(x)) < ERROR_SHARE


@pytest.mark.parametrize("quick", [False, True])
def test_derivatives_are_those_of_fine_runs(quick):
    """Before the edge sets off steps are long, behind it short, and the force bends between them: where that
    was missed a derivative was up to four times as large, and the deviation of the zone a quarter."""
    asked = problem_of(retraction(0.0385757, 7.2147e-4, 0.0101565), TOLERANCES[0])
    fine = replace(asked, tolerance=TOLERANCES[-1])
    asked.quick = BatchProblem.of(asked) if quick else None
    x = asked.unknowns.start
    assert_allclose(norm(asked.jacobian(x), axis=0), norm(fine.jacobian(x), axis=0), rtol=0.01)


def test_a_long_step_before_the_edge_sets_off_does_not_see_what_is_behind_it():
    """Rows of a batch are three times as long as those of the reference there."""
    asked = problem_of(retraction(0.0099, 4.444e-4, 0.01094))
    together, fine = BatchProblem.of(asked), replace(asked, tolerance=TOLERANCES[-1])
    assert together is not None
    x = asked.unknowns.start
    assert np.abs(together.residuals(x) - fine.residuals(x)).max() < ERROR_SHARE


def test_a_search_in_batches_ends_with_the_reference(monkeypatch):
    """A batch solver whose forces are wrong by a noise or so misleads the search and not the fit."""
    runs, scene = [], retraction()
    curve, guess = synthetic(scene, 0.01), with_values(scene, {WORK: 6e-4, ZONE: 0.01})

    def counted(*arguments):
        runs.append(1)
        return run_of(*arguments)

    def fitted():
        runs.clear()
        found = fit_curves([curve], guess, FitSettings(vary=(WORK, ZONE), check_solver=None))
        return found.estimates, len(runs), found.runs

    monkeypatch.setattr(problem, "run_of", counted)
    plain, few, all_runs = fitted()
    assert few < all_runs / 2
    monkeypatch.setattr(batch, "solve", lambda scenes: [wrong(one) for one in solve(scenes)])
    misled = fitted()[0]
    monkeypatch.setattr(BatchProblem, "of", lambda given: None)
    alone, count, _ = fitted()
    assert few < count
    for one, other, third in zip(plain, misled, alone, strict=True):
        assert_allclose([one.value, other.value], third.value, rtol=0.1 * third.deviation)
        assert_allclose([one.deviation, other.deviation], third.deviation, rtol=0.02)


def wrong(answer):
    return replace(answer, force=1.03 * answer.force)


def test_a_table_of_a_motion_is_its_ramps():
    def driven(*values):
        return replace(retraction(), loading=Loading("relaxed", 0.25, (Table((1.0, 2.0, 6.0), values),)))

    assert as_ramps(driven(0.25, 0.5, -0.5)).loading.steps == (Ramp(0.5, 0.25), Ramp(-0.5, 0.25))
    assert as_ramps(driven(0.25, 0.25, -0.5)).loading.steps == (Hold(1.0), Ramp(-0.5, 0.1875))


def test_a_posterior_that_takes_too_long_is_told_and_costs_no_fit(closed_form, few_samples, monkeypatch):
    monkeypatch.setattr(posterior, "AFFORDABLE", 0.0)
    settings = settings_of("material.modulus", posterior=True)
    found = fit_curves([hertz_curve(noise=2e-4)], elastic_scene(GUESS), settings)
    assert found.posterior is None
    assert found.goodness.explained
    assert any("points by closed-form take up to" in text for text in found.warnings)


def test_without_its_package_a_posterior_is_refused_at_once(closed_form, monkeypatch):
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(SceneError, match="emcee is not installed"):
        fit_curves([hertz_curve()], elastic_scene(), settings_of("material.modulus", posterior=True))
