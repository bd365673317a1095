"""Time-temperature superposition: times scaled, moduli as they were; tables of shift factors, bad values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_scene import Branch, BulkRelaxation, Material, SceneError, scene_from_dict
from contact_scene.temperature_shift import WLF, Arrhenius, ShiftTable, at_temperature

OTHERS = {
    "indenter": {"shape": "sphere", "radius": 1.0},
    "loading": {"start": "relaxed", "penetration": 0.0},
}
SERIES = {
    "modulus": 1.0,
    "poisson": 0.3,
    "branches": [{"modulus": 2.0, "time": 3.0}, {"modulus": 1.0, "time": 40.0}],
}
BRANCHES = (Branch(2.0, 3.0), Branch(1.0, 40.0))
UNIVERSAL = {"model": "WLF", "c1": 17.44, "c2": 51.6, "reference_temperature": 373.15}
ACTIVATED = {"model": "Arrhenius", "activation_energy": 80e3, "reference_temperature": 300.0}


def material(folder=".", **keys):
    return scene_from_dict({"material": SERIES | keys} | OTHERS, folder).material


def factor(read):
    """The shift factor that all branches show."""
    assert [branch.modulus for branch in read.branches] == [2.0, 1.0]
    first, second = (new.time / old.time for new, old in zip(read.branches, BRANCHES, strict=True))
    assert first == pytest.approx(second, rel=1e-14)
    return first


def test_wlf_of_a_known_series():
    """At ``c2`` above the reference ``a_T = 10^(-c1/2)``; at the reference 1."""
    assert material(temperature=373.15, shift=UNIVERSAL) == material()
    read = material(temperature=373.15 + 51.6, shift=UNIVERSAL)
    assert factor(read) == pytest.approx(10 ** (-17.44 / 2), rel=1e-12)
    celsius = UNIVERSAL | {"reference_temperature": 100.0}
    assert factor(material(temperature=151.6, shift=celsius)) == pytest.approx(factor(read), rel=1e-12)
    t = np.geomspace(1e-12, 1e-6, 20)
    np.testing.assert_allclose(
        read.relaxation_modulus(t), material().relaxation_modulus(t * 10 ** (17.44 / 2)), rtol=1e-11
    )


def test_arrhenius_of_a_known_series():
    """``ln a_T = E/R (1/T - 1/T_ref)``: faster when hot, slower when cold."""
    read = material(temperature=310.0, shift=ACTIVATED)
    assert factor(read) == pytest.approx(math.exp(80e3 / 8.314462618 * (1 / 310 - 1 / 300)), rel=1e-8)
    assert factor(read) < 1.0 < factor(material(temperature=290.0, shift=ACTIVATED))


@given(st.floats(250.0, 500.0), st.floats(250.0, 500.0))
def test_shifts_between_two_temperatures_and_back(one, other):
    """``a_T`` from one temperature to another is the inverse of the way back."""
    there, back = Arrhenius(5e4, one), Arrhenius(5e4, other)
    shifted = at_temperature(at_temperature(Material(1.0, 0.5, BRANCHES), there, other), back, one)
    for new, old in zip(shifted.branches, BRANCHES, strict=True):
        assert new.time == pytest.approx(old.time, rel=1e-12)


@given(st.floats(330.0, 1000.0), st.floats(330.0, 1000.0))
def test_the_reference_temperature_of_wlf_may_be_moved(reference, temperature):
    """Ferry: the same material has ``c2' = c2 + d`` and ``c1' c2' = c1 c2`` at a reference moved by ``d``."""
    c1, c2 = 17.44, 51.6
    moved = reference - 373.15
    one = WLF(c1, c2, 373.15)
    other = WLF(c1 * c2 / (c2 + moved), c2 + moved, reference)
    expected = one.log_factor(temperature) - one.log_factor(reference)
    assert other.log_factor(temperature) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_bulk_relaxation_is_shifted_too():
    bulk = {"modulus": 5.0, "branches": [{"modulus": 1.0, "time": 7.0}]}
    read = material(temperature=424.75, shift=UNIVERSAL, bulk=bulk)
    (branch,) = read.bulk.branches
    assert read.bulk == BulkRelaxation(5.0, (Branch(1.0, branch.time),))
    assert branch.time == pytest.approx(7.0 * 10**-8.72, rel=1e-12)


def test_a_shift_goes_with_every_kind_of_material(tmp_path):
    (tmp_path / "modes.csv").write_text("tau,E\n3,2\n40,1\n")
    at = {"temperature": 424.75, "shift": UNIVERSAL, "poisson": 0.3}
    for keys in (
        {"modulus": 1.0, "file": "modes.csv", "format": "branches"},
        {"model": "standard-linear", "relaxed": 1.0, "glassy": 3.0, "time": 3.0},
    ):
        read = scene_from_dict({"material": keys | at} | OTHERS, tmp_path).material
        assert read.branches[0].modulus == 2.0
        assert read.branches[0].time == pytest.approx(3.0 * 10**-8.72, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "T,log_aT\nC,-\n100,-2\n20,0\n0,1\n",  # as pyvisco writes
        "# shift factors\nT a_T\n0 10\n20 1\n100 0.01\n",
        "temperature; aT\n0;10\n20;1\n100;.01\n",
    ],
)
def test_table_of_shift_factors(tmp_path, text):
    (tmp_path / "aT.csv").write_text(text)
    for shift in ({"file": "aT.csv"}, {"model": "file", "file": "aT.csv"}):
        assert material(tmp_path, temperature=20.0, shift=shift) == material()
        assert factor(material(tmp_path, temperature=60, shift=shift)) == pytest.approx(0.1, rel=1e-12)
        assert factor(material(tmp_path, temperature=10.0, shift=shift)) == pytest.approx(10**0.5, rel=1e-12)
    with pytest.raises(SceneError, match=r"material\.temperature: got 101\.0; allowed: 0 to 100"):
        material(tmp_path, temperature=101.0, shift={"file": "aT.csv"})


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("", "the file is empty"),
        ("T,log_aT\n", "no rows"),
        ("1,2\n3,4\n", "columns"),
        ("T,f\n1,2\n3,4\n", "columns"),
        ("T,log_aT\n1,2\n", "temperatures: 1 rows"),
        ("T,log_aT\n1,2\n1,3\n", "temperature: 1 comes twice"),
        ("T,a_T\n1,2\n2,0\n", "a_T, line 3"),
        ("T,log_aT\n1,2\n2,nan\n", "log_aT, line 3"),
        ("T,log_aT\n1,2\n2\n", "line 3: 1 cells"),
    ],
)
def test_bad_tables_of_shift_factors(tmp_path, text, where):
    (tmp_path / "aT.csv").write_text(text)
    with pytest.raises(SceneError) as caught:
        material(tmp_path, temperature=1.0, shift={"file": "aT.csv"})
    assert str(caught.value).startswith(f"{tmp_path / 'aT.csv'}: {where}")
    assert "; allowed: " in str(caught.value)


@pytest.mark.parametrize(
    ("keys", "where", "allowed"),
    [
        ({"temperature": 300.0}, "shift", "together"),
        ({"shift": UNIVERSAL}, "temperature", "together"),
        ({"temperature": 321.5, "shift": UNIVERSAL}, "temperature", "c2 = 321.55"),
        ({"temperature": 100.0, "shift": UNIVERSAL}, "temperature", "c2 = 321.55"),
        ({"temperature": 321.550001, "shift": UNIVERSAL}, "temperature", "30 decades"),
        ({"temperature": 340.0, "shift": UNIVERSAL}, "temperature", "30 decades"),
        ({"temperature": 25.0, "shift": ACTIVATED}, "temperature", "kelvin"),
        ({"temperature": -20.0, "shift": ACTIVATED}, "temperature", "kelvin"),
        (
            {"temperature": 25.0, "shift": ACTIVATED | {"reference_temperature": 20.0}},
            "shift.reference_temperature",
            "kelvin",
        ),
        (
            {"temperature": 250.0, "shift": ACTIVATED | {"activation_energy": 9e5}},
            "temperature",
            "30 decades",
        ),
        ({"temperature": 210.0, "shift": {"file": "aT.csv"}}, "temperature", "30 decades"),
        ({"temperature": 300.0, "shift": {"model": "file"}}, "shift.file", "a_T"),
        ({"temperature": 300.0, "shift": {"file": "x", "c1": 1.0}}, "shift.c1", "model, file"),
    ],
)
def test_bad_values_get_one_line(tmp_path, keys, where, allowed):
    (tmp_path / "aT.csv").write_text("T,log_aT\n200,40\n300,0\n")
    with pytest.raises(SceneError) as caught:
        material(tmp_path, **keys)
    line = str(caught.value)
    assert line.startswith(f"material.{where}")
    assert allowed in line.split("; allowed: ")[1]
    assert "\n" not in line


finite = st.floats(allow_nan=True, allow_infinity=True)


@given(st.sampled_from([WLF, Arrhenius]), st.lists(finite, min_size=4, max_size=4))
def test_whatever_the_numbers_times_are_usable_or_refused(kind, numbers):
    *keys, temperature = numbers
    try:
        shift = kind(*keys[: 3 if kind is WLF else 2])
        shifted = at_temperature(Material(1.0, 0.5, BRANCHES), shift, temperature)
    except SceneError:
        return
    assert all(1e-60 <= branch.time <= 1e60 for branch in shifted.branches)


def test_a_table_in_python():
    table = ShiftTable((20.0, 0.0), (0.0, 2.0))
    assert table.log_factor(10.0) == pytest.approx(math.log(10.0), rel=1e-14)
    with pytest.raises(SceneError, match="two rows"):
        ShiftTable((1.0,), (0.0,))
