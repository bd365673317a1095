"""Scene files: writing and reading give the same scene back."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from support.scene_strategies import scenes
from support.scene_text import GOOD

from contact_scene import (
    UnsupportedScene,
    read_scene,
    scene_from_dict,
    write_scene,
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
