"""Whatever the reader is given, nothing but a usable scene or one clear line comes out."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.scene_strategies import scenes
from support.scene_text import GOOD

from contact_scene import Scene, SceneError, read_scene, scene_from_dict
from validation.reference.creep_compliance import creep_compliance


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples of a fuzz test."""
    return tmp_path_factory.mktemp("scenes")


def outcome(read):
    """What the reader returns or raises; only a ``SceneError`` is caught."""
    try:
        return read()
    except SceneError as refusal:
        return refusal


def check_accepted_or_refused(read):
    """A valid scene that can be used, or one clear line; anything else is a failure of the reader."""
    result = outcome(read)
    if isinstance(result, SceneError):
        assert str(result).isprintable()
        assert 0 < len(str(result)) < 1000
        assert result.allowed
        return None
    assert isinstance(result, Scene)
    check_usable(result)
    return result


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


@given(scenes)
def test_every_valid_scene_can_be_used(scene):
    check_usable(scene)


@given(st.binary(max_size=400))
@example(b"")
@example(b"a=" + b"[" * 5000)
def test_random_bytes(folder, data):
    path = folder / "bytes.toml"
    path.write_bytes(data)
    check_accepted_or_refused(lambda: read_scene(path))


numbers = ["nan", "-inf", "1e400", "true", "[]", "{}", "[[1]]", "-1", "0", "1e308", "-0.0", "5e-324"]
signs = ["'", '"x"', '"""', ".a", "=", "#", "\0", "\r", "é", "\ufeff", " ", "0x" + "f" * 300]
lines = [
    "[material]",
    "[[loading.steps]]",
    "kind = 'table'\nfile = '.'",
    "shape = 'profile'\nfile = '..'",
    "inf = 1",
]
pieces = st.sampled_from([*numbers, *signs, *(f"\n{line}\n" for line in lines)])


@given(st.lists(st.tuples(st.integers(0, len(GOOD)), st.integers(0, 12), pieces), min_size=1, max_size=4))
def test_mutated_scenes(folder, mutations):
    text = GOOD
    for at, cut, piece in mutations:
        text = text[:at] + piece + text[at + cut :]
    path = folder / "mutated.toml"
    path.write_bytes(text.encode())
    check_accepted_or_refused(lambda: read_scene(path))


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
    check_accepted_or_refused(lambda: scene_from_dict(scene, "."))


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


@given(anything)
def test_random_dictionaries(data):
    check_accepted_or_refused(lambda: scene_from_dict(data, "."))


@given(
    st.dictionaries(words, anything, max_size=4),
    st.sampled_from(["material", "indenter", "loading", "adhesion"]),
)
def test_random_tables_in_a_good_scene(table, name):
    check_accepted_or_refused(lambda: scene_from_dict(tomllib.loads(GOOD) | {name: table}, "."))


def test_very_deep_dictionaries():
    deep: dict = {}
    for _ in range(100_000):
        deep = {"a": deep}
    for data in (deep, {"material": deep}, {"material": {"modulus": deep, "poisson": 0.3}}):
        assert check_accepted_or_refused(lambda data=data: scene_from_dict(data)) is None
    while deep:  # taken apart from outside: the interpreter frees nested dictionaries by recursion
        deep = deep["a"]


extreme = st.sampled_from(
    [5e-324, 1e-308, 1e-60, 1e-31, 1.0, 1e31, 1e60, 1e61, 1e155, 1.7976931348623157e308]
)


@settings(max_examples=200)
@given(st.lists(extreme, min_size=11, max_size=11), st.sampled_from(["sphere", "flat-punch"]), st.booleans())
def test_extreme_magnitudes(values, shape, negative):
    e0, e1, t1, e2, t2, radius, work, zone, depth, rate, to = values
    data = {
        "material": {
            "modulus": e0,
            "poisson": 0.5,
            "branches": [{"modulus": e1, "time": t1}, {"modulus": e2, "time": t2}],
        },
        "indenter": {"shape": shape, "radius": radius},
        "adhesion": {"work": work, "zone": zone},
        "loading": {
            "start": "relaxed",
            "penetration": -depth if negative else depth,
            "steps": [
                {"kind": "ramp", "to": to, "rate": rate},
                {"kind": "force-ramp", "to": to, "rate": rate},
            ],
        },
    }
    check_accepted_or_refused(lambda: scene_from_dict(data))


def test_the_fuzz_reaches_valid_scenes():
    assert check_accepted_or_refused(lambda: scene_from_dict(tomllib.loads(GOOD))) is not None
