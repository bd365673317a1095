"""Reading pyvisco's coefficient tables; the samples are written here in the form that pyvisco 2.1 writes."""

from __future__ import annotations

import numpy as np
import pytest

from contact_scene import Material, SceneError, read_scene, scene_from_dict

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
OTHERS = {
    "indenter": {"shape": "sphere", "radius": 1.0},
    "loading": {"start": "relaxed", "penetration": 0.0},
}


def material(folder, text, **keys):
    (folder / "x.csv").write_text(text, encoding="utf-8")
    table = {"file": "x.csv", "poisson": 0.25} | keys
    return scene_from_dict({"material": table} | OTHERS, folder).material


def pairs(material):
    return [(b.modulus, b.time) for b in material.branches]


def test_time_domain(tmp_path):
    read = material(tmp_path, TIME)
    assert read.modulus == pytest.approx(4.0, rel=1e-14)
    assert read.glassy_modulus == pytest.approx(20.0, rel=1e-14)
    assert np.allclose(pairs(read), [(10, 0.01), (0, 1), (6, 100)], rtol=1e-14)
    # the formula of pyvisco's own fit function
    t = np.array([0.0, 0.005, 3.0, 1e5])
    series = 20.0 * (1 - 0.8 + 0.5 * np.exp(-t / 0.01) + 0.3 * np.exp(-t / 100.0))
    np.testing.assert_allclose(read.relaxation_modulus(t), series, rtol=1e-13)


def test_relaxed_modulus_of_the_scene_sets_the_scale(tmp_path):
    read = material(tmp_path, TIME, modulus=4e6)
    assert read.modulus == 4e6
    assert np.allclose(pairs(read), [(10e6, 0.01), (0, 1), (6e6, 100)], rtol=1e-14)


def test_frequency_domain_needs_a_relaxed_modulus(tmp_path):
    with pytest.raises(SceneError, match=r"x\.csv: alpha_i: .*; allowed: .*modulus in the scene"):
        material(tmp_path, FREQUENCY)
    read = material(tmp_path, FREQUENCY, modulus=2)
    assert read.modulus == 2.0
    assert read.glassy_modulus == pytest.approx(10.0, rel=1e-14)
    assert np.allclose(pairs(read), [(5.6, 0.01), (0.8, 1), (1.6, 100)], rtol=1e-14)
    with pytest.raises(SceneError, match=r"material\.modulus: got 10, and E_0 is 10; allowed: .*below E_0"):
        material(tmp_path, FREQUENCY, modulus=10.0)


def test_shear_moduli_become_young_s(tmp_path):
    read = material(tmp_path, TIME.replace("E_", "G_"))
    assert read.glassy_modulus == pytest.approx(2 * 1.25 * 20.0)
    assert read.modulus == pytest.approx(2 * 1.25 * 4.0)
    assert material(tmp_path, TIME.replace("E_", "G_"), modulus=4.0) == material(tmp_path, TIME, modulus=4.0)


@pytest.mark.parametrize(
    "text",
    [
        "tau_i,alpha_i\n0.01,0.5\n1.0,0.0\n100,0.3\n",
        "\ufefftau_i , alpha_i\r\ns,-\r\n\r\n 0.01, 0.5\r\n1e0,0\r\n1e2,.3\r\n",
        "# by hand\nalpha_i,tau_i,remark\n-,s,-\n.5,.01,a\n0,1,b\n.3,100,c\n",
    ],
    ids=["no units, no E_0", "BOM, CRLF, blanks", "comments, another order, more columns"],
)
def test_variants_of_the_table(tmp_path, text):
    assert material(tmp_path, text, modulus=4.0) == material(tmp_path, TIME, modulus=4.0)


def test_moduli_in_place_of_fractions(tmp_path):
    text = "tau_i,E_0,E_i\ns,MPa,MPa\n0.01,20,10\n1,20,0\n100,20,6\n"
    assert np.allclose(pairs(material(tmp_path, text)), [(10, 0.01), (0, 1), (6, 100)], rtol=1e-14)
    assert material(tmp_path, text).modulus == pytest.approx(4.0)


def test_separate_bulk_goes_with_a_table(tmp_path):
    read = material(tmp_path, TIME, bulk="elastic")
    assert read == Material(read.modulus, 0.25, read.branches, "elastic")


def test_scene_file_names_the_table_beside_it(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "x.csv").write_text(TIME)
    (tmp_path / "sub" / "scene.toml").write_text(
        '[material]\nfile = "x.csv"\npoisson = 0.5\n[indenter]\nshape = "sphere"\nradius = 1\n'
        '[loading]\nstart = "relaxed"\npenetration = 0\n'
    )
    assert read_scene(tmp_path / "sub" / "scene.toml").material.modulus == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("", "the file is empty"),
        ("f,E_stor,E_loss\nHz,MPa,MPa\n1,2,3\n", "columns"),  # a master curve, not coefficients
        ("tau_i,E_i\ns,MPa\n1,2\n", "columns"),
        ("tau_i,alpha_i,tau_i\n1,0.5,1\n", "columns"),
        ("i,tau_i,alpha_i,E_0,E_i\n-,s,-,MPa,MPa\n", "no rows of numbers"),
        (TIME.replace("100.0", "0"), "tau_i, line 5"),
        (TIME.replace("100.0", "-1"), "tau_i, line 5"),
        (TIME.replace("100.0", "nan"), "tau_i, line 5"),
        (TIME.replace("100.0", "soon"), "tau_i, line 5"),
        (TIME.replace(",0.3,", ",-0.3,"), "alpha_i, line 5"),
        (TIME.replace(",0.3,", ",,"), "alpha_i, line 5"),
        (TIME.replace(",0.3,", ",inf,"), "alpha_i, line 5"),
        (TIME.replace(",0.3,", ",0.6,"), "alpha_i"),
        (TIME.replace("0.3,20.0", "0.3,21.0"), "E_0"),
        (TIME.replace("20.0", "0.0"), "E_0, line 3"),
        (TIME.replace("3,100.0", "100.0"), "line 5"),
        ("tau_i,alpha_i\n1,0.5\n", "E_0"),
        ('tau_i,alpha_i\n"1,0.5\n', "line 2"),
        ("tau_i,alpha_i,E_0,E_i\ns,-,Pa,Pa\n1,0.4,10,4.04\n2,0.5,10,2\n", "line 4: alpha_i is 0.5, but"),
    ],
)
def test_bad_tables(tmp_path, text, where):
    with pytest.raises(SceneError) as caught:
        material(tmp_path, text)
    line = str(caught.value)
    assert line.startswith(f"{tmp_path / 'x.csv'}: {where}")
    assert "; allowed: " in line
    assert "\n" not in line


def test_keys_of_the_scene(tmp_path):
    for keys, where in [
        ({"branches": []}, "material.branches"),
        ({"modulus": -1.0}, "material.modulus"),
        ({"file": 3}, "material.file"),
    ]:
        with pytest.raises(SceneError) as caught:
            material(tmp_path, TIME, **keys)
        assert str(caught.value).startswith(where)
    assert material(tmp_path, TIME, format="pyvisco") == material(tmp_path, TIME)


def test_poisson_is_checked_before_shear_is_converted(tmp_path):
    with pytest.raises(SceneError, match="poisson: got 0\\.6"):
        material(tmp_path, TIME.replace("E_", "G_"), poisson=0.6)
