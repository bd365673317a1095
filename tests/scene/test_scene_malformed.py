"""Bad scene files: one line that names the file, the key, what is wrong and what is allowed."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest
from support.scene_text import GOOD

from contact_scene import (
    SceneError,
    Table,
    read_scene,
)
from contact_scene.files import TOO_LARGE
from contact_scene.material_file import FORMATS

POSITIVE = "> 0"
STEP = '[[loading.steps]]\nkind = "hold"\nduration = 1\n'


def swap(old, new):
    """The good scene with one piece replaced."""
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new)


def step(text):
    return swap(STEP, f"[[loading.steps]]\n{text}\n")


# name: (text, key, part of what is allowed)
MALFORMED = {
    # not a scene at all
    "empty": ("", "", "[material]"),
    "blanks": (" \n\t\n", "", "[material]"),
    "only a comment": ("# nothing\n", "", "[material]"),
    "only a BOM": ("\ufeff", "", "[material]"),
    "prose": ("Dear reader,\nthis is not TOML.", "not a TOML file", "[material]"),
    "JSON": ('{"material": {"modulus": 1}}', "not a TOML file", "[material]"),
    "cut off": (GOOD[:90], "not a TOML file", "[material]"),
    "key twice": (swap("radius = 1.0", "radius = 1.0\nradius = 2.0"), "not a TOML file", "[material]"),
    "integer of 5000 digits": (swap("0.75", "9" * 5000), "not a TOML file", "[material]"),
    "nested 10000 deep": (swap("0.75", "[" * 10000 + "]" * 10000), "not a TOML file", "[material]"),
    "old Mac line ends": (GOOD.replace("\n", "\r"), "not a TOML file", "[material]"),
    "control character": (swap("good", "go\x01od"), "not a TOML file", "[material]"),
    # tables
    "no material": (GOOD.replace("[material]", "[materiel]"), "materiel", "material"),
    "no indenter": (
        GOOD[: GOOD.index("[indenter]")] + GOOD[GOOD.index("[adhesion]") :],
        "indenter",
        "a table",
    ),
    "no loading": (GOOD[: GOOD.index("[loading]")], "loading", "a table [loading]"),
    "unknown table": (GOOD + "[solver]\nname = 'bem'\n", "solver", "title, material, indenter"),
    # material
    "negative modulus": (swap("0.75", "-0.75"), "material.modulus", POSITIVE),
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
    "bulk branch": (
        swap("poisson = 0.5", "poisson = 0.3\nbulk = { branches = [{ modulus = 1, time = 0 }] }"),
        "material.bulk.branches[0].time",
        POSITIVE,
    ),
    "file and branches": (swap("modulus = 0.75", 'file = "x.csv"'), "material.branches", "either"),
    "unknown model": (swap("modulus = 0.75", 'model = "rubber"'), "material.model", '"power-law"'),
    "branches of a model": (
        swap("modulus = 0.75", 'model = "standard-linear"\nrelaxed = 1\nglassy = 2\ntime = 1'),
        "material.branches",
        "relaxed, glassy, time",
    ),
    "shift alone": (
        swap("poisson = 0.5", 'poisson = 0.5\nshift = { model = "WLF" }'),
        "material.temperature",
        "together",
    ),
    "temperature alone": (
        swap("poisson = 0.5", "poisson = 0.5\ntemperature = 1"),
        "material.shift",
        "together",
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
    # indenter
    "no shape": (swap('shape = "sphere"\n', ""), "indenter.shape", "sphere"),
    "unknown shape": (swap('"sphere"', '"cube"'), "indenter.shape", "flat-punch"),
    "shape in capitals": (swap('"sphere"', '"Sphere"'), "indenter.shape", "sphere"),
    "key of another shape": (
        swap("radius = 1.0", "radius = 1.0\nhalf_angle = 60"),
        "indenter.half_angle",
        "radius",
    ),
    "profile without file": (
        swap('shape = "sphere"\nradius = 1.0', 'shape = "profile"'),
        "indenter.file",
        "CSV",
    ),
    "profile file a number": (
        swap('shape = "sphere"\nradius = 1.0', 'shape = "profile"\nfile = 1'),
        "indenter.file",
        "beside the scene",
    ),
    # adhesion
    "no zone": (swap("zone = 0.013\n", ""), "adhesion.zone", "zone"),
    "zone larger than the punch": (
        swap('shape = "sphere"\nradius = 1.0', 'shape = "flat-punch"\nradius = 0.01'),
        "adhesion.zone",
        "shorter than the contact radius",
    ),
    # loading
    "step a number": (GOOD[: GOOD.index("[[loading")] + "steps = [3]\n", "loading.steps[0]", "a table"),
    "no kind": (step("duration = 1"), "loading.steps[1].kind", "ramp"),
    "unknown kind": (step('kind = "wait"\nduration = 1'), "loading.steps[1].kind", "hold"),
    "kind a list": (step('kind = ["hold"]\nduration = 1'), "loading.steps[1].kind", "hold"),
    "table without file": (step('kind = "table"'), "loading.steps[1].file", "CSV"),
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


def test_the_good_scene_is_good(tmp_path):
    path = tmp_path / "good.toml"
    scenes = []
    for data in (GOOD.encode(), b"\xef\xbb\xbf" + GOOD.encode(), GOOD.replace("\n", "\r\n").encode()):
        path.write_bytes(data)
        scenes.append(read_scene(path))
    assert scenes[0] == scenes[1] == scenes[2]
    assert scenes[0].loading.steps[1].duration == 1.0
    assert isinstance(scenes[0].loading.steps[1].duration, float)


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
    assert "regular file" in refuse(tmp_path)
    assert "No such file" in refuse(tmp_path / "missing.toml")
    assert "too long" in refuse(tmp_path / ("x" * 5000))
    assert "cannot be read" in refuse("nul\0.toml")
    (tmp_path / "file").write_text("")
    assert "cannot be read" in refuse(tmp_path / "file" / "scene.toml")
    os.symlink("loop", tmp_path / "loop")
    assert "cannot be read" in refuse(tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
    assert "regular file" in refuse(tmp_path / "pipe")
    assert "regular file" in refuse("/dev/zero")


OTHER_FILES = {
    "loading.steps[1]": swap(STEP, '[[loading.steps]]\nkind = "table"\nfile = "FILE"\n'),
    "indenter": swap('shape = "sphere"\nradius = 1.0', 'shape = "profile"\nfile = "FILE"'),
    "material": swap("modulus = 0.75\n", 'file = "FILE"\n'),
}


@pytest.mark.parametrize("key", OTHER_FILES)
@pytest.mark.parametrize("file", ["/dev/zero", "/dev/tty", "pipe", ".", "large.csv"])
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


def test_no_permission(tmp_path, monkeypatch):
    path = tmp_path / "secret.toml"
    path.write_text(GOOD)

    def refused(*args, **kwargs):  # root would read a file without permissions
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "open", refused)
    assert "Permission denied" in refuse(path)


TABLE = swap(STEP, '[[loading.steps]]\nkind = "table"\nfile = "path.csv"\n')


@pytest.mark.parametrize(
    ("rows", "where"),
    [
        (b"", "the file is empty"),
        (b"# time, penetration\n", "no rows of numbers"),
        (b"time,penetration\n", "no rows of numbers"),
        (b"0,0\n", "time"),
        (b"0,0\n2,1\n1,2\n", "time, row 3"),
        (b"0,0\n1,1\n1,2\n", "time, row 3"),
        (b"0,0\n1,nan\n", "penetration, line 2"),
        (b"0,0\ninf,1\n", "time, line 2"),
        (b"0,0\n1,1e70\n", "penetration, line 2"),
        (b"0,0\n1\n", "line 2"),
        (b"0,0\n1,2,3\n", "line 2"),
        (b"0,0;0,5\n1;1\n", "line 1: cells are separated by semicolons and numbers have decimal commas"),
        (b"Zeit\tWeg\n0,0\t0,5\n", "line 2: cells are separated by tabs and numbers have decimal commas"),
        (b'Zeit,Weg\n"0,5","1"\n', "line 2: cells are separated by commas and numbers have decimal commas"),
        (b"0,0\n1\n2;2\n", "line 2: 1 cells; allowed: 2, as in line 1"),
        (b"0,0\none,two\n", "time, line 2: got 'one'"),
        (b"0,0\n1_0,2\n", "time, line 2: got '1_0'"),
        (b'0,0\n"1,2\n', "line 2"),
        (b"0,0\n\xff\xfe,2\n", "not a text file"),
        (b"# of a rig\npenetration,time\n0,0\n1,1\n", "line 2: got 'penetrati...'"),
        (b"t [s],time\n0,0\n1,1\n", "line 1"),
        (b"time,Force [N]\n0,0\n1,1\n", "line 1"),
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
