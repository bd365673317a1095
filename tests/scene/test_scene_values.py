"""Numbers of a scene by dotted path."""

from __future__ import annotations

from dataclasses import replace

import pytest

from contact_scene import Adhesion, Branch, Loading, Machine, Material, Ramp, Scene, SceneError, Sphere
from contact_scene.scene import value_at, with_values

SCENE = Scene(
    Material(0.75, 0.5, (Branch(6.75, 1.0), Branch(1.0, 10.0))),
    Sphere(2.0),
    Loading("jump-in", 0.0, (Ramp(0.03, 0.02), Ramp(-0.1, 0.04))),
    Adhesion(5e-4, 0.013),
)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("adhesion.work", 5e-4),
        ("material.branches[1].time", 10.0),
        ("loading.steps[1].rate", 0.04),
        ("indenter.radius", 2.0),
    ],
)
def test_a_number_is_read_and_replaced_by_its_path(path, value):
    assert value_at(SCENE, path) == value
    changed = with_values(SCENE, {path: 0.5 * value})
    assert value_at(changed, path) == 0.5 * value
    assert with_values(changed, {path: value}) == SCENE
    assert value_at(SCENE, path) == value


def test_several_numbers_of_one_part_are_put_in_together():
    values = {
        "material.branches[0].modulus": 2.0,
        "material.branches[1].modulus": 3.0,
        "material.poisson": 0.4,
    }
    material = with_values(SCENE, values).material
    assert [branch.modulus for branch in material.branches] == [2.0, 3.0]
    assert [branch.time for branch in material.branches] == [1.0, 10.0]
    assert material.poisson == 0.4


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("adhesion.wrk", "adhesion has no wrk; allowed: work, zone"),
        ("material.branches[2].time", "material.branches has 2 entries"),
        ("material.branches", "is no number"),
        ("adhesion[0]", "adhesion is no list"),
        ("material..modulus", "is no path"),
        ("loading.start", "is no number"),
    ],
)
def test_a_path_to_no_number_is_said_in_one_line(path, words):
    with pytest.raises(SceneError) as caught:
        value_at(SCENE, path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_value_that_the_scene_does_not_take_names_its_path():
    with pytest.raises(SceneError, match=r"material\.branches\[1\]\.time: got -1"):
        with_values(SCENE, {"material.branches[1].time": -1.0})
    elastic = Scene(Material(1.0, 0.3), Sphere(1.0), Loading("jump-in", 0.0))
    with pytest.raises(SceneError, match="the scene has no adhesion"):
        with_values(elastic, {"adhesion.work": 1.0})


def test_places_between_dots_and_the_machine_are_named_as_in_a_scene_file():
    loading = replace(SCENE.loading, machine=Machine(2.0))
    scene = replace(SCENE, loading=loading)
    assert value_at(scene, "loading.steps.0.rate") == value_at(scene, "loading.steps[0].rate")
    stiffer = with_values(scene, {"machine.stiffness": 3.0})
    assert stiffer.machine == Machine(3.0)
    assert value_at(stiffer, "machine.stiffness") == 3.0
