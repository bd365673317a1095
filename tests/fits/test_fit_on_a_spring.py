"""Fits of records of a stage that drives the indenter through a spring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.recorded import GUESS, MODULUS, elastic_scene, hertz_curve, settings_of

from contact_scene import (
    Adhesion,
    Loading,
    Machine,
    Material,
    Scene,
    SceneError,
    Sphere,
    Table,
)
from validation.fits.fit import fit_curves
from validation.fits.model import CurveModel
from validation.fits.record import MeasuredCurve
from validation.fits.synthetic import synthetic

pytestmark = pytest.mark.usefixtures("closed_form")


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
    with pytest.raises(SceneError, match="the scene has no machine"):
        fit_curves(curves, rigid, settings_of("adhesion.work", "machine.stiffness"))
    tied = settings_of("adhesion.work", tie=("machine.stiffness=adhesion.work",), starts=1)
    [said] = fit_curves(curves[:1], spring_scene(0.1), tied).warnings
    assert "half-space" in said


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
