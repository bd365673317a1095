"""Posteriors: intervals of walkers where those of the least squares hold, and runs in batches."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.linalg import norm
from numpy.testing import assert_allclose, assert_array_equal
from support.recorded import GUESS, elastic_scene, hertz_curve, settings_of
from support.unlaid_figures import without_layout

import crosscontact as cc
from contact_scene import Adhesion, Branch, Hold, Loading, Material, Ramp, Scene, SceneError, Sphere, Table
from validation.fits import posterior, problem
from validation.fits.fit import fit_curves
from validation.fits.model import CurveModel, FitRun, rms, run_of
from validation.fits.parameters import FitSettings, unknowns
from validation.fits.problem import ERROR_SHARE, TOLERANCES, FitProblem, as_ramps
from validation.fits.result import InterruptedFit
from validation.fits.synthetic import synthetic
from validation.reference import batch
from validation.reference.batch import solve
from validation.runs.store import Store

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
    x = asked.start
    together = asked.in_batches()
    assert together is not None
    points = [x + shift for shift in np.random.default_rng(0).normal(0.0, 0.1, (4, 2))]
    for point in points:
        own = together.residuals(point)
        assert rms(own - asked.residuals(point)) < ERROR_SHARE * (1.0 + rms(own))
    assert together.runs == 15  # of five points with two differences each
    resting = replace(retraction().loading, steps=(Hold(0.5), Ramp(-0.3, 0.02)))
    rested = problem_of(replace(retraction(), loading=resting))
    by_batch = rested.in_batches()
    assert by_batch is not None
    x = rested.start
    assert rms(by_batch.residuals(x) - rested.residuals(x)) < ERROR_SHARE


SHARP = retraction(0.0385757, 7.2147e-4, 0.0101565)


@cache
def fine_derivatives():
    fine = problem_of(SHARP, TOLERANCES[-1])
    return norm(fine.derivatives(fine.start, following=True), axis=0)


@pytest.mark.parametrize("quick", [False, True])
def test_derivatives_are_those_of_fine_runs(quick):
    """Before the edge sets off steps are long, behind it short, and the force bends between them: where that
    was missed a derivative was up to four times as large, and the deviation of the zone a quarter."""
    asked = problem_of(SHARP, TOLERANCES[0])
    if quick:
        asked.quick, asked.trusted = asked.in_batches(), True
    slopes = norm(asked.derivatives(asked.start, following=True), axis=0)
    assert_allclose(slopes, fine_derivatives(), rtol=0.01)


def test_a_long_step_before_the_edge_sets_off_does_not_see_what_is_behind_it():
    """Rows of a batch are three times as long as those of the reference there."""
    asked = problem_of(retraction(0.0099, 4.444e-4, 0.01094))
    together, fine = asked.in_batches(), replace(asked, tolerance=TOLERANCES[-1])
    assert together is not None
    x = asked.start
    assert np.abs(together.residuals(x) - fine.residuals(x)).max() < ERROR_SHARE


@pytest.mark.slow
def test_a_search_in_batches_ends_with_the_reference(monkeypatch):
    """A batch solver whose forces are wrong by a noise or so misleads the search and not the fit: the
    reference carries out all of it, its further starts included."""
    runs, curve, guess = [], synthetic(retraction(), 0.01), retraction(work=6e-4, zone=0.03)

    def counted(*arguments):
        runs.append(1)
        return run_of(*arguments)

    def fitted():
        runs.clear()
        found = fit_curves([curve], guess, FitSettings(vary=WORK, starts=2, check_solver=None))
        return found, found.estimates[0], len(runs)

    monkeypatch.setattr(problem, "run_of", counted)
    plain, one, few = fitted()
    assert few < plain.runs / 2
    monkeypatch.setattr(batch, "solve", lambda scenes: [wrong(one) for one in solve(scenes)])
    misled, other, _ = fitted()
    monkeypatch.setattr(FitProblem, "in_batches", lambda one: None)
    alone, third, count = fitted()
    assert few < count
    assert len(alone.starts) == 2
    assert_allclose(misled.starts, alone.starts, rtol=1e-5)
    assert_allclose([one.value, other.value], third.value, rtol=0.1 * third.deviation)
    assert_allclose([one.deviation, other.deviation], third.deviation, rtol=0.02)


def wrong(answer, by=1.03):
    return replace(answer, force=by * answer.force)


def test_batches_agree_if_they_move_no_parameter(monkeypatch):
    """Forces that are 0.05 % too large differ by a thirtieth of the noise, and move both by a third of their
    deviations or more."""
    asked = problem_of(retraction())
    x = asked.start
    assert asked.agrees(asked.in_batches(), x)
    monkeypatch.setattr(batch, "solve", lambda scenes: [wrong(one, 1.0005) for one in solve(scenes)])
    misled = asked.in_batches()
    assert rms(misled.residuals(x) - asked.residuals(x)) < ERROR_SHARE
    assert not asked.agrees(misled, x)


def test_no_point_of_a_profile_is_the_best_of_an_interrupted_fit(monkeypatch):
    """Batches, which profiles are made of, may see a smaller sum of squares than the reference."""
    monkeypatch.setattr(FitProblem, "agrees", lambda *_: True)
    plain = FitProblem.residuals
    less = lambda one, x: (0.9 if one.batched else 1.0) * plain(one, x)  # noqa: E731
    monkeypatch.setattr(FitProblem, "residuals", less)
    asked = [synthetic(retraction(), 0.01)], retraction(work=6e-4)
    settings = FitSettings(vary=(WORK, ZONE), check_solver=None)

    def stop(text):
        if text.startswith("profile"):
            raise KeyboardInterrupt

    store = Store(in_memory=True)  # the fits ask for the same runs of the reference
    with pytest.raises(InterruptedFit) as caught:
        fit_curves(*asked, replace(settings, profile=WORK), progress=stop, store=store)
    assert caught.value.result.estimates == fit_curves(*asked, settings, store=store).estimates
    assert store.taken_over > 0


def test_an_edge_at_rest_but_for_rounding_sets_off_nowhere():
    time = np.linspace(0.0, 1.0, 30) ** 2
    force, at = np.exp(-time), np.linspace(0.0, 1.0, 100)
    radius = 1.0 + 1e-15 * np.random.default_rng(0).uniform(-1.0, 1.0, time.size)
    still, jittering = (FitRun(time, force, one, time) for one in (np.ones(time.size), radius))
    assert_array_equal(jittering.values(force, at), still.values(force, at))
    assert FitRun(0.0 * time, force, radius, time).corners.size == 0  # rows of a jump, were they 100,000


def test_a_table_of_a_motion_is_its_ramps():
    def driven(*values, times=(1.0, 2.0, 6.0)):
        return replace(retraction(), loading=Loading("relaxed", 0.25, (Table(times, values),)))

    assert as_ramps(driven(0.25, 0.5, -0.5)).loading.steps == (Ramp(0.5, 0.25), Ramp(-0.5, 0.25))
    assert as_ramps(driven(0.25, 0.25, -0.5)).loading.steps == (Hold(1.0), Ramp(-0.5, 0.1875))
    slow = driven(0.0, 1.0, 1.0 + 0.9e-6, top := 1.0 + 1.8e-6, 1.0, times=(0.0, 1.0, 2.0, 3.0, 4.0))
    assert as_ramps(slow).loading.steps == (Ramp(1.0, 1.0), Hold(1.0), Ramp(top, top - 1), Ramp(1.0, top - 1))


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
