"""Files of Prony series and of measured moduli: what each format means, one clear error for what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from contact_scene import Branch, Material, SceneError, scene_from_dict
from contact_scene.material_file import format_of, measured_data, read_material, read_measured

# As "Save Modes" of RepTate 1.0 writes it; moduli are shear moduli.
REPTATE = """# Maxwell modes
# Generated with RepTate v1.0.0 20200330
# At 12:58:24 on Mon May 11, 2020

#number of modes
3

#   i\t          tau_i\t            G_i
    1\t      0.0013869\t    1.42029e+08
    2\t      0.0344828\t    1.06538e+07
    3\t        21.3164\t              0

#end"""
PAIRS = [(3 * 1.42029e8, 0.0013869), (3 * 1.06538e7, 0.0344828), (0.0, 21.3164)]
OTHERS = {"indenter": {"shape": "sphere", "radius": 1.0}, "loading": {"start": "relaxed", "penetration": 0.0}}
KNOWN = Material(1.0, 0.5, (Branch(5.0, 0.01), Branch(2.0, 1.0)))
TIMES = np.geomspace(1e-3, 30.0, 25)


def in_scene(folder, text, **keys):
    (folder / "x.txt").write_text(text, encoding="utf-8")
    table = {"file": "x.txt", "poisson": 0.5} | keys
    return scene_from_dict({"material": table} | OTHERS, folder).material


def pairs(material):
    return [(branch.modulus, branch.time) for branch in material.branches]


def rows(*columns):
    return "\n".join(" ".join(map(repr, map(float, row))) for row in zip(*columns, strict=True)) + "\n"


def test_modes_of_reptate(tmp_path):
    with pytest.raises(SceneError, match=r"^material\.modulus: .*no relaxed modulus; allowed: .*> 0"):
        in_scene(tmp_path, REPTATE, format="reptate")
    with pytest.raises(SceneError, match=r"x\.txt: holds a Prony series \(reptate\), not measured data"):
        read_measured(tmp_path / "x.txt")
    read = in_scene(tmp_path, REPTATE, format="reptate", modulus=6e5)
    assert read.modulus == 6e5
    np.testing.assert_allclose(pairs(read), PAIRS, rtol=1e-14)
    compressible = in_scene(tmp_path, REPTATE, format="reptate", modulus=6e5, poisson=0.25)
    assert compressible.branches[0].modulus == pytest.approx(2.5 * 1.42029e8, rel=1e-14)
    assert read_material(tmp_path / "x.txt", modulus=6e5) == read
    by_hand = "3\n1 0.0013869 1.42029e8\n2 .0344828 1.06538e7 # slow\n3 21.3164 0\n"
    assert in_scene(tmp_path, by_hand, format="reptate", modulus=6e5) == read
    assert format_of(by_hand, "") == "reptate"
    assert in_scene(tmp_path, by_hand[2:], format="reptate", modulus=6e5) == read


@pytest.mark.parametrize(
    "text",
    [
        "tau,E\n0.01,5\n1,2\n",
        "0.01 5\n1 2\n",
        "# tau E_i\n1e-2\t5.0\n1.0\t2.0\n",
        "\ufefftau [s]; E [MPa]\r\n.01;5\r\n1;2\r\n",
        "relaxation_time,modulus\ns,Pa\n0.01,5\n1,2\n",
    ],
)
def test_plain_tables_of_branches(tmp_path, text):
    assert in_scene(tmp_path, text, format="branches", modulus=1.0) == KNOWN
    if "E_i" in text:
        shear = in_scene(tmp_path, text.replace("E_i", "G_i"), format="branches", modulus=1.0)
        assert pairs(shear) == [(15.0, 0.01), (6.0, 1.0)]


@pytest.mark.parametrize(
    "header",
    [
        "",
        "t,E\n",
        "t,E_relax\ns,MPa\n",
        "# columns: t, E\n",
        "# made by hand, on a Monday\n",
        "# date: Monday\n",
        "# t E\n# s MPa\n",
        "a preamble of the instrument\n",
    ],
)
def test_measured_relaxation(tmp_path, header):
    text = header + rows(TIMES[::-1], KNOWN.relaxation_modulus(TIMES[::-1]))  # in any order
    read = in_scene(tmp_path, text, format="relaxation")
    np.testing.assert_allclose(pairs(read), pairs(KNOWN), rtol=1e-9)
    assert read.modulus == pytest.approx(1.0, rel=1e-9)
    assert read_material(tmp_path / "x.txt") == read


def test_measured_storage_and_loss(tmp_path):
    w = 1.0 / TIMES
    parts = KNOWN.storage_modulus(w), KNOWN.loss_modulus(w)
    for header, frequency, scale in [
        ("", w, 1.0),
        ("T=140;Mw=116000;Mn=37000\n", w, 1.0),  # RepTate .tts
        ("omega [rad/s], E' [MPa], E'' [MPa]\n", w, 1.0),
        ('angular_frequency,storage,"loss"\n', w, 1.0),
        ("f,E_stor,E_loss\nHz,MPa,MPa\n", w / (2 * np.pi), 1.0),  # pyvisco
        ("w G' G\"\n", w, 3.0),
        ("Frequency (Hz)\tStorage Modulus (Pa)\tLoss Modulus (Pa)\n", w / (2 * np.pi), 1.0),
        ("f [Hz] G' [Pa] G'' [Pa]\n", w / (2 * np.pi), 3.0),
        ("# storage modulus\nloss and storage modulus by frequency\n", w, 1.0),  # titles
    ]:
        text = header + rows(frequency, *parts)
        read = in_scene(tmp_path, text, format="dynamic")
        expected = [(scale * modulus, time) for modulus, time in pairs(KNOWN)]
        np.testing.assert_allclose(pairs(read), expected, rtol=1e-9, err_msg=header)
        assert read_material(tmp_path / "x.txt") == read


def test_data_files_of_reptate_hold_shear_moduli():
    text = "T=140;Mw=116000;Mn=37000\n1 2 3\n2 3 4\n"
    assert measured_data(text, "PB.tts", "dynamic").shear
    assert not measured_data(text, "PB.txt", "dynamic").shear
    assert not measured_data("w E' E''\n1 2 3\n", "PB.tts", "dynamic").shear


@pytest.mark.parametrize(
    ("head", "strain"), [("gamma=1;", 1.0), ("Mw=230;gamma=0.05; ", 0.05), ("Mw=2;", 1.0)]
)
def test_stress_of_reptate_after_a_step_of_strain(head, strain):
    for name in ("sxy", "Gt"):
        read = measured_data(f"{head}\nt {name}\ns Pa\n0.1\t9\n1 5\n2 3\n", "PB.gt", "relaxation")
        assert read.shear
        assert read.units == ("s", "Pa")
        expected = np.array([9.0, 5.0, 3.0]) / (strain if name == "sxy" else 1.0)
        np.testing.assert_allclose(read.moduli, expected, rtol=1e-15)
        assert format_of(f"{head}\nt {name}\n0.1\t9\n1 5\n2 3\n", "PB.gt") == "relaxation"


def test_data_of_one_temperature_may_say_so():
    text = "t,E,T\n1,3,20\n2,2,20\n3,1,{}\n"
    assert list(measured_data(text.format(20), "x", "relaxation").moduli) == [3.0, 2.0, 1.0]
    with pytest.raises(SceneError, match=r"^x: temperature: differs between rows; allowed: moduli at one"):
        measured_data(text.format(30), "x", "relaxation")


def test_formats_are_told_apart():
    for text, kind in {
        "i,tau_i,alpha_i,E_0,E_i\n-,s,-,MPa,MPa\n1,0.01,0.5,20.0,10.0\n": "pyvisco",
        "tau_i,E_0,E_i\n1,2,3\n": "pyvisco",
        "# i,tau_i,alpha_i,E_0,E_i\n1,0.01,0.5,20.0,10.0\n": "pyvisco",
        REPTATE: "reptate",
        "tau,E\n1,2\n": "branches",
        "1,2\n": "relaxation",
        "1 2 3\n": "dynamic",
        "f,G_stor,G_loss\n1,2,3\n": "dynamic",
    }.items():
        assert format_of(text, "x") == kind
    for text in ("a,b\n1,2\n", "1 2 3 4\n", "T,log_aT\n1,2\n"):
        with pytest.raises(SceneError, match=r"allowed: tau, E \| t, E"):
            format_of(text, "x")
    with pytest.raises(SceneError, match="format"):
        read_material(__file__, format="excel")


# Coefficients of pyvisco

# A fit in the time domain: E_0 = 20 MPa, a fifth of it is left at the end.
TIME = """i,tau_i,alpha_i,E_0,E_i
-,s,-,MPa,MPa
1,0.01,0.5,20.0,10.0
2,1.0,0.0,20.0,0.0
3,100.0,0.3,20.0,6.0
"""
# A fit in the frequency domain: the fractions are normalised to 1, but for the last bit.
FREQUENCY = """i,tau_i,alpha_i,E_0,E_i
-,s,-,MPa,MPa
1,0.01,0.7,10.0,7.0
2,1.0,0.1,10.0,1.0
3,100.0,0.19999999999999996,10.0,2.0
"""


def of_pyvisco(folder, text, **keys):
    return in_scene(folder, text, **{"poisson": 0.25} | keys)


def test_coefficients_of_the_time_domain(tmp_path):
    read = of_pyvisco(tmp_path, TIME)
    assert read.modulus == pytest.approx(4.0, rel=1e-14)
    assert read.glassy_modulus == pytest.approx(20.0, rel=1e-14)
    assert np.allclose(pairs(read), [(10, 0.01), (0, 1), (6, 100)], rtol=1e-14)
    # the formula of pyvisco's own fit function
    t = np.array([0.0, 0.005, 3.0, 1e5])
    series = 20.0 * (1 - 0.8 + 0.5 * np.exp(-t / 0.01) + 0.3 * np.exp(-t / 100.0))
    np.testing.assert_allclose(read.relaxation_modulus(t), series, rtol=1e-13)


def test_relaxed_modulus_of_the_scene_sets_the_scale(tmp_path):
    read = of_pyvisco(tmp_path, TIME, modulus=4e6)
    assert read.modulus == 4e6
    assert np.allclose(pairs(read), [(10e6, 0.01), (0, 1), (6e6, 100)], rtol=1e-14)


def test_frequency_domain_needs_a_relaxed_modulus(tmp_path):
    with pytest.raises(SceneError, match=r"x\.txt: alpha_i: .*; allowed: .*modulus in the scene"):
        of_pyvisco(tmp_path, FREQUENCY)
    read = of_pyvisco(tmp_path, FREQUENCY, modulus=2)
    assert read.modulus == 2.0
    assert read.glassy_modulus == pytest.approx(10.0, rel=1e-14)
    assert np.allclose(pairs(read), [(5.6, 0.01), (0.8, 1), (1.6, 100)], rtol=1e-14)
    with pytest.raises(SceneError, match=r"material\.modulus: got 10, and E_0 is 10; allowed: .*below E_0"):
        of_pyvisco(tmp_path, FREQUENCY, modulus=10.0)


def test_shear_coefficients_become_young_s(tmp_path):
    read = of_pyvisco(tmp_path, TIME.replace("E_", "G_"))
    assert read.glassy_modulus == pytest.approx(2 * 1.25 * 20.0)
    assert read.modulus == pytest.approx(2 * 1.25 * 4.0)
    assert of_pyvisco(tmp_path, TIME.replace("E_", "G_"), modulus=4.0) == of_pyvisco(
        tmp_path, TIME, modulus=4.0
    )


PYVISCO = {
    "no units, no E_0": "tau_i,alpha_i\n0.01,0.5\n1.0,0.0\n100,0.3\n",
    "BOM, CRLF, blanks": "\ufefftau_i , alpha_i\r\ns,-\r\n\r\n 0.01, 0.5\r\n1e0,0\r\n1e2,.3\r\n",
    "another order, more columns": "# by hand\nalpha_i,tau_i,remark\n-,s,-\n.5,.01,a\n0,1,b\n.3,100,c\n",
    "moduli in place of fractions": "tau_i,E_0,E_i\ns,MPa,MPa\n0.01,20,10\n1,20,0\n100,20,6\n",
}


@pytest.mark.parametrize("name", PYVISCO)
def test_variants_of_the_table(tmp_path, name):
    assert of_pyvisco(tmp_path, PYVISCO[name], modulus=4.0) == of_pyvisco(tmp_path, TIME, modulus=4.0)


# Any text

names = ["t", "T", "f", "w", "tau", "tau_i", "alpha_i", "E_0", "E", "G", "E'", "G''", "a_T", "log_aT"]
names += ["modulus", "#", "T=3;E", "nan", "1e400", "-1", "0", "1_0"]
cells = st.sampled_from(names) | st.floats().map(repr) | st.floats(1e-3, 1e3).map(repr) | st.text(max_size=3)
files = st.tuples(
    st.lists(st.lists(cells, max_size=4), max_size=6), st.sampled_from([",", ";", " ", "\t", ", "])
)


@given(files, st.sampled_from(["pyvisco", "reptate", "branches", "relaxation", "dynamic", None]))
@example(([[]], ","), None)
def test_any_text_is_a_material_or_one_line(tmp_path_factory, file, form):
    lines, separator = file
    path = tmp_path_factory.getbasetemp() / "any.txt"
    path.write_text("\n".join(separator.join(line) for line in lines), encoding="utf-8")
    try:
        material = read_material(path, modulus=1.0, format=form)
    except SceneError as error:
        refusal = str(error)
    else:
        refusal = "a line; allowed: anything"
        assert material.modulus == 1.0
        assert np.isfinite(material.relaxation_modulus([0.0, 1.0])).all()
    assert refusal.isprintable()
    assert "; allowed: " in refusal
