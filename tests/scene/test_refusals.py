"""What no scene may hold beyond single values: one line with file, key, what is wrong, what is allowed."""

from __future__ import annotations

import copy
import json
import math
import os
import tomllib

import pytest
from support.scene_text import GOOD
from support.wrong_values import refusal

import contact_scene as cs
import crosscontact as cc
from contact_scene.files import TOO_LARGE
from contact_scene.material_file import FORMATS

BASE = tomllib.loads(GOOD)


def changed(changes):
    """The good scene with other values at some paths; ``None`` takes what stands there away."""
    data = copy.deepcopy(BASE)
    for path, value in changes.items():
        *way, last = path.split(".")
        at = data
        for key in way:
            at = at[int(key)] if isinstance(at, list) else at.setdefault(key, {})
        if value is None:
            del at[last]
        else:
            at[int(last) if isinstance(at, list) else last] = value
    return data


def line_of(call):
    """The one line in which something is refused."""
    return str(refusal(call, longest=1000))


# Keys and values of a scene

POWER = {"model": "power-law", "exponent": 0.3, "modulus": 2.0, "time": 1.0, "range": [1e-3, 1e3]}
SOLID = {"model": "standard-linear", "poisson": 0.3, "relaxed": 1.0, "glassy": 1.0, "time": 1.0}
WLF = {"model": "WLF", "c1": 17.44, "c2": 51.6, "reference_temperature": 373.15}
ARRHENIUS = {"model": "Arrhenius", "activation_energy": 80e3, "reference_temperature": 300.0}
APPROACH = {"kind": "approach", "rate": 1, "force": 1}


def material(**keys):
    return {"material": {"poisson": 0.3, "modulus": 1.0} | keys}


def steps(*entries):
    return {"loading.steps": list(entries)}


# what stands in the good scene instead, key, part of what is allowed
WRONG = [
    ({"loading": None}, "loading", "a table [loading]"),
    ({"solver": {"name": 1}}, "solver", "title, units, material"),
    ({"material.a\nb\u2028c": 1}, "material.a b c", "poisson"),
    ({"material." + 100_000 * "x": 1}, "material.xxx", "poisson"),
    ({"material.branches.0.modulus": 1.1e60}, "material.branches[0].modulus", "1e+60"),
    (material(branches=2 * [{"modulus": 1e60, "time": 1.0}]), "material.branches", "1e+60"),
    ({"material.bulk": "elastic"}, "material.bulk", "< 0.5"),
    (material(model="rubber"), "material.model", '"power-law"'),
    (material(file="x", format="y"), "material.format", '"reptate"'),
    (material(format="pyvisco"), "material.format", "file"),
    (material(file="x.csv", branches=[]), "material.branches", "either"),
    (material(**POWER | {"range": [1.0]}), "material.range", "two times"),
    (material(**POWER | {"range": [1.0, 1.0]}), "material.range", "first < last"),
    (material(**POWER | {"range": [1e-60, 1e60]}), "material.range", "from 1e-60 to 1e+60"),
    (material(**POWER | {"modulus": 1e60, "time": 1e3}), "material.modulus", "from 1e-60 to 1e+60"),
    (material(**POWER | {"modulus": 1e-60}), "material.modulus", "from 1e-60 to 1e+60"),
    (material(**POWER | {"branches": []}), "material.branches", "exponent"),
    ({"material": SOLID}, "material.glassy", "above relaxed"),
    (material(temperature=300.0), "material.shift", "together"),
    (material(shift=WLF), "material.temperature", "together"),
    (material(temperature=1, shift={"model": "TNM"}), "material.shift.model", '"Arrhenius"'),
    (material(temperature=1, shift=3), "material.shift", "a table with a model"),
    (material(temperature=1, shift={"model": "file"}), "material.shift.file", "a_T"),
    (material(temperature=1, shift={"file": "x", "c1": 1.0}), "material.shift.c1", "model, file"),
    (material(temperature=321.5, shift=WLF), "material.temperature", "c2 = 321.55"),
    (material(temperature=340.0, shift=WLF), "material.temperature", "30 decades"),
    (material(temperature=25.0, shift=ARRHENIUS), "material.temperature", "kelvin"),
    ({"indenter.shape": None}, "indenter.shape", "sphere"),
    ({"indenter": {"shape": "profile"}}, "indenter.file", "CSV"),
    (
        {"indenter": {"shape": "flat-punch", "radius": 0.01}},
        "adhesion.zone",
        "shorter than the contact",
    ),
    ({"adhesion.zone": None}, "adhesion.zone", "zone"),
    ({"body": 3}, "body", "a table [body]"),
    ({"body": {"thickness": 1.0, "base": "glued"}}, "body.base", '"bonded", "frictionless"'),
    ({"body": {"thickness": 0.025, "base": "bonded"}}, "adhesion.zone", "0.0125"),
    (
        {"body": {"thickness": 1.0, "base": "bonded"}} | material(bulk="elastic", poisson=0.3),
        "material.bulk",
        "no [body]",
    ),
    ({"adhesion.work_closing": 6e-4}, "adhesion.work_closing", "at most work"),
    ({"adhesion.stress": 0.2}, "adhesion.stress", "either zone or stress"),
    ({"adhesion": {"work": 5e-4, "stress": 1e30}}, "stress", "from 1e-60"),
    ({"adhesion.rate": {"file": "a.csv", "speed": 1}}, "adhesion.rate.speed", "file"),
    ({"adhesion.work": 0.0, "adhesion.rate": {"speed": 1, "exponent": 1}}, "adhesion.rate", "work > 0"),
    (steps(3), "loading.steps[0]", "a table"),
    (steps({"knid": "hold", "duration": 1}), "loading.steps[0].knid", "kind"),
    (steps({"duration": 1}), "loading.steps[0].kind", "ramp"),
    (steps({"kind": "wait"}), "loading.steps[0].kind", "hold"),
    (steps({"kind": "table", "file": ""}), "loading.steps[0].file", "beside the scene"),
    (
        steps({"kind": "ramp", "to": 1, "rate": 1, "until_radius": 1, "until_force": 1}),
        "loading.steps[0].until_radius",
        "one of the two",
    ),
    (steps({"kind": "force", "value": 1, "duration": 1}, APPROACH), "loading.steps[1].to", "a bound `to`"),
    (steps(APPROACH | {"to": 1, "away": 2}), "loading.steps[0].away", "less than to"),
]


@pytest.mark.parametrize(("changes", "key", "allowed"), WRONG, ids=range(len(WRONG)))
def test_what_a_scene_cannot_be(changes, key, allowed):
    line = line_of(lambda: cs.scene_from_dict(changed(changes)))
    assert line.startswith(key)
    assert allowed in line.split("; allowed: ")[1]


def test_a_built_part_stands_for_the_table_of_material_indenter_or_adhesion_only():
    read, layer = cs.scene_from_dict(BASE), cs.Layer(10.0, "bonded")
    built = {name: getattr(read, name) for name in ("material", "indenter", "adhesion")}
    assert cs.scene_from_dict(BASE | built) == read
    others = {"loading": read.loading, "machine": cs.Machine(1.0), "units": cs.Units(), "body": layer}
    for name, part in others.items():
        assert refusal(cs.scene_from_dict, BASE | {name: part}).key == name
    assert refusal(cs.scene_from_dict, BASE | {"indenter": read.material}).key == "indenter"


@pytest.mark.parametrize(
    ("old", "new"),
    [(GOOD, ""), ("radius = 1.0", "radius = 1.0\nradius = 2.0"), ("0.75", "9" * 5000), ("0.75", "[" * 10000),
     ("good", "go\x01od")],
)  # fmt: skip
def test_what_is_no_toml(tmp_path, old, new):
    (tmp_path / "bad.toml").write_text(GOOD.replace(old, new), "utf-8")
    line = line_of(lambda: cs.read_scene(tmp_path / "bad.toml"))
    assert line.startswith(f"{tmp_path / 'bad.toml'}: {'not a TOML file' if new else 'the file is empty'}")
    assert "[material]" in line


def scene_of(*entries, work=0.0, indenter=None, body=None):
    adhesion = cs.Adhesion(work, 0.01) if work else None
    return cs.Scene(
        body or cs.Material(0.75, 0.5),
        indenter or cs.Sphere(2.0),
        cs.Loading("relaxed", 0.01, entries),
        adhesion,
    )


IN_PYTHON = {
    "loading.steps[0].force": lambda: scene_of(cs.Approach(1.0, 0.0)),
    "loading.steps[1].to": lambda: scene_of(cs.Force(1.0, 1.0), cs.Approach(1.0, 1.0)),
    "loading.steps[2].to": lambda: scene_of(cs.Ramp(1.0, 1.0), cs.ForceRamp(1.0, 1.0), cs.Approach(1.0, 1.0)),
    "loading.steps[0].to": lambda: scene_of(
        cs.Approach(1.0, 1.0), body=cs.Material(0.75, 0.3, (), "elastic")
    ),
    "loading.steps[0].to: is missing, and 2.46e+62": lambda: scene_of(
        cs.Approach(1.0, 1e60), indenter=cs.PowerLaw(100.0, 1e300)
    ),
    "loading.steps[0].away": lambda: scene_of(cs.Approach(1.0, 1.0, away=1e9)),
    "to": lambda: cs.Loading("relaxed", 0.0, (cs.Approach(1.0, 1.0),)).steps[0].segment(0.0, 0.0, 0.0),
    "times, row 3": lambda: cs.Table((0.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
    "times": lambda: cs.Table((0.0,), (0.0,)),
    "values": lambda: cs.Table((0.0, 1.0), (0.0,)),
    "times[1]": lambda: cs.Table((0.0, math.nan), (0.0, 1.0)),
    "radii[0]": lambda: cs.TabulatedProfile((-1.0, 1.0, 2.0), (0.0, 0.0, 1.0)),
}


@pytest.mark.parametrize("key", IN_PYTHON)
def test_what_cannot_be_built(key):
    assert line_of(IN_PYTHON[key]).startswith(f"{key}:" if ":" not in key else key)


# Files that a scene names

NAMING = {
    "table": steps({"kind": "table", "file": "x.csv"}),
    "profile": {"indenter": {"shape": "profile", "file": "x.csv"}},
    "rate": {"adhesion.rate": {"file": "x.csv"}},
    "shift": material(temperature=300.0, shift={"file": "x.csv"}),
    **{
        form: {"material": {"poisson": 0.25, "file": "x.csv", "format": form, "modulus": 1.0}}
        for form in FORMATS
    },
    "E_0 wanted": {"material": {"poisson": 0.25, "file": "x.csv"}},
}
"""What a scene names a file for."""


def refused(folder, of, text):
    """The line in which the file of a scene is refused."""
    (folder / "x.csv").write_text(text, newline="")
    read = {"curve": lambda: cc.read_curves(folder / "x.csv")}.get(of)
    return line_of(read or (lambda: cs.scene_from_dict(changed(NAMING[of]), folder)))


COMMAS = "numbers have decimal commas; allowed: points in numbers; semicolons,"
RISING = "".join(f"{k},{k},{k},{k}\n" for k in range(30))
PAIRS = "".join(f"{k},{k}\n" for k in range(30))
MODES = "# Maxwell modes\n#number of modes\n3\n\n# i tau_i G_i\n1 1e-3 1e8\n2 3e-2 1e7\n3 21 0\n\n#end"
SERIES = """i,tau_i,alpha_i,E_0,E_i
-,s,-,MPa,MPa
1,0.01,0.5,20.0,10.0
2,1.0,0.0,20.0,0.0
3,100.0,0.3,20.0,6.0
"""
# what names the file, its text, how the line goes on after the name of the file
FILES = [
    ("table", "time,penetration\n", "no rows of numbers"),
    ("table", "0,0\n", "time"),
    ("table", "0,0\n2,1\n1,2\n", "time, row 3"),
    ("table", "0,0\n1,nan\n", "penetration, line 2"),
    ("table", "0,0\n1,1e70\n", "penetration, line 2"),
    ("table", "0,0\n1,2,3\n", "line 2"),
    ("table", "0,0\none,two\n", "time, line 2: got 'one'"),
    ("table", "0,0\n1_0,2\n", "time, line 2: got '1_0'"),
    ("table", "# of a rig\npenetration,time\n0,0\n1,1\n", "line 2: got 'penetrati...'"),
    ("table", "t [s],time\n0,0\n1,1\n", "line 1"),
    ("profile", "0,0\n0.5,0.1\n1.0,0.05\n", "height, row 3"),
    ("profile", "0.1,0\n0.5,0.1\n1.0,0.5\n", "radius"),
    ("profile", "0,0\n1,1\n", "radius"),
    ("profile", "0,0\n1,0\n2,0\n", "height"),
    ("profile", "0,0\n1e-80,1\n2,3\n", "radius"),
    ("profile", f"radius [mm],height [um]\n{PAIRS}", "columns: height in um, but radius in mm; allowed: one"),
    ("profile", f"# of a tip\nr [MPa],h\n{PAIRS}", "columns: radius in MPa; allowed: a unit of length"),
    ("rate", "speed,work\n1e-3,6e-4\n1e-4,7e-4\n", "speed, row 2"),
    ("rate", "speed,work\n1e-4,7e-4\n1e-3,6e-4\n", "work, row 2"),
    ("rate", "speed,work\n1e-4,0.0\n", "work, line 2: got 0.0"),
    ("rate", "speed [s],work\n1,1\n2,2\n", "columns: speed in s; allowed: a unit of speed"),
    ("shift", "T [s],a_T\n1,1\n2,2\n", "columns: temperature in s; allowed: a unit of temperature"),
    ("shift", "T [K],log_aT [s]\n1,1\n2,2\n", "columns: log shift factor in s; allowed: no unit"),
    ("reptate", "", "the file is empty"),
    ("reptate", "-3\n1 1 1\n", "columns: got 1 columns"),
    ("reptate", MODES.replace("\n3\n", "\n4\n"), "number of modes: is 4, but there are 3"),
    ("reptate", MODES.replace("1e7", ""), "line 7: 2 cells"),
    ("reptate", MODES.replace("3e-2", "-1"), "tau_i, line 7"),
    ("reptate", MODES.replace("1e7", "soft"), "G_i, line 7: got 'soft'"),
    ("reptate", "0.1 5 7\n1 2 3\n", "mode, line 1: got 0.1; allowed: a whole number"),
    ("branches", "1,2,3\n", "columns: got 3 columns without names"),
    ("branches", "tau,E,remark\n1,2,3\n", "columns"),
    ("branches", "tau;E\n0,1;3,5\n1,0;2,5\n", f"line 2: {COMMAS}"),
    ("branches", "# of tau, E\n1;2,5E-03\n", f"line 2: {COMMAS}"),
    ("branches", "tau\tE\n1.000,1\t 3,5\n", f"line 2: {COMMAS}"),
    ("branches", "tau E\n1 -3,5\n", f"line 2: {COMMAS}"),
    ("branches", '"0,1","3,5"\n', f"line 1: {COMMAS}"),
    ("branches", "1,5;?\n", "modulus, line 1: got '5;?'; allowed: a number, with a decimal point"),
    ("branches", "# columns: strain ratio, tau\n.4 1\n.3 2\n.2 3\n", "columns: got 'strain_ra"),
    ("branches", '1,2\n"3,4\n', "line 2: not CSV"),
    ("relaxation", "# g_i, tau_i\n0.4, 0.01\n0.3, 0.1\n", "columns: got 'g_i,tau_i'; allowed: tau, E"),
    ("relaxation", "# columns: g_i, tau_i\n0.4 0.01\n0.3 0.1\n", "columns: got 'g_i,tau_i'"),
    ("relaxation", "# Columns: t, E, T\n1 2\n2 1\n3 1\n", "line 1: 3 names"),
    ("relaxation", "# Relaxation time (s)\tRelative modulus\n0.01\t0.4\n", "columns: got 'Relaxatio"),
    ("relaxation", "# Prony\n# gamma, tau\n# -, s\n\n0.4,0.01\n", "columns: got 'gamma,tau'"),
    ("relaxation", "// relaxation time / s, g\n0.01, 0.4\n0.1, 0.3\n0.4, 0.1\n", "columns: got 'relax"),
    ("relaxation", "# sample E\n1 2\n", "columns: got 'sample,E'"),
    ("relaxation", "# t, E\n# s, mm\n1,2\n2,1\n3,1\n", "columns: modulus in mm"),
    ("relaxation", "DMA\nt;E;remark\n1;2\n2;1\n3;1\n", "line 2: 3 names"),
    ("relaxation", "T,E\n1,2\n2,1\n3,1\n", "columns: got 'T,E'"),  # temperature
    ("relaxation", "t,E\n0,2\n2,1\n3,1\n", "t, line 2"),
    ("relaxation", "t,E\n1,2\n2,1\n", "2 rows of data"),
    ("relaxation", "t,E\n1,2\n1,3\n2,1\n2,4\n", "4 rows at 2 times"),
    (
        "relaxation",
        "t,E,T\n1,3,20\n2,2,20\n3,1,30\n",
        "temperature: differs between rows; allowed: modu",
    ),
    ("relaxation", "t,E,T,Set\n1,2,3,4\n", "columns"),  # raw data of pyvisco, no master curve
    ("relaxation", "gamma=0;\nt sxy\n1 2\n2 1\n3 1\n", "gamma, line 1"),
    ("relaxation", "Mw=1;\ngamma=x\nt sxy\n1 2\n2 1\n3 1\n", "gamma, line 2: got 'x'"),
    ("dynamic", "# i; tau_i [s]; g_i\n1;0.01;0.4\n2;0.1;0.3\n", "columns: got 'i,tau_i,g_i'"),
    ("dynamic", "w, E'\n1,2,3\n2,3,4\n", 'line 1: 2 names, "w,E\'", over 3 columns; allowed: a name'),
    ("dynamic", "f,w,E',E''\n1,2,3,4\n", "columns: got \"f,w,E',E''\""),
    ("dynamic", "f,E',G''\n1,2,3\n", "columns: got"),
    ("dynamic", "w [Hz],E',E''\n1,2,3\n", "columns: angular frequency in Hz"),
    (
        "dynamic",
        "w,E',E''\nrad/s,MPa,kPa\n1,1,1\n",
        "columns: loss modulus in kPa, but storage modulus in",
    ),
    ("pyvisco", 'tau_i,alpha_i\n1,"0,5"\n', "alpha_i, line 2: got '0,5'; allowed: a number, with a"),
    ("pyvisco", "f,E_stor,E_loss\nHz,MPa,MPa\n1,2,3\n", "columns"),  # a master curve, not coefficients
    ("pyvisco", "tau_i,E_i\ns,MPa\n1,2\n", "columns"),
    ("pyvisco", "tau_i,alpha_i,tau_i\n1,0.5,1\n", "columns"),
    ("pyvisco", SERIES.replace(",0.3,", ",,"), "alpha_i, line 5"),
    ("pyvisco", SERIES.replace(",0.3,", ",0.6,"), "alpha_i"),
    ("pyvisco", SERIES.replace("0.3,20.0", "0.3,21.0"), "E_0"),
    ("pyvisco", SERIES.replace("20.0", "0.0"), "E_0, line 3"),
    ("pyvisco", SERIES.replace("3,100.0", "100.0"), "line 5"),
    ("pyvisco", SERIES.replace("MPa,MPa", "MPa,Pa"), "columns: modulus in Pa, but instantaneous modulus in"),
    ("pyvisco", "tau_i,alpha_i,E_0,E_i\n1,0.4,10,4.04\n2,0.5,10,2\n", "line 3: alpha_i is 0.5, but"),
    ("E_0 wanted", "tau_i,alpha_i\n1,0.5\n", "E_0"),
    ("E_0 wanted", SERIES.replace("0.0,20", "0.2,20").replace(",0.0\n", ",4.0\n"), "alpha_i: the sum is 1"),
    (
        "curve",
        f"time,penetration [nm],force,contact_radius [um]\n{RISING}",
        "columns: contact_radius in um, but penetration in nm; allowed: one unit of length",
    ),
]


@pytest.mark.parametrize(("of", "text", "said"), FILES, ids=range(len(FILES)))
def test_what_a_file_cannot_hold(tmp_path, of, text, said):
    assert refused(tmp_path, of, text).startswith(f"{tmp_path / 'x.csv'}: {said}")


def test_data_that_no_series_meets(tmp_path):
    wave = "".join(f"{t},{2.0 + math.sin(3.0 * math.log(t))}\n" for t in (1.4**k for k in range(-20, 10)))
    assert "no Prony series meets the data: misfit" in refused(tmp_path, "relaxation", f"t,E\n{wave}")


SECRETS = [
    "root:x:0:0:superuser of this machine:/root:/bin/bash",
    "user,TheirPasswordIsLongEnough,their-other-secret",
    "TheirPasswordIsLongEnough,their-other-secret-words",
    "1,2;TheirPasswordIsLongEnough;their-other-secret",
    "1 TheirPasswordIsLongEnough-and-more",
    "TheirPasswordIsLongEnough",
    "# a [TheirPasswordIsLongEnough]\nb [TheirPasswordIsLongEnough], tau_i",
]


@pytest.mark.parametrize("of", NAMING)
@pytest.mark.parametrize("head", ["", "height,radius\n", "time,force\n1,2\n", "tau_i,alpha_i,E_0\n", "3\n1 "])
def test_of_a_file_that_a_scene_names_no_more_is_quoted_than_a_number(tmp_path, of, head):
    """Twelve characters: a scene may come from anywhere, and its errors go to whoever sent it."""
    for secret in SECRETS:
        said = refused(tmp_path, of, head + 3 * f"{secret}\n")
        parts = {secret[at : at + 13] for at in range(len(secret) - 12)}
        assert said.startswith(str(tmp_path / "x.csv")), said
        assert not [part for part in parts if part in said], (secret, said)


def test_what_is_no_text_file(tmp_path):
    (tmp_path / "file").write_text("")
    os.symlink("loop", tmp_path / "loop")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "utf16").write_bytes(GOOD.encode("utf-16"))
    (tmp_path / "large").write_bytes(b"#" * (TOO_LARGE + 1))
    wrong = {"UTF-8": ["utf16"], "10 MB": ["large"], "regular file": [".", "pipe", "/dev/zero"]}
    wrong["cannot be read"] = ["missing.toml", "x" * 5000, "nul\0.toml", "file/scene.toml", "loop"]
    for said, names in wrong.items():
        for name in names:
            assert said in line_of(lambda name=name: cs.read_scene(tmp_path / name))


@pytest.mark.parametrize("of", ["table", "profile", "relaxation"])
@pytest.mark.parametrize("file", ["/dev/zero", "pipe", ".", "large.csv"])
def test_files_named_in_a_scene_are_regular_and_end(tmp_path, of, file):
    os.mkfifo(tmp_path / "pipe")
    with (tmp_path / "large.csv").open("wb") as large:
        large.truncate(TOO_LARGE + 1)
    asked = json.loads(json.dumps(changed(NAMING[of])).replace("x.csv", file))
    said = line_of(lambda: cs.scene_from_dict(asked, tmp_path))
    assert said.startswith(str(tmp_path / file))
    assert ("10 MB" if file == "large.csv" else "regular file") in said
