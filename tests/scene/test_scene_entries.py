"""Every entry of a scene given as a dictionary, from Python or JSON: what it cannot be is one line."""

from __future__ import annotations

import copy

import pytest
from support.wrong_values import WRONG, refused

from contact_scene import SceneError, scene_from_dict

STEPS = [
    {"kind": "ramp", "to": 1.0, "rate": 1.0, "until_force": 1.0},
    {"kind": "hold", "duration": 1.0, "until_force": 1.0},
    {"kind": "force", "value": 1.0, "duration": 1.0, "until_penetration": 1.0},
    {"kind": "force-ramp", "to": 1.0, "rate": 1.0},
    {"kind": "oscillate", "amplitude": 1.0, "angular_frequency": 1.0, "duration": 1.0, "drift": 0.0},
    {"kind": "sweep", "amplitude": 1.0, "chirp": 1.0, "duration": 1.0},
    {"kind": "table", "file": "pairs.csv", "quantity": "force", "interpolation": "cubic"},
    {
        "kind": "approach",
        "rate": 1.0,
        "force": 1.0,
        "to": 10.0,
        "dwell": 0.0,
        "retract": 1.0,
        "away": -1.0,
    },
]
WLF = {"model": "WLF", "c1": 17.0, "c2": 51.0, "reference_temperature": 300.0}
ARRHENIUS = {"model": "Arrhenius", "activation_energy": 1.0, "reference_temperature": 300.0}
SCENE = {
    "title": "all entries",
    "material": {
        "modulus": 1.0,
        "poisson": 0.3,
        "branches": [{"modulus": 1.0, "time": 1.0}],
        "bulk": "elastic",
        "temperature": 300.0,
        "shift": WLF,
    },
    "indenter": {"shape": "sphere", "radius": 1.0},
    "adhesion": {
        "work": 1.0,
        "zone": 0.01,
        "work_closing": 0.5,
        "rate": {"speed": 1.0, "exponent": 1.0},
    },
    "machine": {"stiffness": 1.0},
    "loading": {"start": "relaxed", "penetration": 0.01, "steps": STEPS},
}
BULK = {"modulus": 1.0, "branches": [{"modulus": 1.0, "time": 1.0}]}
OTHERS = [
    {"material": {"file": "moduli.csv", "format": "relaxation", "poisson": 0.3, "bulk": BULK}},
    {"material": {"model": "standard-linear", "poisson": 0.3, "relaxed": 1.0, "glassy": 2.0, "time": 1.0}},
    {
        "material": {
            "model": "power-law",
            "poisson": 0.3,
            "exponent": 0.5,
            "modulus": 1.0,
            "time": 1.0,
            "range": [0.1, 1.0],
            "error": 1e-3,
            "relaxed": 0.0,
        }
    },
    {"material": {"modulus": 1.0, "poisson": 0.3, "temperature": 300.0, "shift": ARRHENIUS}},
    {"material": {"modulus": 1.0, "poisson": 0.3, "temperature": 1.5, "shift": {"file": "shift.csv"}}},
    {"indenter": {"shape": "profile", "file": "pairs.csv"}},
    {"indenter": {"shape": "cone", "half_angle": 60.0}},
    {"indenter": {"shape": "flat-punch", "radius": 1.0}},
    {"indenter": {"shape": "power-law", "exponent": 2.0, "coefficient": 1.0}},
    {"adhesion": {"work": 1e-3, "stress": 10.0, "rate": {"file": "rates.csv"}}},
]
TAKEN = {
    "title": {"text"},
    "bulk": {"None", "mapping"},
    "range": {"list"},
    **{key: {"None"} for key in ("work_closing", "until_force", "until_penetration", "retract", "away")},
}
"""What an entry may be all the same; the modulus of a bulk may be left out, too."""


def entries(table, path=()):
    """Paths of all entries of a dictionary, nested ones too."""
    inner = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    for key, value in inner:
        yield (*path, key)
        yield from entries(value, (*path, key))


def with_entry(scene, path, value):
    """The scene with another value there."""
    changed = copy.deepcopy(scene)
    table = changed
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value
    return changed


CASES = [(SCENE, path) for path in entries(SCENE)]
CASES += [(SCENE | other, path) for other in OTHERS for path in entries(other) if len(path) > 1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("tables")
    (made / "pairs.csv").write_text("0,0\n1,1\n2,2\n3,3\n")
    (made / "moduli.csv").write_text("".join(f"{k},{1 + 1 / k}\n" for k in range(1, 9)))
    (made / "shift.csv").write_text("T,a_T\n1,1\n2,2\n")
    (made / "rates.csv").write_text("1,1\n2,2\n")
    return made


@pytest.mark.parametrize("scene", [SCENE, *(SCENE | other for other in OTHERS)])
def test_the_scenes_are_good(scene, folder):
    assert scene_from_dict(scene, folder).title == "all entries"


@pytest.mark.parametrize(("scene", "path"), CASES, ids=lambda one: str(one) if isinstance(one, tuple) else "")
def test_what_an_entry_cannot_be_is_refused_in_one_line(scene, path, folder):
    taken = {"None"} if path[-2:] == ("bulk", "modulus") else TAKEN.get(path[-1], set())
    for what, value in WRONG.items():
        if what not in taken:
            with pytest.raises(SceneError) as caught:
                scene_from_dict(with_entry(scene, path, value), folder)
            refused(caught.value)
