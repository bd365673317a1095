"""Fits by the reference beside fits of the same data by closed forms that are written here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, least_squares

from contact_scene import (
    Adhesion,
    Branch,
    Force,
    Hold,
    Loading,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
)
from validation.fits.fit import fit_curves
from validation.fits.model import moments
from validation.fits.parameters import FitSettings
from validation.fits.record import MeasuredCurve
from validation.fits.synthetic import synthetic
from validation.reference.ting import Ting

LOADING = Loading("jump-in", 0.0, (Ramp(0.03, 0.03), Ramp(-0.1, 0.03)))


def jkr_force(motion, plane_modulus, work):
    """Johnson, Kendall and Roberts' sphere of radius 1 at a penetration, on the stable branch."""
    pull = np.sqrt(2.0 * np.pi * work / plane_modulus)
    lowest = (pull / 4.0) ** (2.0 / 3.0)  # where dD/da = 2 a - pull/(2 sqrt(a)) is zero

    def force(depth):
        a = brentq(lambda a: a * a - pull * np.sqrt(a) - depth, lowest, 1.0, xtol=1e-15)
        return 4.0 / 3.0 * plane_modulus * a**3 - np.sqrt(8.0 * np.pi * plane_modulus * work * a**3)

    return np.array([force(depth) for depth in motion])


def lowest_penetration(plane_modulus, work):
    """Where that sphere loses its contact: the least of ``a^2 - s sqrt(a)``."""
    pull = np.sqrt(2.0 * np.pi * work / plane_modulus)
    return -0.75 * pull * (pull / 4.0) ** (1.0 / 3.0)


@pytest.mark.slow
def test_an_elastic_jkr_fit_agrees_with_the_closed_form_to_1e_4():
    modulus, work = 1.2, 6e-4
    time = np.linspace(0.0, 2.6, 200)
    motion = 0.03 * (1.0 - np.abs(time - 1.1))
    lowest = lowest_penetration(modulus, work)
    contact = (motion >= 0.0) | ((time > 1.1) & (motion >= lowest))
    exact = np.zeros(time.size)
    exact[contact] = jkr_force(motion[contact], modulus, work)
    force = exact + 1e-2 * -exact.min() * np.random.default_rng(0).standard_normal(time.size)
    curve = MeasuredCurve(time, force, motion)

    seen = moments(curve)
    rows = seen.compared & contact
    assert seen.pull_off is not None

    def residuals(x):
        plane_modulus, of_adhesion = np.exp(x)
        lost = 2.1 - lowest_penetration(plane_modulus, of_adhesion) / 0.03
        moment = (lost - seen.pull_off.time) / seen.pull_off.deviation
        return np.append(
            (jkr_force(motion[rows], plane_modulus, of_adhesion) - force[rows]) / seen.noise, moment
        )

    closed = least_squares(residuals, np.log([modulus, work]), xtol=1e-12)
    guess = Scene(Material(0.75 * 1.4, 0.5), Sphere(1.0), LOADING, Adhesion(4e-4, 1e-7))
    settings = FitSettings(vary=("adhesion.work", "material.modulus"), check_solver=None, resolution=8)
    found = fit_curves([replace(curve, noise=seen.noise)], guess, settings)
    fitted = np.log([found.estimates[1].value / 0.75, found.estimates[0].value])
    assert np.abs(fitted - closed.x).max() < 1e-4
    assert found.goodness.explained


@pytest.mark.exhaustive
def test_an_adhesionless_fit_agrees_with_a_fit_of_tings_model():
    truth = Scene(Material(1.0, 0.5, (Branch(4.0, 0.5),)), Sphere(1.0), LOADING)
    curve = synthetic(truth, 0.01, sampling=0.02)
    first = int(np.argmax(curve.motion > 0.0))
    time = curve.time - curve.time[first] + curve.motion[first] / 0.03
    guess = replace(truth, material=Material(1.2, 0.5, (Branch(3.0, 0.7),)))

    def residuals(x):
        modulus, branch, relaxation = np.exp(x)
        law = Ting(Material(modulus, 0.5, (Branch(branch, relaxation),)), Sphere(1.0), 0.03, 1.0, 0.03)
        force = np.where(time > 0.0, law.force(np.maximum(time, 1e-9)), 0.0)
        return (force - curve.force) / moments(curve).noise

    ting = least_squares(residuals, np.log([1.2, 3.0, 0.7]), diff_step=1e-3)
    paths = ("material.modulus", "material.branches[0].modulus", "material.branches[0].time")
    found = fit_curves([curve], guess, FitSettings(vary=paths, check_solver=None))
    for one, other in zip(found.estimates, np.exp(ting.x), strict=True):
        assert abs(np.log(one.value / other)) < 0.1 * one.deviation
    assert found.goodness.explained


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [None, 0.05])
def test_a_curve_of_an_approach_to_a_force_turns_where_hertz_has_that_force(stiffness):
    level, rate, dwell = 2e-3, 0.02, 0.3
    steps = (Ramp(1.0, rate, until_force=level), Hold(dwell), Ramp(-0.02, rate))
    truth = Scene(Material(0.75, 0.5), Sphere(1.0), Loading("jump-in", 0.0, steps))
    curve = synthetic(truth, 0.0, 0.01, contact_point=0.003, stiffness=stiffness, resolution=4)
    depth = (0.75 * level) ** (2.0 / 3.0)
    turn = depth + (0.0 if stiffness is None else level / stiffness)
    assert curve.position.max() - 0.003 == pytest.approx(turn, rel=1e-6)
    assert curve.force.max() == pytest.approx(level, rel=1e-6)
    resting = curve.time[curve.position > curve.position.max() - 1e-12]
    assert np.ptp(resting) == pytest.approx(dwell, abs=0.011)
    assert curve.force[curve.position < 0.002].max() == 0.0  # before contact, and after it


def test_a_curve_whose_contact_is_lost_goes_on_along_the_step_that_waits_for_a_level():
    steps = (Ramp(0.02, 0.02), Ramp(-0.1, 0.02, until_force=-1.0), Ramp(0.1, 0.02))
    truth = Scene(Material(0.75, 0.5), Sphere(1.0), Loading("jump-in", 0.0, steps), Adhesion(5e-4, 1e-3))
    curve = synthetic(truth, 0.0, 0.02, resolution=4)
    after = curve.position[np.flatnonzero(curve.force)[-1] + 1 :]
    assert len(after) > 5
    assert np.all(np.diff(after) < 0.0)


def test_a_curve_is_refused_where_a_step_prescribes_the_force():
    loading = Loading("jump-in", 0.0, (Ramp(0.02, 0.02, until_force=1e-3), Force(1e-3, 1.0)))
    with pytest.raises(SceneError, match="do not prescribe the penetration"):
        synthetic(Scene(Material(0.75, 0.5), Sphere(1.0), loading))


@pytest.mark.parametrize(
    "given",
    [{"solver": "magic"}, {"seed": 1.5}, {"baseline": None}, {"drift": "0"}, {"contact_point": None}],
    ids=str,
)
def test_what_a_curve_cannot_be_made_with_is_one_line(given):
    scene = Scene(Material(0.75, 0.5), Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.02, 0.02),)))
    with pytest.raises(SceneError, match=f"^{next(iter(given))}: .*got"):
        synthetic(scene, **given)
