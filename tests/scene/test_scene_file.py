"""Scene files: what is written is read again; whatever is read gives a usable scene or one clear line."""

from __future__ import annotations

import os
import tomllib

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from support.scene_strategies import scenes
from support.scene_text import GOOD

from contact_scene import (
    Adhesion,
    Branch,
    Loading,
    Machine,
    Material,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    UnsupportedScene,
    read_scene,
    scene_from_dict,
    write_scene,
)
from contact_scene.files import TOO_LARGE
from contact_scene.material_file import FORMATS
from contact_scene.scene import value_at, with_values
from validation.reference.creep_compliance import creep_compliance

POSITIVE = "> 0"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all examples of a property."""
    return tmp_path_factory.mktemp("scenes")


def check_accepted_or_refused(read):
    """A valid scene that can be used, or one clear line; anything else is a failure of the reader."""
    try:
        result = read()
    except SceneError as refusal:
        result = refusal
    if isinstance(result, Scene):
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


def test_very_deep_dictionaries():
    deep: dict = {}
    for _ in range(100_000):
        deep = {"a": deep}
    for data in (deep, {"material": deep}, {"material": {"modulus": deep, "poisson": 0.3}}):
        check_accepted_or_refused(lambda data=data: scene_from_dict(data))
    while deep:  # taken apart from outside: the interpreter frees nested dictionaries by recursion
        deep = deep["a"]


@given(scenes)
def test_round_trip(folder, scene):
    write_scene(scene, folder / "scene.toml")
    assert read_scene(folder / "scene.toml") == scene
    write_scene(scene, folder / "scene.toml")
    assert not list(folder.glob(".*"))
    check_usable(scene)


def test_scene_error_is_one_line_and_keeps_its_class():
    error = UnsupportedScene("a\x1b[31m", "b\nc", "d\te").under("x").in_file("f\r.toml")
    assert str(error) == "f .toml: x.a?[31m: b c; allowed: d e"
    assert type(error) is UnsupportedScene
    assert isinstance(error, ValueError)
    assert error.in_file("other").file == "f\r.toml"


# Numbers by path

SCENE = Scene(
    Material(0.75, 0.5, (Branch(6.75, 1.0), Branch(1.0, 10.0))),
    Sphere(2.0),
    Loading("jump-in", 0.0, (Ramp(0.03, 0.02), Ramp(-0.1, 0.04)), Machine(2.0)),
    Adhesion(5e-4, 0.013),
)
NUMBERS = {
    "adhesion.work": 5e-4,
    "material.branches[0].modulus": 6.75,
    "material.branches[1].time": 10.0,
    "loading.steps[1].rate": 0.04,
    "loading.steps.0.rate": 0.02,
    "machine.stiffness": 2.0,
}


def test_numbers_are_read_and_replaced_by_their_paths_together():
    assert {path: value_at(SCENE, path) for path in NUMBERS} == NUMBERS
    halves = {path: 0.5 * value for path, value in NUMBERS.items()}
    changed = with_values(SCENE, halves)
    assert {path: value_at(changed, path) for path in NUMBERS} == halves
    assert with_values(changed, NUMBERS) == SCENE
    with pytest.raises(SceneError, match=r"material\.branches\[1\]\.time: got -1"):
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
    with pytest.raises(SceneError) as caught:
        value_at(SCENE, path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


# Malformed files

STEP = '[[loading.steps]]\nkind = "hold"\nduration = 1\n'


def swap(old, new):
    """The good scene with one piece replaced."""
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new)


SHAPE = 'shape = "sphere"\nradius = 1.0'
BRANCHED = "branches = [{ modulus = 6.75, time = 1.0 }, { modulus = 1, time = 10 }]"
SHIFTED = 'poisson = 0.5\ntemperature = 1\nshift = { model = "TNM" }'
# a piece of the good scene, what stands there instead, key, part of what is allowed
MALFORMED = [
    (GOOD, "", "", "[material]"),
    ("radius = 1.0", "radius = 1.0\nradius = 2.0", "not a TOML file", "[material]"),
    ("0.75", "9" * 5000, "not a TOML file", "[material]"),
    ("0.75", "[" * 10000 + "]" * 10000, "not a TOML file", "[material]"),
    ("good", "go\x01od", "not a TOML file", "[material]"),
    (GOOD[GOOD.index("[loading]") :], "", "loading", "a table [loading]"),
    ("[loading]", "[solver]\nname = 1\n[loading]", "solver", "title, material, indenter"),
    ("0.75", "2024-05-01", "material.modulus", POSITIVE),
    ("modulus = 0.75", "modulus" + ".a" * 2000 + " = 1", "material.modulus", POSITIVE),
    ("poisson = 0.5", "poison = 0.5\npoisson = 0.5", "material.poison", "poisson"),
    ("poisson = 0.5", '"a\\nb\\u2028c" = 1', "material.a b c", "poisson"),
    ("poisson = 0.5", "x" * 100000 + " = 1", "material.xxx", "poisson"),
    (BRANCHED, BRANCHED.replace("modulus = 6.75", "modulus = 1.1e60"), "material.branches[0].mod", "1e+60"),
    (
        BRANCHED,
        BRANCHED.replace("6.75", "1e60").replace("us = 1,", "us = 1e60,"),
        "material.branches",
        "1e+60",
    ),
    ("poisson = 0.5", 'poisson = 0.5\nbulk = "elastic"', "material.bulk", "< 0.5"),
    ("poisson = 0.5", SHIFTED, "material.shift.model", '"Arrhenius"'),
    (BRANCHED, 'file = "x"\nformat = "y"', "material.format", '"reptate"'),
    ("poisson = 0.5", 'poisson = 0.5\nformat = "pyvisco"', "material.format", "file"),
    ("modulus = 0.75", 'file = "x.csv"', "material.branches", "either"),
    ("modulus = 0.75", 'model = "rubber"', "material.model", '"power-law"'),
    ('shape = "sphere"\n', "", "indenter.shape", "sphere"),
    (SHAPE, 'shape = "profile"', "indenter.file", "CSV"),
    ("zone = 0.013\n", "", "adhesion.zone", "zone"),
    (SHAPE, 'shape = "flat-punch"\nradius = 0.01', "adhesion.zone", "shorter than the contact radius"),
    (GOOD[GOOD.index("[[loading") :], "steps = [3]\n", "loading.steps[0]", "a table"),
    ('kind = "hold"', 'knid = "hold"', "loading.steps[1].knid", "kind"),
    ('kind = "hold"\n', "", "loading.steps[1].kind", "ramp"),
    ('kind = "hold"', 'kind = "wait"', "loading.steps[1].kind", "hold"),
    (STEP, STEP.split("kind")[0] + 'kind = "table"\nfile = ""', "loading.steps[1].file", "beside the scene"),
]


def refuse(path):
    """The one line a bad scene gets."""
    with pytest.raises(SceneError) as caught:
        read_scene(path)
    line = str(caught.value)
    assert line.isprintable(), line
    assert len(line) < 1000
    assert caught.value.file
    assert caught.value.allowed
    assert "; allowed: " in line
    return line


@pytest.mark.parametrize(("old", "new", "key", "allowed"), MALFORMED)
def test_one_clear_line(tmp_path, old, new, key, allowed):
    path = tmp_path / "bad.toml"
    path.write_text(swap(old, new), "utf-8")
    line = refuse(path)
    assert line.startswith(f"{path}: {key}")
    assert allowed in line.split("; allowed: ")[1]


def test_not_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    os.symlink("loop", tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "utf16").write_bytes(GOOD.encode("utf-16"))
    (tmp_path / "large").write_bytes(b"#" * (TOO_LARGE + 1))
    assert "UTF-8" in refuse(tmp_path / "utf16")
    assert "10 MB" in refuse(tmp_path / "large")
    for name in (".", "pipe", "/dev/zero"):
        assert "regular file" in refuse(tmp_path / name)
    for name in ("missing.toml", "x" * 5000, "nul\0.toml", "file/scene.toml", "loop"):
        assert "cannot be read" in refuse(tmp_path / name)


OTHER_FILES = {
    "loading.steps[1]": swap(STEP, '[[loading.steps]]\nkind = "table"\nfile = "FILE"\n'),
    "indenter": swap('shape = "sphere"\nradius = 1.0', 'shape = "profile"\nfile = "FILE"'),
    "material": swap("modulus = 0.75\n", 'file = "FILE"\n'),
}


@pytest.mark.parametrize("key", OTHER_FILES)
@pytest.mark.parametrize("file", ["/dev/zero", "pipe", ".", "large.csv"])
def test_files_named_in_a_scene_are_regular_and_end(tmp_path, key, file):
    os.mkfifo(tmp_path / "pipe")
    with (tmp_path / "large.csv").open("wb") as large:
        large.truncate(TOO_LARGE + 1)
    text = OTHER_FILES[key].replace("FILE", file)
    (tmp_path / "scene.toml").write_text(text.split("branches")[0] + text[text.index("[indenter]") :])
    said = refuse(tmp_path / "scene.toml")
    assert ("10 MB" if file == "large.csv" else "regular file") in said
    assert said.startswith(str(tmp_path / file)) or said.startswith(file)


SECRETS = [
    "root:x:0:0:superuser of this machine:/root:/bin/bash",
    "user,TheirPasswordIsLongEnough,their-other-secret",
    "TheirPasswordIsLongEnough,their-other-secret-words",
    "1,2;TheirPasswordIsLongEnough;their-other-secret",
    "1 TheirPasswordIsLongEnough-and-more",
    "TheirPasswordIsLongEnough",
    "# a [TheirPasswordIsLongEnough]\nb [TheirPasswordIsLongEnough], tau_i",
]
BRANCHES = GOOD[GOOD.index("branches") : GOOD.index("[indenter]")]
MEASURED = OTHER_FILES["material"].replace(BRANCHES, "").replace("[material]", "[material]\nFORMAT")
TABLES = {
    **{key: text for key, text in OTHER_FILES.items() if key != "material"},
    "rate": GOOD + '[adhesion.rate]\nfile = "FILE"\n',
    "shift": GOOD.replace("[indenter]", 'temperature = 300.0\nshift = { file = "FILE" }\n[indenter]'),
    **{form: MEASURED.replace("FORMAT", f'format = "{form}"') for form in FORMATS},
}


@pytest.mark.parametrize("key", TABLES)
@pytest.mark.parametrize("head", ["", "height,radius\n", "time,force\n1,2\n", "tau_i,alpha_i,E_0\n", "3\n1 "])
def test_of_a_file_that_a_scene_names_no_more_is_quoted_than_a_number(tmp_path, key, head):
    """Twelve characters: a scene may come from anywhere, and its errors go to whoever sent it."""
    (tmp_path / "scene.toml").write_text(TABLES[key].replace("FILE", "secret"))
    for secret in SECRETS:
        (tmp_path / "secret").write_text(head + 3 * f"{secret}\n")
        said = refuse(tmp_path / "scene.toml")
        parts = {secret[at : at + 13] for at in range(len(secret) - 12)}
        assert said.startswith(str(tmp_path / "secret")), said
        assert not [part for part in parts if part in said], (secret, said)


TABLE = swap(STEP, '[[loading.steps]]\nkind = "table"\nfile = "path.csv"\n')


@pytest.mark.parametrize(
    ("rows", "where"),
    [
        (b"time,penetration\n", "no rows of numbers"),
        (b"0,0\n", "time"),
        (b"0,0\n2,1\n1,2\n", "time, row 3"),
        (b"0,0\n1,nan\n", "penetration, line 2"),
        (b"0,0\n1,1e70\n", "penetration, line 2"),
        (b"0,0\n1,2,3\n", "line 2"),
        (b"0,0\none,two\n", "time, line 2: got 'one'"),
        (b"0,0\n1_0,2\n", "time, line 2: got '1_0'"),
        (b"# of a rig\npenetration,time\n0,0\n1,1\n", "line 2: got 'penetrati...'"),
        (b"t [s],time\n0,0\n1,1\n", "line 1"),
        (None, "cannot be read"),
    ],
)
def test_bad_loading_table(tmp_path, rows, where):
    (tmp_path / "bad.toml").write_text(TABLE)
    if rows is not None:
        (tmp_path / "path.csv").write_bytes(rows)
    assert refuse(tmp_path / "bad.toml").startswith(f"{tmp_path / 'path.csv'}: {where}")
