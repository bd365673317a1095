"""The table [adhesion]: what is read, written and refused."""

import math

import pytest
from numpy.testing import assert_allclose

import contact_scene as cs

LAWS = {
    "hysteresis": cs.Adhesion(5e-4, 0.013, 2e-4),
    "power": cs.Adhesion(5e-4, 0.013, None, cs.PowerRate(1e-3, 0.5)),
    "table": cs.Adhesion(5e-4, 0.013, 1e-4, cs.RateTable((1e-4, 1e-2), (6e-4, 2e-3))),
    "stress": cs.Adhesion(5e-4, stress=0.2),
}


def asked(**adhesion):
    return {
        "material": {"modulus": 0.75, "poisson": 0.5},
        "indenter": {"shape": "sphere", "radius": 1.0},
        "adhesion": adhesion,
        "loading": {"start": "relaxed", "penetration": 0.0},
    }


@pytest.mark.parametrize("law", LAWS)
def test_a_written_scene_is_read_as_the_same(law, tmp_path):
    scene = cs.Scene(cs.Material(0.75, 0.5), cs.Sphere(1.0), cs.Loading("relaxed", 0.0, ()), LAWS[law])
    cs.write_scene(scene, tmp_path / "scene.toml")
    assert cs.read_scene(tmp_path / "scene.toml") == scene


def test_works_of_the_two_laws():
    power = cs.Adhesion(2.0, 0.1, None, cs.PowerRate(0.5, 2.0))
    assert power.opening(0.0) == 2.0
    assert power.opening(1.0) == 10.0
    assert power.opening(math.inf) == math.inf
    table = cs.Adhesion(2.0, 0.1, 1.0, cs.RateTable((1.0, 100.0), (4.0, 16.0)))
    assert [table.opening(v) for v in (0.0, 0.5, 1.0, 1e9)] == [2.0, 3.0, 4.0, 16.0]
    assert_allclose(table.opening(10.0), 8.0, rtol=1e-12)  # half way in log-log
    assert (power.closing, table.closing) == (2.0, 1.0)
    assert not power.reversible
    assert cs.Adhesion(2.0, 0.1, 2.0).reversible


def test_a_fixed_stress_has_the_width_of_maugis_at_rest():
    scene = cs.scene_from_dict(asked(work=5e-4, stress=0.2))
    assert scene.adhesion is not None
    assert_allclose(scene.adhesion.zone, math.pi * 1.0 * 5e-4 / (4.0 * 0.2**2), rtol=1e-14)
    with pytest.raises(cs.SceneError, match=r"^stress: the process zone would be .*from 1e-60"):
        cs.scene_from_dict(asked(work=5e-4, stress=1e30))
