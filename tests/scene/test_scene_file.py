"""Scene files: what is written is read again; whatever is read gives a usable scene or one clear line."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from support.scene_strategies import scenes
from support.scene_text import GOOD
from support.wrong_values import refusal

import contact_scene as cs
from contact_scene.scene import value_at, with_values
from validation.reference.creep_compliance import creep_compliance


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples of a property."""
    return tmp_path_factory.mktemp("scenes")


def check_accepted_or_refused(read):
    """A valid scene that can be used, or one clear line; anything else is a failure of the reader."""
    try:
        result = read()
    except cs.SceneError as refusal:
        result = refusal
    if isinstance(result, cs.Scene):
        return check_usable(result)
    assert str(result).isprintable()
    assert 0 < len(str(result)) < 1000
    assert result.allowed
    return None


def check_usable(scene):
    """What every solver asks first; nothing here may overflow or be undefined."""
    creep = creep_compliance(scene.material)
    ends = [0.0, 1e-60, 1.0, 1e60]
    for answer in (
        scene.material.relaxation_modulus(ends),
        creep(ends),
        scene.material.storage_modulus(ends),
        scene.material.loss_modulus(ends),
        creep.times,
        scene.material.glassy_plane_modulus,
    ):
        assert (abs(answer) < 1e200).all() if hasattr(answer, "all") else abs(answer) < 1e200
    assert scene.indenter.height(0.0) == 0.0
    assert scene.indenter.slope(1.0) >= 0.0
    time, penetration, force = 0.0, scene.loading.penetration, 0.0
    for step in scene.loading.steps:
        segment = step.segment(time, penetration, force)
        assert segment.end >= segment.start == time
        assert abs(segment.value(segment.start)) < 1e200
        assert abs(segment.rate(segment.start)) < 1e200
        time = segment.end
        if segment.control == "force":
            force = segment.value(time)
        else:
            penetration = segment.value(time)
        assert abs(penetration) + abs(force) < 1e200


@given(st.binary(max_size=400))
@example(b"")
@example(b"a=" + b"[" * 5000)
def test_random_bytes(folder, data):
    path = folder / "bytes.toml"
    path.write_bytes(data)
    check_accepted_or_refused(lambda: cs.read_scene(path))


@given(st.data())
def test_values_replaced(data):
    """Every number and string of a good scene replaced by anything TOML can hold."""
    scene = tomllib.loads(GOOD)
    places = []

    def collect(node):
        for key in node if isinstance(node, dict) else range(len(node)):
            places.append((node, key))
            if isinstance(node[key], (dict, list)):
                collect(node[key])

    collect(scene)
    for _ in range(data.draw(st.integers(1, 3))):
        node, key = data.draw(st.sampled_from(places))
        node[key] = data.draw(anything)
    check_accepted_or_refused(lambda: cs.scene_from_dict(scene, "."))


names = (
    "material indenter adhesion loading modulus poisson branches time bulk file shape sphere cone"
    " profile radius half_angle work zone start relaxed kind penetration steps ramp hold table"
    " to rate duration elastic .. model power-law standard-linear exponent range error relaxed glassy"
    " temperature shift WLF Arrhenius c1 c2 reference_temperature activation_energy format reptate"
)
words = st.sampled_from([*names.split(), "", "\0"])
anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.integers(10**400, 10**401)
    | st.floats()
    | st.floats(0.0, 1.0)
    | st.dates()
    | st.text(max_size=8)
    | words,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=6),
    max_leaves=20,
)


def test_very_deep_dictionaries():
    deep: dict = {}
    for _ in range(100_000):
        deep = {"a": deep}
    for data in (deep, {"material": deep}, {"material": {"modulus": deep, "poisson": 0.3}}):
        check_accepted_or_refused(lambda data=data: cs.scene_from_dict(data))
    while deep:  # taken apart from outside: the interpreter frees nested dictionaries by recursion
        deep = deep["a"]


@given(scenes)
def test_round_trip(folder, scene):
    cs.write_scene(scene, folder / "scene.toml")
    assert cs.read_scene(folder / "scene.toml") == scene
    cs.write_scene(scene, folder / "scene.toml")
    assert not list(folder.glob(".*"))
    check_usable(scene)


def test_scene_error_is_one_line_and_keeps_its_class():
    error = cs.UnsupportedScene("a\x1b[31m", "b\nc", "d\te").under("x").in_file("f\r.toml")
    assert str(error) == "f .toml: x.a?[31m: b c; allowed: d e"
    assert type(error) is cs.UnsupportedScene
    assert isinstance(error, ValueError)
    assert error.in_file("other").file == "f\r.toml"


# Numbers by path

SCENE = cs.Scene(
    cs.Material(0.75, 0.5, (cs.Branch(6.75, 1.0), cs.Branch(1.0, 10.0))),
    cs.Sphere(2.0),
    cs.Loading("jump-in", 0.0, (cs.Ramp(0.03, 0.02), cs.Ramp(-0.1, 0.04)), cs.Machine(2.0)),
    cs.Adhesion(5e-4, 0.013),
    body=cs.Layer(0.5, "bonded"),
)
NUMBERS = {
    "adhesion.work": 5e-4,
    "material.branches[0].modulus": 6.75,
    "material.branches[1].time": 10.0,
    "loading.steps[1].rate": 0.04,
    "loading.steps.0.rate": 0.02,
    "machine.stiffness": 2.0,
    "body.thickness": 0.5,
}


def test_numbers_are_read_and_replaced_by_their_paths_together():
    assert {path: value_at(SCENE, path) for path in NUMBERS} == NUMBERS
    halves = {path: 0.5 * value for path, value in NUMBERS.items()}
    changed = with_values(SCENE, halves)
    assert {path: value_at(changed, path) for path in NUMBERS} == halves
    assert with_values(changed, NUMBERS) == SCENE
    with pytest.raises(cs.SceneError, match=r"material\.branches\[1\]\.time: got -1"):
        with_values(SCENE, {"material.branches[1].time": -1.0})


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("adhesion.wrk", "adhesion has no wrk; allowed: work, zone"),
        ("glue.work", "the scene has no glue; allowed: material, indenter"),
        ("material.branches[2].time", "material.branches has 2 entries"),
        ("material.branches", "is no number"),
        ("adhesion[0]", "adhesion has no 0; allowed: work"),
        ("material..modulus", "is no path"),
        ("loading.start", "is no number"),
    ],
)
def test_a_path_to_no_number_is_said_in_one_line(path, words):
    assert words in str(refusal(value_at, SCENE, path))


# Malformed files
