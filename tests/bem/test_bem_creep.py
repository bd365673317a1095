"""One surface point: the two internal-variable forms of one material, and the weights of a step."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.bem_runs import observed_order
from support.paper_scenes import ONE, THREE

from bem_solver.creep import Chain
from bem_solver.surface_points import load_inside, pressed
from contact_scene import Branch, Material

SEVEN = Material(0.5, 0.3, tuple(Branch(m, 10.0**-k) for k, m in enumerate((1, 2, 3, 5, 1, 8, 2))))
THIRTY = Material(1e-3, 0.5, tuple(Branch(10.0 ** (-k / 10), 10.0 ** (15 * k / 29 - 9)) for k in range(30)))
CLOSE = Material(1.0, 0.4, tuple(Branch(1.0, 1.0 + d) for d in (0.0, 1e-12, 1e-6, 1e-3)))
WEAK = Material(1.0, 0.4, (Branch(1e-9, 0.3), Branch(1e3, 1.0), Branch(1e-6, 1e3)))
SLIGHT = Material(1.0, 0.4, (Branch(1e-20, 1.0), Branch(5.0, 2.0), Branch(1e-18, 2.0 + 1e-10)))
MATERIALS = {"one": ONE, "two": Material(1.0, 0.0, (Branch(1, 1), Branch(9, 10))), "three": THREE}
MATERIALS |= {"seven": SEVEN, "thirty": THIRTY, "close": CLOSE, "weak": WEAK, "slight": SLIGHT}
materials = pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)


@materials
def test_both_forms_are_one_element(material):
    """Scaled ``b' = r w' - b/tau`` with ``v = E0 w + sum b`` is scaled ``l' = s v' - l/theta``, ``l = Q b``.

    For every ``w'`` and ``b``; and ``w = v/E0 - sum l`` gives the same displacement back.
    """
    chain = Chain(material)
    rotation, lag_rate = chain.rotation, chain.lag_rate
    stress_rate = chain.stress_scale / chain.relaxation  # r
    whole = chain.glassy * np.linalg.norm(lag_rate)
    assert_allclose(rotation @ stress_rate / whole, lag_rate * chain.glassy / whole, atol=1e-12)
    decay = rotation / chain.relaxation
    same = np.outer(lag_rate, stress_rate) + rotation / chain.retardation[:, None]
    scale = np.sqrt(np.outer(1.0 / chain.retardation, 1.0 / chain.relaxation))
    assert_allclose(decay / scale, same / scale, rtol=1e-12, atol=1e-13)
    back, given_scale = rotation.T @ chain.lag_scale, chain.stress_scale / chain.relaxed
    assert_allclose(back, given_scale, atol=1e-13 * np.linalg.norm(given_scale))


@pytest.mark.parametrize("material", [ONE, THREE, SEVEN], ids=["one", "three", "seven"])
def test_ramp_is_exact_whatever_the_step(material):
    """``v = w' int_0^t E*``, in one step or a hundred."""
    chain, total = Chain(material), 2.7
    moduli, times = material.spectrum
    relaxed = material.modulus * total + float(-np.expm1(-total / times) @ (moduli * times))
    for count in (1, 3, 100):
        variables = np.zeros((1, len(chain)))
        for _ in range(count):
            variables = pressed(chain, variables, np.array([0.1 / count]), total / count)
        load = load_inside(chain, variables, np.array([0.1]))
        assert_allclose(load, 0.1 / total * relaxed / (1.0 - material.poisson**2), rtol=1e-12)


def voigt(chain, loads, duration):
    """Displacement under ``v`` linear over steps of equal length, by the lags alone."""
    lags, y = np.zeros((1, len(chain))), duration / chain.retardation
    for rise in np.diff(loads, axis=0):
        lags = chain.decay(y) * lags + chain.spread(y) * chain.lag_rate * rise[:, None]
    return loads[-1] / chain.relaxed - lags @ chain.lag_scale


@pytest.mark.parametrize("euler", [False, True])
@pytest.mark.parametrize("material", [ONE, THREE], ids=["one", "three"])
def test_voigt_chain_inverts_maxwell_chain(material, euler):
    """Second order in the step, for the load is not linear within it; backward Euler is first order."""
    chain, errors = Chain(material, euler), []
    for count in (50, 100, 200):
        times = np.linspace(0.0, 3.0, count + 1)
        wanted = 0.03 * np.sin(2.0 * times)
        variables, loads = np.zeros((1, len(chain))), [np.zeros(1)]
        for rise, at in zip(np.diff(wanted), wanted[1:], strict=True):
            variables = pressed(chain, variables, np.array([rise]), times[1])
            loads.append(load_inside(chain, variables, np.array([at])))
        exact = Chain(material)
        errors.append(float(voigt(exact, np.array(loads), times[1])[0] - wanted[-1]))
    assert abs(errors[-1]) < (1e-3 if euler else 2e-5)
    expected = 1.0 if euler else 2.0
    assert expected - 0.2 < observed_order(errors) < expected + 0.2, errors


@pytest.mark.parametrize("euler", [False, True])
def test_order_of_both_schemes_in_relaxation(euler):
    """Against ``int E*(t - s) dw(s)`` for ``w = sin t``."""
    chain, end = Chain(THREE, euler), 2.0
    moduli, times = THREE.spectrum

    def felt(s):
        return (0.75 + float(np.exp(-(end - s) / times) @ moduli)) / 0.75 * np.cos(s)

    exact, errors = quad(felt, 0.0, end, epsrel=1e-12)[0], []
    for count in (40, 80, 160):
        at = np.linspace(0.0, end, count + 1)
        variables = np.zeros((1, len(chain)))
        for rise in np.diff(np.sin(at)):
            variables = pressed(chain, variables, np.array([rise]), at[1])
        errors.append(float(load_inside(chain, variables, np.sin(at[-1:]))[0]) - exact)
    expected = 1.0 if euler else 2.0
    assert expected - 0.15 < observed_order(errors) < expected + 0.15, errors
    assert abs(errors[-1]) < (0.05 if euler else 2e-4)


@pytest.mark.parametrize("times", [(1.0,), (1e-3, 1.0, 1e3)])
@pytest.mark.parametrize("duration", [1e-4, 0.02, 0.5, 0.7, 3.0, 100.0, 1e8])
def test_a_parabola_that_meets_a_cubic_at_the_right_share_bears_its_stress(times, duration):
    """What is left of ``s (1 - s) (s - s')`` in a point in contact at the end of the step is nothing."""
    chain = Chain(Material(1.0, 0.3, tuple(Branch(2.0 + k, time) for k, time in enumerate(times))))
    share = chain.share_to_meet(duration)
    assert 0.5 <= share <= 1.0
    nodes, weights = np.polynomial.legendre.leggauss(40)
    stress, size = 0.0, 0.0
    for modulus, time in zip(chain.stress_scale**2 / chain.relaxation, chain.relaxation, strict=True):
        y = duration / time
        ends = np.unique(np.minimum(np.array([0.0, 1.0, 5.0, 15.0, 40.0, y]) / y, 1.0))
        for low, high in pairwise(ends.tolist()):
            left = low + 0.5 * (high - low) * (1.0 + nodes)  # share of the step still to come
            weight = modulus * y * 0.5 * (high - low) * weights * np.exp(-y * left) * left * (1.0 - left)
            stress += float(weight @ (1.0 - left - share))
            size += float(weight @ left)
    assert abs(stress) < 2e-3 * size


def test_a_penetration_is_met_before_the_end_of_a_step_however_short_a_branch_is():
    chain = Chain(Material(1.0, 0.3, (Branch(2.0, 1e-40),)))
    assert 0.999 < chain.share_to_meet(1.0) < 1.0
