"""Power law and standard linear solid against their closed forms; expansion to the stated error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import gamma

from contact_scene import Branch, Material, SceneError, scene_from_dict
from contact_scene.material import (
    PowerLawRelaxation,
    StandardLinearSolid,
    spacing_error,
    spacing_of,
)

OTHERS = {
    "indenter": {"shape": "sphere", "radius": 1.0},
    "loading": {"start": "relaxed", "penetration": 0.0},
}


def material(**keys):
    return scene_from_dict({"material": {"poisson": 0.5} | keys} | OTHERS).material


def worst_error(law, points=400):
    """Largest relative error of the power law in its range."""
    modulus, branches = law.series()
    t = np.geomspace(*law.range, points)
    series = Material(modulus, 0.5, branches).relaxation_modulus(t) - law.relaxed
    return float(np.abs(series / (law.modulus * (t / law.time) ** -law.exponent) - 1.0).max())


def test_standard_linear_solid_is_exact():
    read = material(model="standard-linear", relaxed=0.75, glassy=7.5, time=2.0)
    assert read == Material(0.75, 0.5, (Branch(6.75, 2.0),))
    t = np.array([0.0, 1.0, 7.0])
    np.testing.assert_allclose(read.relaxation_modulus(t), 0.75 + 6.75 * np.exp(-t / 2.0), rtol=1e-15)


@settings(max_examples=40)
@given(
    st.floats(0.02, 0.98),
    st.floats(-11.0, -1.0).map(lambda x: 10.0**x),
    st.floats(0.1, 12.0),
    st.floats(-6.0, 6.0),
)
def test_power_law_keeps_to_the_stated_error_over_its_range(exponent, error, decades, start):
    """Whatever the law: below the stated error everywhere, and not by wasting branches."""
    first = 10.0**start
    law = PowerLawRelaxation(exponent, 3.0, 0.1, (first, first * 10.0**decades), error)
    assert worst_error(law) <= error
    _, branches = law.series()
    ratios = np.diff([math.log(branch.time) for branch in branches])
    assert np.allclose(ratios, spacing_of(exponent, 0.5 * error), rtol=1e-9)


@pytest.mark.parametrize("exponent", [0.1, 0.5, 0.9])
def test_the_error_falls_with_the_one_asked_for(exponent):
    """Two-sided: the bound is met, and used by more than a tenth, at every accuracy."""
    asked = [1e-2, 1e-4, 1e-6, 1e-8]
    reached = [worst_error(PowerLawRelaxation(exponent, 1.0, 1.0, (1e-3, 1e3), e)) for e in asked]
    for error, worst in zip(asked, reached, strict=True):
        assert 0.1 * error < worst <= error


def test_the_error_of_the_spacing_is_the_one_of_poisson_s_sum():
    """The trapezoidal rule without ends, summed far out, against its exact error: two-sided."""
    n = 0.4
    for spacing in (1.0, 1.5, 2.0):
        u = spacing * np.arange(-200, 40)
        t = np.exp(np.linspace(0.0, spacing, 64))
        terms = spacing / gamma(n) * np.exp(n * u - np.minimum(np.exp(u) * t[:, None], 700.0))
        worst = np.abs(terms.sum(axis=1) * t**n - 1.0).max()
        assert 0.99 * spacing_error(n, spacing) < worst < 1.000001 * spacing_error(n, spacing)


@pytest.mark.parametrize("n", [0.2, 0.5, 0.8])
def test_complex_modulus_of_the_power_law(n):
    """``E(w) = E1 t1^n Gamma(1 - n) (i w)^n``, up to the branches left out at both ends and the spacing.

    The spectrum is ``s^n sin(pi n)/pi`` over log rates, relative to that; a branch of rate ``s`` gives at
    most ``w/s`` of it where it is left out, and is off by ``s/w`` where it is taken as relaxed. The spacing:
    as for ``E(t)``, with the Fourier transform of ``s^n i w/(i w + s)``.
    """
    law = PowerLawRelaxation(n, 2.0, 0.5, (1e-4, 1e4), 1e-6)
    modulus, branches = law.series()
    w = np.geomspace(1e-6, 1e6, 61)
    exact = 2.0 * 0.5**n * gamma(1.0 - n) * (1j * w) ** n
    error = np.abs(Material(modulus, 0.5, branches).complex_modulus(w) / exact - 1.0)
    share = math.sin(math.pi * n) / math.pi
    fast = (w * branches[0].time) ** (1.0 - n) * share / (1.0 - n)
    slow = (w * branches[-1].time) ** -(1.0 + n) * share / (1.0 + n)
    wave = 2.0 * math.pi / math.log(branches[1].time / branches[0].time)
    spacing = 2.0 * math.pi * share * math.cosh(0.5 * math.pi * wave) / abs(np.sin(math.pi * (n + 1j * wave)))
    assert (error <= fast + slow + 1.001 * spacing).all()
    assert (error >= 0.1 * np.maximum(fast, slow) - 2.0 * spacing)[[0, 5, 55, 60]].all()
    assert error.min() < 10.0 * (fast + slow + spacing).min()


def test_relaxed_modulus_beside_the_power_law():
    law = PowerLawRelaxation(0.3, 2.0, 1.0, (1e-3, 1e3), 1e-5, relaxed=0.5)
    t = np.geomspace(1e-3, 1e3, 100)
    modulus, branches = law.series()
    series = Material(modulus, 0.5, branches).relaxation_modulus(t)
    np.testing.assert_allclose(series, 0.5 + 2.0 * t**-0.3, rtol=1e-5)
    assert modulus > 0.5


@given(st.floats(0.05, 0.95), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_other_units_give_the_same_material(exponent, of_time, of_stress):
    seconds, pascals = 10.0**of_time, 10.0**of_stress
    one, branches = PowerLawRelaxation(exponent, 2.0, 1.0, (0.01, 100.0)).series()
    law = PowerLawRelaxation(exponent, 2.0 * pascals, seconds, (0.01 * seconds, 100.0 * seconds))
    other, scaled = law.series()
    assert other == pytest.approx(one * pascals, rel=1e-11)
    for branch, again in zip(branches, scaled, strict=True):
        assert again.time == pytest.approx(branch.time * seconds, rel=1e-11)
        assert again.modulus == pytest.approx(branch.modulus * pascals, rel=1e-11)


POWER = {"model": "power-law", "exponent": 0.3, "modulus": 2.0, "time": 1.0, "range": [1e-3, 1e3]}
STANDARD = {"model": "standard-linear", "relaxed": 1.0, "glassy": 10.0, "time": 1.0}


def test_keys_of_the_scene():
    assert material(**POWER) == material(**POWER, error=1e-4)
    assert len(material(**POWER, error=1e-8).branches) > len(material(**POWER).branches)
    assert material(**POWER, bulk={"modulus": 9.0}).bulk.modulus == 9.0
    assert material(model="prony", modulus=1.0) == Material(1.0, 0.5)


@pytest.mark.parametrize(
    ("keys", "where", "allowed"),
    [
        (POWER | {"range": [1.0]}, "range", "two times"),
        (POWER | {"range": [1.0, 1.0]}, "range", "first < last"),
        (POWER | {"range": [1e-60, 1e60]}, "range", "from 1e-60 to 1e+60"),
        (POWER | {"modulus": 1e60, "time": 1e3}, "modulus", "from 1e-60 to 1e+60"),
        (POWER | {"modulus": 1e-60}, "modulus", "from 1e-60 to 1e+60"),
        (POWER | {"branches": []}, "branches", "exponent"),
        (POWER | {"file": "x.csv"}, "file", "exponent"),
        (STANDARD | {"glassy": 1.0}, "glassy", "above relaxed"),
        (STANDARD | {"glassy": 0.5}, "glassy", "above relaxed"),
        (STANDARD | {"modulus": 1.0}, "modulus", "relaxed, glassy, time"),
    ],
)
def test_bad_values_get_one_line(keys, where, allowed):
    with pytest.raises(SceneError) as caught:
        material(**keys)
    line = str(caught.value)
    assert line.startswith(f"material.{where}: ")
    assert allowed in line.split("; allowed: ")[1]
    assert "\n" not in line


@given(
    st.floats(1e-6, 1.0 - 1e-6),
    st.floats(1e-60, 1e60),
    st.floats(1e-60, 1e60),
    st.tuples(st.floats(1e-60, 1e60), st.floats(1e-60, 1e60)),
    st.floats(1e-12, 0.1),
)
def test_extreme_laws_are_expanded_or_refused(exponent, modulus, time, ends, error):
    try:
        relaxed, branches = PowerLawRelaxation(exponent, modulus, time, ends, error).series()
    except SceneError:
        return
    assert 1e-60 <= relaxed <= 1e60
    assert all(1e-61 < branch.time < 1e61 for branch in branches)


def test_the_parts_check_what_they_are_given():
    with pytest.raises(SceneError, match="glassy"):
        StandardLinearSolid(2.0, 1.0, 1.0)
    with pytest.raises(SceneError, match="exponent"):
        PowerLawRelaxation(2.0, 1.0, 1.0, (1.0, 2.0))
