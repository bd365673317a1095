"""Scene files: what is written is read again; whatever is read gives a usable scene or one clear line."""

from __future__ import annotations

import os
import tomllib
from dataclasses import replace

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
    Table,
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
        check_accepted_or_refused(lambda data=data: scene_from_dict(data))
    while deep:  # taken apart from outside: the interpreter frees nested dictionaries by recursion
        deep = deep["a"]


@given(scenes)
def test_round_trip(folder, scene):
    write_scene(scene, folder / "scene.toml")
    assert read_scene(folder / "scene.toml") == scene
    check_usable(scene)


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


# Numbers by path

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


# Malformed files

STEP = '[[loading.steps]]\nkind = "hold"\nduration = 1\n'


def swap(old, new):
    """The good scene with one piece replaced."""
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new)


def step(text):
    return swap(STEP, f"[[loading.steps]]\n{text}\n")


# name: (text, key, part of what is allowed)
MALFORMED = {
    "empty": ("", "", "[material]"),
    "key twice": (swap("radius = 1.0", "radius = 1.0\nradius = 2.0"), "not a TOML file", "[material]"),
    "integer of 5000 digits": (swap("0.75", "9" * 5000), "not a TOML file", "[material]"),
    "nested 10000 deep": (swap("0.75", "[" * 10000 + "]" * 10000), "not a TOML file", "[material]"),
    "control character": (swap("good", "go\x01od"), "not a TOML file", "[material]"),
    # tables and keys
    "no loading": (GOOD[: GOOD.index("[loading]")], "loading", "a table [loading]"),
    "unknown table": (GOOD + "[solver]\nname = 'bem'\n", "solver", "title, material, indenter"),
    "modulus a date": (swap("0.75", "2024-05-01"), "material.modulus", POSITIVE),
    "modulus with dotted keys 2000 deep": (
        swap("modulus = 0.75", "modulus" + ".a" * 2000 + " = 1"),
        "material.modulus",
        POSITIVE,
    ),
    "misspelt key": (swap("poisson = 0.5", "poison = 0.5\npoisson = 0.5"), "material.poison", "poisson"),
    "misspelt kind": (step('knid = "hold"\nduration = 1'), "loading.steps[1].knid", "kind"),
    "key with line ends": (swap("poisson = 0.5", '"a\\nb\\u2028c" = 1'), "material.a b c", "poisson"),
    "key of 100000 characters": (swap("poisson = 0.5", "x" * 100000 + " = 1"), "material.xxx", "poisson"),
    "sum of moduli too large": (
        swap("modulus = 6.75", "modulus = 1e60").replace("modulus = 1,", "modulus = 1e60,"),
        "material.branches",
        "1e+60",
    ),
    "bulk incompressible": (
        swap("poisson = 0.5", 'poisson = 0.5\nbulk = "elastic"'),
        "material.bulk",
        "< 0.5",
    ),
    "unknown shift": (
        swap("poisson = 0.5", 'poisson = 0.5\ntemperature = 1\nshift = { model = "TNM" }'),
        "material.shift.model",
        '"Arrhenius"',
    ),
    "unknown format": (
        swap(
            "branches = [{ modulus = 6.75, time = 1.0 }, { modulus = 1, time = 10 }]",
            'file = "x"\nformat = "y"',
        ),
        "material.format",
        '"reptate"',
    ),
    "format alone": (swap("poisson = 0.5", 'poisson = 0.5\nformat = "pyvisco"'), "material.format", "file"),
    "profile without file": (
        swap('shape = "sphere"\nradius = 1.0', 'shape = "profile"'),
        "indenter.file",
        "CSV",
    ),
    "no zone": (swap("zone = 0.013\n", ""), "adhesion.zone", "zone"),
    "zone larger than the punch": (
        swap('shape = "sphere"\nradius = 1.0', 'shape = "flat-punch"\nradius = 0.01'),
        "adhesion.zone",
        "shorter than the contact radius",
    ),
    "step a number": (GOOD[: GOOD.index("[[loading")] + "steps = [3]\n", "loading.steps[0]", "a table"),
    "no kind": (step("duration = 1"), "loading.steps[1].kind", "ramp"),
    "unknown kind": (step('kind = "wait"\nduration = 1'), "loading.steps[1].kind", "hold"),
    "table file empty": (step('kind = "table"\nfile = ""'), "loading.steps[1].file", "beside the scene"),
}


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


@pytest.mark.parametrize("name", MALFORMED)
def test_one_clear_line(tmp_path, name):
    text, key, allowed = MALFORMED[name]
    path = tmp_path / "bad.toml"
    path.write_bytes(text.encode())
    line = refuse(path)
    assert line.startswith(f"{path}: {key}")
    assert allowed in line.split("; allowed: ")[1]


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        (bytes(range(256)), "UTF-8"),
        (GOOD.encode("utf-16"), "UTF-8"),
        ('title = "Größe"'.encode("latin-1"), "UTF-8"),
        (b"\x00" * 1000, "TOML"),
        (b"#" * 10_000_001, "10 MB"),
    ],
)
def test_not_text(tmp_path, data, problem):
    path = tmp_path / "bad.toml"
    path.write_bytes(data)
    assert problem in refuse(path)


def test_not_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    os.symlink("loop", tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
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


@pytest.mark.parametrize(
    "header", ["time,penetration", "t (s), depth (um)", "time of row,time-lag", "Zeit,Weg"]
)
def test_headers_of_a_loading_table(tmp_path, header):
    (tmp_path / "good.toml").write_text(TABLE)
    (tmp_path / "path.csv").write_text(f"{header}\n0,0\n1,1\n")
    (table,) = (one for one in read_scene(tmp_path / "good.toml").loading.steps if isinstance(one, Table))
    assert table.times == (0.0, 1.0)
