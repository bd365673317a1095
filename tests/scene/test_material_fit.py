"""Measured moduli to a Prony series: known series come back, misfit and dropped branches are what is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import gamma

from contact_scene import Branch, Material, SceneError
from contact_scene.prony import MOST_ROWS, DynamicData, RelaxationData, fit_prony

TIMES = np.geomspace(1e-3, 1e3, 61)
KNOWN = Material(1.0, 0.5, (Branch(5.0, 0.0123), Branch(2.0, 0.9), Branch(1.0, 33.0)))


def relaxation(material, times=TIMES, noise=0.0, seed=0):
    scatter = 1.0 + noise * np.random.default_rng(seed).standard_normal(times.size)
    return RelaxationData(times, material.relaxation_modulus(times) * scatter)


def dynamic(material, frequencies=1.0 / TIMES[::-1], noise=0.0, seed=0):
    scatter = 1.0 + noise * np.random.default_rng(seed).standard_normal((2, frequencies.size))
    storage, loss = material.storage_modulus(frequencies), material.loss_modulus(frequencies)
    return DynamicData(frequencies, storage * scatter[0], loss * scatter[1])


def check_same(fit, material, rel):
    assert fit.modulus == pytest.approx(material.modulus, rel=rel)
    assert len(fit.branches) == len(material.branches)
    for found, known in zip(fit.branches, material.branches, strict=True):
        assert found.time == pytest.approx(known.time, rel=rel)
        assert found.modulus == pytest.approx(known.modulus, rel=rel)


@pytest.mark.parametrize("measured", [relaxation, dynamic])
def test_a_known_series_comes_back(measured):
    """Times between those of the grid are found too; nothing needs dropping."""
    fit = fit_prony(measured(KNOWN))
    check_same(fit, KNOWN, 1e-9)
    assert fit.misfit < 1e-12
    assert fit.dropped == ()
    assert (fit.grid[0], fit.grid[-1]) == pytest.approx((1e-3 / math.sqrt(10.0), 1e3 * math.sqrt(10.0)))
    assert fit.used >= fit.joined == 3
    check_same(fit_prony(measured(KNOWN), relaxed=1.0), KNOWN, 1e-9)
    wrong = fit_prony(measured(KNOWN), relaxed=2.0)
    assert wrong.modulus == 2.0
    assert wrong.misfit > 0.1


@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(0.5, 5.0), st.floats(0.1, 0.9)), min_size=1, max_size=4),
    st.floats(-8.0, 8.0),
    st.floats(-8.0, 8.0),
)
def test_any_series_of_separate_times_comes_back(parts, of_time, of_stress):
    """One branch in each decade at most, every unit of time and stress."""
    second, pascal = 10.0**of_time, 10.0**of_stress
    branches = tuple(
        Branch(pascal * modulus, second * 10.0 ** (1.3 * decade - 2.5 + share))
        for decade, (modulus, share) in enumerate(parts)
    )
    known = Material(pascal, 0.5, branches)
    check_same(fit_prony(dynamic(known, TIMES / second), tolerance=1e-7), known, 1e-4)


@pytest.mark.parametrize("measured", [relaxation, dynamic])
def test_noise_makes_no_branches(measured):
    """Schwarz' criterion: of 1 % scatter the known branches are left, and the misfit is the scatter."""
    for seed in range(3):
        fit = fit_prony(measured(KNOWN, noise=0.01, seed=seed))
        check_same(fit, KNOWN, 0.2)
        assert 0.005 < fit.misfit < 0.012
        assert fit.material(0.5).glassy_modulus == pytest.approx(9.0, rel=0.03)


def test_what_is_stated_is_so():
    data = dynamic(KNOWN, noise=0.02)
    fit = fit_prony(data)
    material = fit.material(0.5)
    w = data.angular_frequencies
    parts = material.storage_modulus(w) / data.storage, material.loss_modulus(w) / data.loss
    residuals = np.concatenate(parts) - 1.0
    np.testing.assert_allclose(fit.residuals, residuals, atol=1e-12)
    assert fit.misfit == pytest.approx(math.sqrt(np.mean(residuals**2)), rel=1e-9)
    assert fit.largest_residual == pytest.approx(np.abs(residuals).max(), rel=1e-9)
    sheared = fit_prony(replace(data, shear=True))
    assert sheared.material(0.25).modulus == pytest.approx(2.5 * fit.modulus, rel=1e-9)
    assert sheared.material(0.25).branches[0].modulus == pytest.approx(2.5 * fit.branches[0].modulus)


def test_dropped_branches_are_told():
    """A branch of 0.05 % at most is below the tolerance, and above a smaller one."""
    weak = Material(1.0, 0.5, (Branch(5.0, 0.0123), Branch(8e-4, 10.0)))
    fit = fit_prony(relaxation(weak))
    assert [branch.time for branch in fit.branches] == [pytest.approx(0.0123, rel=1e-2)]
    (dropped,) = [one for one in fit.dropped if one.branch.time == pytest.approx(10.0, rel=0.05)]
    assert dropped.branch.modulus == pytest.approx(8e-4, rel=0.05)
    assert dropped.misfit_before < 1e-6 < 1e-4 < dropped.misfit_after < 1e-3
    assert fit.misfit == fit.dropped[-1].misfit_after
    check_same(fit_prony(relaxation(weak), tolerance=1e-6), weak, 1e-3)


def test_elastic_and_melt():
    fit = fit_prony(RelaxationData(TIMES, np.full(61, 3.0)))
    assert fit.branches == ()
    assert fit.modulus == pytest.approx(3.0, rel=1e-12)
    times = np.geomspace(1e-3, 30.0, 25)  # here least squares alone leave 1e-17 of a relaxed modulus
    for data in (
        RelaxationData(TIMES, 5.0 * np.exp(-TIMES / 200.0)),
        RelaxationData(times, 5.0 * np.exp(-times / 5.0)),
    ):
        melt = fit_prony(data)
        assert melt.modulus == 0.0
        assert len(melt.branches) == 1
    with pytest.raises(SceneError, match="no relaxed modulus"):
        melt.material(0.5)


@settings(max_examples=30)
@given(st.lists(st.tuples(st.floats(1e-60, 1e60), st.floats(1e-60, 1e60)), min_size=3, max_size=8))
def test_whatever_the_data_a_series_or_one_line(rows):
    times, moduli = np.array(sorted(rows)).T
    try:
        fit = fit_prony(RelaxationData(times, moduli))
        material = None if fit.modulus == 0.0 else fit.material(0.5)
    except SceneError:
        return
    assert np.isfinite(fit.misfit)
    assert material is None or np.isfinite(material.relaxation_modulus(times)).all()


@pytest.mark.parametrize("tolerance", [3e-4, 3e-2])
def test_a_power_law_is_met_to_the_tolerance(tolerance):
    """No short series is one: the tolerance is kept, and used; ``E(w)`` is that of the law away from ends."""
    times = np.geomspace(1e-2, 1e2, 31)
    fit = fit_prony(RelaxationData(times, times**-0.3), tolerance=tolerance)
    assert 0.1 * tolerance < fit.misfit <= tolerance
    w = np.geomspace(0.1, 1.0, 9)
    exact = gamma(0.7) * (1j * w) ** 0.3
    assert np.abs(fit.material(0.5).complex_modulus(w) / exact - 1.0).max() < 30.0 * tolerance


@pytest.mark.parametrize("measured", [relaxation, dynamic])
def test_slopes_are_those_of_the_responses(measured):
    """Against central differences; the refinement would still end somewhere with wrong ones."""
    data, times, small = measured(KNOWN), np.array([0.01, 0.3, 40.0]), 1e-5
    ends = [data.responses(times * math.exp(sign * small))[1] for sign in (1.0, -1.0)]
    slopes = data.responses(times)[2]
    np.testing.assert_allclose(slopes, (ends[0] - ends[1]) / (2.0 * small), atol=1e-8 * np.abs(slopes).max())


ONES = np.ones(4)


@pytest.mark.parametrize(
    ("build", "key"),
    [
        (lambda: fit_prony(relaxation(KNOWN), tolerance=2.0), "tolerance"),
        (lambda: fit_prony(relaxation(KNOWN), relaxed=0.0), "modulus"),
        (lambda: fit_prony(RelaxationData(ONES[:2], ONES[:2])), ""),
        (lambda: fit_prony(RelaxationData(np.arange(1.0, MOST_ROWS + 2), np.ones(MOST_ROWS + 1))), ""),
        (lambda: RelaxationData(ONES, ONES[:3]), "moduli"),
        (lambda: RelaxationData(ONES[:0], ONES[:0]), "times"),
        (lambda: RelaxationData([2, 1], [1, 1]), "times"),
        (lambda: RelaxationData([1, 2], [1, np.nan]), "moduli[1]"),
        (lambda: DynamicData(ONES, ONES, -ONES), "loss[0]"),
        (lambda: RelaxationData(ONES, ONES, units=("s",)), "units"),
    ],
)
def test_bad_values_get_one_line(build, key):
    with pytest.raises(SceneError) as caught:
        build()
    assert caught.value.key == key
    assert caught.value.allowed
