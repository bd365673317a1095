"""Retardation spectra: ``s^2 E(s) J(s) = 1``, limits, interlacing, close and tiny branches."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bem_solver.creep import creep_spectrum


def decades(count, span=15.0, ratio=9.0):
    """``count`` branches over ``span`` decades with uneven weights of sum ``ratio``."""
    weights = 1.5 + np.sin(3.0 * np.arange(count))
    return ratio * weights / weights.sum(), np.logspace(-span / 2, span / 2, count)


SPECTRA = {
    "1 branch": ([9.0], [1.0]),
    "7 branches": decades(7),
    "60 branches": decades(60),
    "60 branches in one decade": decades(60, span=1.0),
    "glassy modulus 1e9 times relaxed": decades(30, ratio=1e9),
    "glassy modulus 1.000001 times relaxed": decades(7, ratio=1e-6),
    "times 1e-9 apart": ([3.0, 4.0, 5.0, 2.0], [1.0, 1.0 + 1e-9, 1.0 + 3e-9, 10.0]),
    "tiny weights": ([1e-3, 1e-8, 1e-16, 1e-25, 3.0], [1e-4, 1e-2, 1.0, 30.0, 1e4]),
    "small weight on a retardation time": ([9.0, 1e-9], [1.0, 10.0]),
    "times from 1e-58 to 1e58": ([1.0, 2.0, 3.0], [1e-58, 1.0, 1e58]),
}
spectra = pytest.mark.parametrize(
    ("moduli", "times"), [tuple(map(np.asarray, pair)) for pair in SPECTRA.values()], ids=SPECTRA
)


@spectra
def test_moduli_and_compliances_are_reciprocal_in_laplace_space(moduli, times):
    compliances, retardation, _ = creep_spectrum(1.0, moduli, times)
    glassy = 1.0 / (1.0 + moduli.sum())
    for s in np.geomspace(1e-2 / times[-1], 1e2 / times[0], 101):
        modulus = 1.0 + moduli @ (s * times / (1.0 + s * times))
        compliance = glassy + compliances @ (1.0 / (1.0 + s * retardation))
        assert modulus * compliance == pytest.approx(1.0, rel=1e-12)


@spectra
def test_retardation_times_interlace_with_relaxation_times(moduli, times):
    compliances, retardation, distances = creep_spectrum(1.0, moduli, times)
    assert np.all(compliances > 0.0)
    assert np.all(retardation >= times)
    assert np.all(retardation[:-1] <= times[1:])
    assert np.all(np.diag(distances) > 0.0)
    assert_allclose(1.0 / (1.0 + moduli.sum()) + compliances.sum(), 1.0, rtol=1e-12)


def test_one_branch_in_closed_form():
    """``theta = tau Einf/E0`` and ``J = 1/E0 - 1/Einf``."""
    compliances, retardation, distances = creep_spectrum(0.75, np.array([6.75]), np.array([2.0]))
    assert_allclose(retardation, [20.0], rtol=1e-15)
    assert_allclose(compliances, [1.0 / 0.75 - 1.0 / 7.5], rtol=1e-14)
    assert_allclose(distances, [[18.0]], rtol=1e-14)


def test_distances_keep_their_digits_where_the_times_do_not():
    """A branch of modulus ``e`` moves its time by ``e tau`` to first order."""
    moduli, times = np.array([1e-20]), np.array([3.0])
    _, retardation, distances = creep_spectrum(1.0, moduli, times)
    assert retardation[0] == times[0]
    assert_allclose(distances, [[3e-20]], rtol=1e-12)


def test_no_branches():
    compliances, retardation, distances = creep_spectrum(1.0, np.empty(0), np.empty(0))
    assert len(compliances) == len(retardation) == 0
    assert distances.shape == (0, 0)
