"""Materials: creep by both derivations, laws of few parameters, temperature, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial.legendre import leggauss
from scipy.special import gamma

from bem_solver.creep import creep_spectrum
from contact_scene import Branch, BulkRelaxation, Material, PowerLawRelaxation, SceneError, scene_from_dict
from contact_scene.material import spacing_error, spacing_of
from contact_scene.temperature_shift import WLF, Arrhenius, ShiftTable, at_temperature
from validation.reference.creep_compliance import CreepCompliance, creep_compliance

TOLERANCE = 1e-10
OTHERS = {"indenter": {"shape": "sphere", "radius": 1.0}, "loading": {"start": "relaxed", "penetration": 0.0}}


def by_roots(material):
    """The boundary elements' derivation."""
    spectrum = creep_spectrum(material.modulus, *material.spectrum)
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
    "2 branches": decades(2),
    "60 branches": decades(60),
    "60 branches in one decade": decades(60, span=1.0),
    "glassy modulus 1e9 times relaxed": decades(30, ratio=1e9),
    "glassy modulus 1.000001 times relaxed": decades(7, ratio=1e-6),
    "times 1e-9 apart": nearly_equal(1e-9),
    "times 1e-15 apart": nearly_equal(4 * np.finfo(float).eps),
    "tiny weights": material([1e-3, 1e-8, 1e-16, 1e-25, 3.0], [1e-4, 1e-2, 1.0, 30.0, 1e4]),
    "weight below sight": material([9.0, 1e-200], [1.0, 3.0]),
    "one weight below sight": material([1e-20], [3.0]),
    "small weight on a retardation time": material([9.0, 1e-9], [1.0, 10.0]),
    "times from 1e-58 to 1e58": material([1.0, 2.0, 3.0], [1e-58, 1.0, 1e58]),
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


def check_creep(there, creep, log_times):
    """Convolution with relaxation is time, the way back is the same, ``E(w) J(w) = 1``, times interlace."""
    times = 10.0**log_times
    for end in times:
        assert convolution(there, creep, end) == pytest.approx(end, rel=TOLERANCE)
    relaxed, branches = creep.relaxation()
    back = Material(relaxed, there.poisson, branches)
    times = np.concatenate([[0.0], times])
    np.testing.assert_allclose(
        back.relaxation_modulus(times), there.relaxation_modulus(times), rtol=TOLERANCE
    )
    product = there.complex_modulus(times) * creep.complex_compliance(times)
    np.testing.assert_allclose(product, 1.0, rtol=TOLERANCE)
    _, relaxation = there.spectrum
    assert creep.glassy == pytest.approx(1 / there.glassy_modulus, rel=1e-15)
    assert creep.relaxed == pytest.approx(1 / there.modulus, rel=1e-12)
    assert (creep.compliances > 0).all()
    assert (creep.times >= relaxation).all()
    assert (creep.times[:-1] <= relaxation[1:]).all()


@either
@pytest.mark.parametrize("name", MATERIALS)
def test_creep_of_wide_narrow_and_degenerate_spectra(name, creep_of):
    sample = MATERIALS[name]
    _, times = sample.spectrum
    first, last = (math.log10(times[0]), math.log10(times[-1])) if times.size else (0.0, 0.0)
    check_creep(sample, creep_of(sample), np.linspace(max(first, -20.0) - 2.0, min(last, 20.0) + 3.0, 15))
    other = creep_compliance(sample)
    np.testing.assert_allclose(creep_of(sample).times, other.times, rtol=1e-13)
    if "on a retardation time" not in name:
        np.testing.assert_allclose(creep_of(sample).compliances, other.compliances, rtol=1e-13)
        np.testing.assert_allclose(creep_of(sample).distances, other.distances, rtol=1e-13)


branch_lists = st.lists(
    st.tuples(st.floats(-12, 6), st.floats(-8, 8)).map(lambda p: (10.0 ** p[0], 10.0 ** p[1])),
    min_size=1,
    max_size=40,
)


@either
@settings(max_examples=30)
@given(branch_lists, st.floats(-9, 10))
def test_creep_of_any_spectrum_in_any_order(creep_of, branches, log_time):
    moduli, times = zip(*branches, strict=True)
    check_creep(material(moduli, times), creep_of(material(moduli, times)), np.array([log_time]))
    halves = material([m / 2 for m in moduli[::-1] for _ in "ab"], [t for t in times[::-1] for _ in "ab"])
    t = np.logspace(-10, 10, 21)
    np.testing.assert_allclose(creep_of(material(moduli, times))(t), creep_of(halves)(t), rtol=1e-11)


@either
def test_creep_by_hand(creep_of):
    """One branch: ``theta = tau Einf/E0``; two by the roots of a quadratic."""
    one = creep_of(material([9.0], [2.0]))
    assert one.times.tolist() == pytest.approx([20.0], rel=1e-15)
    assert one([-1.0, 0.0, 20.0]).tolist() == pytest.approx([0.0, 0.1, 1 - 0.9 / math.e], rel=1e-14)
    # (1 + s)(1 + 4 s) E(s) s = 1 + (5 + 2 + 12) s + 4 (1 + 2 + 3) s^2 for E0 = 1, (2, 1), (3, 4)
    root = math.sqrt(19.0**2 - 4.0 * 24.0)
    two = creep_of(material([2.0, 3.0], [1.0, 4.0]))
    np.testing.assert_allclose(two.times, [(19.0 - root) / 2, (19.0 + root) / 2], rtol=1e-14)


def test_storage_and_loss_modulus():
    sample, w = material([9.0], [2.0]), np.array([0.0, 0.25, 0.5, 1e3])
    p = 2.0 * w
    np.testing.assert_allclose(sample.storage_modulus(w), 1 + 9 * p**2 / (1 + p**2), rtol=1e-14)
    np.testing.assert_allclose(sample.loss_modulus(w), 9 * p / (1 + p**2), rtol=1e-14)
    assert sample.loss_modulus(1e300) == pytest.approx(4.5e-300)
    assert sample.storage_modulus(1e300) == 10.0


# Laws of few parameters


def of_scene(folder=".", **keys):
    return scene_from_dict({"material": {"poisson": 0.3} | keys} | OTHERS, folder).material


def worst_error(law):
    """Largest relative error of the power law in its range."""
    modulus, branches = law.series()
    t = np.geomspace(*law.range, 400)
    series = Material(modulus, 0.5, branches).relaxation_modulus(t) - law.relaxed
    return float(np.abs(series / (law.modulus * (t / law.time) ** -law.exponent) - 1.0).max())


def test_standard_linear_solid_is_exact():
    read = of_scene(model="standard-linear", relaxed=0.75, glassy=7.5, time=2.0)
    assert read == Material(0.75, 0.3, (Branch(6.75, 2.0),))


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
    law = PowerLawRelaxation(exponent, 3.0, 0.1, (first, first * 10.0**decades), error, relaxed=1e-3)
    assert worst_error(law) <= 1.000001 * error
    ratios = np.diff([math.log(branch.time) for branch in law.series()[1]])
    assert np.allclose(ratios, spacing_of(exponent, 0.5 * error), rtol=1e-9)


@pytest.mark.parametrize("exponent", [0.1, 0.5, 0.9])
def test_the_error_falls_with_the_one_asked_for(exponent):
    """Two-sided: the bound is met, and used by more than a tenth, at every accuracy."""
    for error in (1e-2, 1e-4, 1e-6, 1e-8):
        worst = worst_error(PowerLawRelaxation(exponent, 1.0, 1.0, (1e-3, 1e3), error))
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
    """``E(w) = E1 t1^n Gamma(1 - n) (i w)^n``, up to the branches left out at both ends, module head."""
    law = PowerLawRelaxation(n, 2.0, 0.5, (1e-4, 1e4), 1e-6)
    modulus, branches = law.series()
    w = np.geomspace(1e-6, 1e6, 61)
    exact = 2.0 * 0.5**n * gamma(1.0 - n) * (1j * w) ** n
    error = np.abs(Material(modulus, 0.5, branches).complex_modulus(w) / exact - 1.0)
    share = math.sin(math.pi * n) / math.pi
    fast = (w * branches[0].time) ** (1.0 - n) * share / (1.0 - n)
    slow = (w * branches[-1].time) ** -(1.0 + n) * share / (1.0 + n)
    assert (error <= fast + slow + 1e-4).all()
    assert (error >= 0.1 * np.maximum(fast, slow))[[0, 60]].all()


sizes = st.floats(1e-60, 1e60)


@given(st.floats(1e-6, 1.0 - 1e-6), sizes, sizes, st.tuples(sizes, sizes), st.floats(1e-12, 0.1))
def test_extreme_laws_are_expanded_or_refused(exponent, modulus, time, ends, error):
    try:
        relaxed, branches = PowerLawRelaxation(exponent, modulus, time, ends, error).series()
    except SceneError:
        return
    assert 1e-60 <= relaxed <= 1e60
    assert all(1e-61 < branch.time < 1e61 for branch in branches)


# Temperature

SERIES = {"modulus": 1.0, "branches": [{"modulus": 2.0, "time": 3.0}, {"modulus": 1.0, "time": 40.0}]}
BRANCHES = (Branch(2.0, 3.0), Branch(1.0, 40.0))
UNIVERSAL = {"model": "WLF", "c1": 17.44, "c2": 51.6, "reference_temperature": 373.15}
ACTIVATED = {"model": "Arrhenius", "activation_energy": 80e3, "reference_temperature": 300.0}


def factor(temperature, shift, folder="."):
    """The shift factor that all branches show."""
    read = of_scene(folder, **SERIES, temperature=temperature, shift=shift)
    assert [branch.modulus for branch in read.branches] == [2.0, 1.0]
    first, second = (new.time / old.time for new, old in zip(read.branches, BRANCHES, strict=True))
    assert first == pytest.approx(second, rel=1e-14)
    return first


def test_shift_factors_of_the_laws():
    """WLF: at ``c2`` above the reference ``10^(-c1/2)``. ``ln a_T = E/R (1/T - 1/T_ref)``."""
    assert factor(373.15, UNIVERSAL) == 1.0
    assert factor(373.15 + 51.6, UNIVERSAL) == pytest.approx(10 ** (-17.44 / 2), rel=1e-12)
    celsius = UNIVERSAL | {"reference_temperature": 100.0}
    assert factor(151.6, celsius) == pytest.approx(10 ** (-17.44 / 2), rel=1e-12)
    exact = math.exp(80e3 / 8.314462618 * (1 / 310 - 1 / 300))
    assert factor(310.0, ACTIVATED) == pytest.approx(exact, rel=1e-8)
    assert factor(290.0, ACTIVATED) > 1.0


@given(st.floats(330.0, 1000.0), st.floats(330.0, 1000.0))
def test_the_reference_temperature_may_be_moved(reference, temperature):
    """Ferry: the same material has ``c2' = c2 + d`` and ``c1' c2' = c1 c2`` at a reference moved by ``d``."""
    c1, c2 = 17.44, 51.6
    moved = reference - 373.15
    one, other = WLF(c1, c2, 373.15), WLF(c1 * c2 / (c2 + moved), c2 + moved, reference)
    expected = one.log_factor(temperature) - one.log_factor(reference)
    assert other.log_factor(temperature) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    there, back = Arrhenius(5e4, reference), Arrhenius(5e4, temperature)
    assert there.log_factor(temperature) == pytest.approx(-back.log_factor(reference), rel=1e-9, abs=1e-12)


def test_a_shift_goes_with_every_kind_of_material(tmp_path):
    (tmp_path / "modes.csv").write_text("tau,E\n3,2\n40,1\n")
    bulk = {"modulus": 5.0, "branches": [{"modulus": 1.0, "time": 7.0}]}
    at = {"temperature": 424.75, "shift": UNIVERSAL}
    for keys in (
        SERIES | {"bulk": bulk},
        {"modulus": 1.0, "file": "modes.csv", "format": "branches"},
        {"model": "standard-linear", "relaxed": 1.0, "glassy": 3.0, "time": 3.0},
    ):
        read = of_scene(tmp_path, **keys, **at)
        assert read.branches[0].modulus == 2.0
        assert read.branches[0].time == pytest.approx(3.0 * 10**-8.72, rel=1e-12)
        if isinstance(read.bulk, BulkRelaxation):
            assert read.bulk.branches[0].time == pytest.approx(7.0 * 10**-8.72, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "T,log_aT\nC,-\n100,-2\n20,0\n0,1\n",  # as pyvisco writes
        "temperature; aT\n0;10\n20;1\n100;.01\n",
    ],
)
def test_table_of_shift_factors(tmp_path, text):
    (tmp_path / "aT.csv").write_text(text)
    for shift in ({"file": "aT.csv"}, {"model": "file", "file": "aT.csv"}):
        found = [factor(at, shift, tmp_path) for at in (20.0, 60, 10.0)]
        assert found == pytest.approx([1.0, 0.1, 10**0.5], rel=1e-12)
    with pytest.raises(SceneError, match=r"material\.temperature: got 101\.0; allowed: 0 to 100"):
        factor(101.0, {"file": "aT.csv"}, tmp_path)


@given(st.sampled_from([WLF, Arrhenius]), st.lists(st.floats(), min_size=4, max_size=4))
def test_whatever_the_numbers_times_are_usable_or_refused(kind, numbers):
    *keys, temperature = numbers
    try:
        shift = kind(*keys[: 3 if kind is WLF else 2])
        shifted = at_temperature(Material(1.0, 0.5, BRANCHES), shift, temperature)
    except SceneError:
        return
    assert all(1e-60 <= branch.time <= 1e60 for branch in shifted.branches)


def test_a_table_in_python():
    assert ShiftTable((20.0, 0.0), (0.0, 2.0)).log_factor(10.0) == pytest.approx(math.log(10.0), rel=1e-14)
    for temperatures in ((1.0,), (1.0, 1.0)):
        with pytest.raises(SceneError, match="temperature"):
            ShiftTable(temperatures, temperatures)
