"""Scene files: writing and reading give the same scene back."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_scene_malformed import GOOD

from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    PowerLaw,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Sweep,
    Table,
    TabulatedProfile,
    UnsupportedScene,
    read_scene,
    scene_from_dict,
    write_scene,
)

finite = st.floats(-1e60, 1e60)
positive = st.floats(1e-60, 1e60)
not_negative = st.one_of(st.just(0.0), st.floats(0.0, 1e60))
branches = st.lists(st.builds(Branch, st.floats(0.0, 1e58), positive), max_size=4).map(tuple)
materials = st.one_of(
    st.builds(Material, st.floats(1e-60, 1e59), st.floats(0.0, 0.5), branches),
    st.builds(
        Material,
        st.floats(1e-60, 1e59),
        st.floats(0.0, 0.49),
        branches,
        st.one_of(st.just("elastic"), st.builds(BulkRelaxation, st.none() | positive, branches)),
    ),
)
profiles = st.lists(st.floats(0.0, 1e3), min_size=2, max_size=6).map(
    lambda rises: TabulatedProfile(
        tuple(0.5 * n for n in range(len(rises) + 2)),
        (0.0, 0.1, *(0.1 + sum(rises[: n + 1]) for n in range(len(rises)))),
    )
)
indenters = st.one_of(
    st.builds(Sphere, positive),
    st.builds(Cone, st.floats(1e-6, 89.999)),
    st.builds(FlatPunch, st.just(1e60)),
    st.builds(PowerLaw, st.floats(1.0, 100.0), st.floats(1e-300, 1e300)),
    profiles,
)
tables = st.lists(st.tuples(st.integers(1, 1000), finite), min_size=2, max_size=5).map(
    lambda rows: Table(
        tuple(float(sum(r[0] for r in rows[: n + 1])) for n in range(len(rows))), tuple(r[1] for r in rows)
    )
)
steps = st.one_of(
    st.builds(Ramp, finite, positive),
    st.builds(Hold, not_negative),
    st.builds(Force, finite, not_negative),
    st.builds(ForceRamp, finite, positive),
    st.builds(Oscillate, finite, positive, positive, finite),
    st.builds(Sweep, finite, positive, positive),
    tables,
)
scenes = st.builds(
    Scene,
    materials,
    indenters,
    st.builds(
        Loading, st.sampled_from(["jump-in", "relaxed"]), finite, st.lists(steps, max_size=4).map(tuple)
    ),
    st.none() | st.builds(Adhesion, not_negative, st.floats(1e-60, 1e59)),
    st.text(st.characters(codec="utf-8"), max_size=20),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples of a fuzz test."""
    return tmp_path_factory.mktemp("scenes")


@given(scenes)
def test_round_trip(folder, scene):
    write_scene(scene, folder / "scene.toml")
    assert read_scene(folder / "scene.toml") == scene


def test_integers_and_defaults(tmp_path):
    data = {
        "material": {"modulus": 2, "poisson": 0, "branches": [{"modulus": 3, "time": 4}]},
        "indenter": {"shape": "sphere", "radius": 5},
        "loading": {
            "start": "relaxed",
            "penetration": 0,
            "steps": [{"kind": "oscillate", "amplitude": 1, "angular_frequency": 2, "duration": 3}],
        },
    }
    scene = scene_from_dict(data)
    assert scene.adhesion is None
    assert not scene.is_adhesive
    assert scene.title == ""
    assert scene.loading.steps[0].drift == 0.0
    values = [
        scene.material.modulus,
        scene.material.poisson,
        scene.indenter.radius,
        scene.loading.penetration,
    ]
    assert values == [2.0, 0.0, 5.0, 0.0]
    assert all(type(value) is float for value in values)


def test_writing_leaves_no_other_file(tmp_path):
    scene = scene_from_dict(tomllib.loads(GOOD))
    write_scene(scene, tmp_path / "scene.toml")
    write_scene(scene, tmp_path / "scene.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


def test_scene_error_is_one_line_and_keeps_its_class():
    error = UnsupportedScene("a\x1b[31m", "b\nc", "d\te").under("x").in_file("f\r.toml")
    assert str(error) == "f .toml: x.a?[31m: b c; allowed: d e"
    assert type(error) is UnsupportedScene
    assert isinstance(error, ValueError)
    assert error.in_file("other").file == "f\r.toml"


@pytest.mark.parametrize("name", ["material", "indenter", "loading", "adhesion", "title"])
def test_scene_of_the_wrong_things(name):
    good = scene_from_dict(tomllib.loads(GOOD))
    parts = {key: getattr(good, key) for key in ("material", "indenter", "loading", "adhesion", "title")} | {
        name: 3
    }
    with pytest.raises(SceneError) as caught:
        Scene(**parts)
    assert caught.value.key == name
