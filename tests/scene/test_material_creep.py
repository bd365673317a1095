"""Relaxation modulus <-> creep compliance: the convolution identity and the round trip, over wide spectra."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial.legendre import leggauss

from bem_solver import retardation
from contact_scene import Branch, Material
from validation.reference.creep_compliance import CreepCompliance, creep_compliance

TOLERANCE = 1e-10


def by_roots(material):
    """The boundary elements' derivation."""
    spectrum = retardation.creep_spectrum(material.modulus, *material.spectrum)
    return CreepCompliance(1.0 / material.glassy_modulus, *spectrum)


either = pytest.mark.parametrize("creep_of", [creep_compliance, by_roots], ids=["eigenproblem", "roots"])


def material(moduli, times, relaxed=1.0):
    branches = tuple(Branch(float(m), float(t)) for m, t in zip(moduli, times, strict=True))
    return Material(relaxed, 0.3, branches)


def decades(count, span=15.0, ratio=9.0):
    """``count`` branches over ``span`` decades with uneven weights of sum ``ratio``."""
    weights = 1.5 + np.sin(3.0 * np.arange(count))
    return material(ratio * weights / weights.sum(), np.logspace(-span / 2, span / 2, count))


def nearly_equal(gap):
    return material([3.0, 4.0, 5.0, 2.0], [1.0, 1.0 + gap, 1.0 + 3 * gap, 10.0])


MATERIALS = {
    "no branch": material([], []),
    "1 branch": material([9.0], [1.0]),
    "2 branches": decades(2),
    "7 branches": decades(7),
    "30 branches": decades(30),
    "60 branches": decades(60),
    "60 branches in one decade": decades(60, span=1.0),
    "glassy modulus 1e9 times relaxed": decades(30, ratio=1e9),
    "glassy modulus 1.000001 times relaxed": decades(7, ratio=1e-6),
    "times 1e-3 apart": nearly_equal(1e-3),
    "times 1e-9 apart": nearly_equal(1e-9),
    "times 1e-15 apart": nearly_equal(4 * np.finfo(float).eps),
    "tiny weights": material([1e-3, 1e-8, 1e-16, 1e-25, 3.0], [1e-4, 1e-2, 1.0, 30.0, 1e4]),
    "weight below sight": material([9.0, 1e-200], [1.0, 3.0]),
    "tiny weight on a retardation time": material([9.0, 1e-16], [1.0, 10.0]),
    "small weight on a retardation time": material([9.0, 1e-9], [1.0, 10.0]),
    "times from 1e-58 to 1e58": material([1.0, 2.0, 3.0], [1e-58, 1.0, 1e58]),
    "modulus 1e-50": material([9e-50, 4e-50], [1e-3, 1e3], relaxed=1e-50),
    "modulus 1e50": material([9e50, 4e50], [1e-3, 1e3], relaxed=1e50),
}


def convolution(material, creep, end):
    """``int_0^t E(t - s) J(s) ds`` by Gauss rules on panels that shrink towards both ends."""
    nodes, weights = leggauss(20)
    ends = np.concatenate([[0.0], 0.5 * end * 2.0 ** np.arange(-85, 1)])
    half, middle = 0.5 * np.diff(ends)[:, None], 0.5 * (ends[1:] + ends[:-1])[:, None]
    s, w = (middle + half * nodes).ravel(), (half * weights).ravel()
    E, J = material.relaxation_modulus, creep
    return float(w @ (E(end - s) * J(s)) + w @ (E(s) * J(end - s)))


def sample_times(material):
    _, times = material.spectrum
    if times.size == 0:
        return np.array([1e-3, 1.0, 1e3])
    return np.geomspace(max(times[0], 1e-20) * 1e-2, min(times[-1], 1e20) * 1e3, 25)


@either
@pytest.mark.parametrize("name", MATERIALS)
def test_convolution_of_relaxation_and_creep_is_time(name, creep_of):
    creep = creep_of(MATERIALS[name])
    for end in sample_times(MATERIALS[name]):
        assert convolution(MATERIALS[name], creep, end) == pytest.approx(end, rel=TOLERANCE)


@either
@pytest.mark.parametrize("name", MATERIALS)
def test_round_trip_returns_the_relaxation_modulus(name, creep_of):
    there = MATERIALS[name]
    relaxed, branches = creep_of(there).relaxation()
    back = Material(relaxed, there.poisson, branches)
    times = np.concatenate([[0.0], sample_times(there)])
    np.testing.assert_allclose(
        back.relaxation_modulus(times), there.relaxation_modulus(times), rtol=TOLERANCE
    )
    assert back.modulus == pytest.approx(there.modulus, rel=1e-13)


@either
@pytest.mark.parametrize("name", ["1 branch", "2 branches", "7 branches", "30 branches", "60 branches"])
def test_round_trip_returns_each_branch(name, creep_of):
    moduli, times = MATERIALS[name].spectrum
    _, branches = creep_of(MATERIALS[name]).relaxation()
    np.testing.assert_allclose([b.modulus for b in branches], moduli, rtol=TOLERANCE)
    np.testing.assert_allclose([b.time for b in branches], times, rtol=1e-12)


@either
@pytest.mark.parametrize("name", MATERIALS)
def test_limits_interlacing_and_signs(name, creep_of):
    creep, (_, times) = creep_of(MATERIALS[name]), MATERIALS[name].spectrum
    assert creep.glassy == pytest.approx(1 / MATERIALS[name].glassy_modulus, rel=1e-15)
    assert creep.relaxed == pytest.approx(1 / MATERIALS[name].modulus, rel=1e-12)
    assert creep.times.shape == creep.compliances.shape == times.shape
    assert (creep.compliances > 0).all()
    assert (creep.times >= times).all()
    assert (creep.times[:-1] <= times[1:]).all()


@either
def test_one_branch_by_hand(creep_of):
    creep = creep_of(material([9.0], [2.0]))
    assert creep.glassy == pytest.approx(0.1)
    assert creep.times.tolist() == pytest.approx([20.0], rel=1e-15)  # theta = tau Einf/E0
    assert creep.compliances.tolist() == pytest.approx([0.9], rel=1e-14)
    assert creep([-1.0, 0.0, 20.0]).tolist() == pytest.approx([0.0, 0.1, 1 - 0.9 / math.e], rel=1e-14)


@either
def test_two_branches_by_the_quadratic_formula(creep_of):
    # (1 + s)(1 + 4 s) E(s) s = 1 + (5 + 2 + 12) s + 4 (1 + 2 + 3) s^2 for E0 = 1, (2, 1), (3, 4)
    creep = creep_of(material([2.0, 3.0], [1.0, 4.0]))
    b, c = 5 + 2 * 1 + 3 * 4, 4 * 6
    roots = np.sort([(b - math.sqrt(b * b - 4 * c)) / 2, (b + math.sqrt(b * b - 4 * c)) / 2])
    np.testing.assert_allclose(creep.times, roots, rtol=1e-14)


branch_lists = st.lists(
    st.tuples(st.floats(-12, 6), st.floats(-8, 8)).map(lambda p: (10.0 ** p[0], 10.0 ** p[1])),
    min_size=1,
    max_size=40,
)


@pytest.mark.parametrize("name", MATERIALS)
def test_both_derivations_agree(name):
    """Eigenproblem and roots; distances but for a branch that sits on a retardation time of the others."""
    sample = MATERIALS[name]
    one, other = creep_compliance(sample), by_roots(sample)
    np.testing.assert_allclose(one.times, other.times, rtol=1e-13)
    t = sample_times(sample)
    np.testing.assert_allclose(one(t), other(t), rtol=1e-13)
    if "on a retardation time" not in name:
        np.testing.assert_allclose(one.compliances, other.compliances, rtol=1e-13)
        np.testing.assert_allclose(one.distances, other.distances, rtol=1e-13)


@either
@settings(max_examples=30)
@given(branch_lists, st.floats(-9, 10))
def test_identity_on_random_spectra(creep_of, branches, log_time):
    sample = material(*zip(*branches, strict=True))
    end = 10.0**log_time
    assert convolution(sample, creep_of(sample), end) == pytest.approx(end, rel=TOLERANCE)


@either
@settings(max_examples=30)
@given(branch_lists)
def test_round_trip_on_random_spectra(creep_of, branches):
    there = material(*zip(*branches, strict=True))
    relaxed, back = creep_of(there).relaxation()
    times = np.concatenate([[0.0], np.logspace(-10, 16, 40)])
    np.testing.assert_allclose(
        Material(relaxed, 0.3, back).relaxation_modulus(times),
        there.relaxation_modulus(times),
        rtol=TOLERANCE,
    )


@either
@settings(max_examples=30)
@given(branch_lists, st.floats(-12, 12))
def test_complex_modulus_times_complex_compliance_is_one(creep_of, branches, log_frequency):
    sample = material(*zip(*branches, strict=True))
    w = 10.0**log_frequency
    product = complex(sample.complex_modulus(w)) * complex(creep_of(sample).complex_compliance(w))
    assert product == pytest.approx(1.0, rel=TOLERANCE)


@either
@settings(max_examples=30)
@given(branch_lists)
def test_order_and_splitting_of_branches_do_not_matter(creep_of, branches):
    moduli, times = zip(*branches, strict=True)
    one = creep_of(material(moduli, times))
    halves = creep_of(
        material([m / 2 for m in moduli[::-1] for _ in "ab"], [t for t in times[::-1] for _ in "ab"])
    )
    t = np.logspace(-10, 10, 21)
    np.testing.assert_allclose(one(t), halves(t), rtol=1e-11)


def test_storage_and_loss_modulus():
    sample = material([9.0], [2.0])
    w = np.array([0.0, 0.25, 0.5, 1e3])
    p = 2.0 * w
    np.testing.assert_allclose(sample.storage_modulus(w), 1 + 9 * p**2 / (1 + p**2), rtol=1e-14)
    np.testing.assert_allclose(sample.loss_modulus(w), 9 * p / (1 + p**2), rtol=1e-14)
    assert sample.loss_modulus(1e300) == pytest.approx(4.5e-300)
    assert sample.storage_modulus(1e300) == 10.0


def test_loss_modulus_from_the_relaxation_modulus():
    """``E'' = w int_0^inf (E(t) - E0) cos(w t) dt``, from the time domain."""
    sample, w = decades(3, span=2.0), 0.7
    nodes, weights = leggauss(40)
    ends = np.linspace(0.0, 600.0, 601)
    half, middle = 0.5 * np.diff(ends)[:, None], 0.5 * (ends[1:] + ends[:-1])[:, None]
    t, dt = (middle + half * nodes).ravel(), (half * weights).ravel()
    loss = w * float(dt @ ((sample.relaxation_modulus(t) - sample.modulus) * np.cos(w * t)))
    assert float(sample.loss_modulus(w)) == pytest.approx(loss, rel=1e-10)
