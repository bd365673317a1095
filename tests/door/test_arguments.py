"""Every argument of every public name, given what it cannot be: one line that says what is allowed."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from support.wrong_values import WRONG, refusal

import contact_scene
import crosscontact as cc
from contact_scene import Counters
from contact_scene.checked import Checked
from validation.runs.run import Run

ROWS = np.linspace(0.1, 1.0, 30)
ELASTIC = cc.Material(1.0, 0.3)
SCENE = cc.Scene(ELASTIC, cc.Sphere(1.0), cc.Loading("relaxed", 0.01, (cc.Ramp(0.02, 0.02),)))
CURVE = cc.MeasuredCurve(ROWS, ROWS**2, ROWS)
COLUMNS = dict.fromkeys(contact_scene.COLUMNS, ROWS)
COMPLETED = cc.Outcome(cc.OutcomeKind.COMPLETED, "the end", 1.0)
RUN = Run("scene", "none", cc.Trace("none", *COLUMNS.values(), COMPLETED, Counters()))
REQUIRED = {
    "RunOptions": {},
    "Fit": {"result": None},
    "Result": {"scene": SCENE, "run": RUN},
    "at_temperature": {"material": ELASTIC, "shift": cc.Arrhenius(1.0, 300.0), "temperature": 310.0},
    "builtin": {"name": "cycle-v0.1"},
    "compare": {"scene": SCENE, "resolution": 4, "max_steps": 5},
    "explore": {"scene": SCENE, "vary": ("material.modulus",), "values": 2, "resolution": 4},
    "export_exam": {"folder": "exam"},
    "fit": {"curves": CURVE, "scene": SCENE, "vary": ("material.modulus",), "max_steps": 5000},
    "fit_each": {"curves": CURVE, "scene": SCENE, "vary": ("material.modulus",)},
    "fit_prony": {"data": cc.RelaxationData(ROWS, 1.0 + np.exp(-ROWS))},
    "judge": {"folder": "answers"},
    "load": {"folder": "run"},
    "read_curve": {"path": "curve.csv"},
    "read_curves": {"path": "curve.csv"},
    "read_material": {"path": "moduli.csv"},
    "read_measured": {"path": "moduli.csv"},
    "read_scene": {"path": "scene.toml"},
    "read_shift_factors": {"path": "shift.csv"},
    "scene_from_dict": {"data": {}, "folder": "."},
    "solve": {"scene": SCENE, "resolution": 4, "max_steps": 5},
    "sweep": {"scene": SCENE, "values": {"material.modulus": [1.0, 2.0]}, "resolution": 4, "max_steps": 5},
    "synthetic": {"scene": SCENE, "noise": 0.01, "resolution": 4},
    "write_curve": {"curve": CURVE, "path": "curve.csv"},
    "write_material": {"material": ELASTIC, "path": "material.toml"},
    "write_scene": {"scene": SCENE, "path": "scene.toml"},
}
"""Arguments with which a name can be called; the others have a default."""
FLAG, TEXT, EMPTY = "truth value", "text", "empty array"
TIMES = ("stop_times", "profile_times", "prony")
TAKEN = {
    FLAG: ("estimate_errors", "posterior", "with_reference"),
    TEXT: ("folder", "path", "out", "name", "remark", "solver"),
    "array": TIMES,
    "list": TIMES,
    EMPTY: (*TIMES, "tie", "per_curve", "free", "profile", "measures", "segments"),
}
"""Arguments that may be one of the wrong values after all, ``None`` aside where it is the default."""
NAMED = (
    "solve",
    "compare",
    "explore",
    "fit",
    "sweep",
    "synthetic",
    "builtin",
    "load",
    "judge",
    "scene_from",
    "read_",
)
"""Where a text has to be the name of something that there is."""
OPTIONAL = {("fit", "check_solver")}
NOT_ASKED = {"OutcomeKind", "SceneError", "Solver", "SolverComparison", "UnsupportedScene", "__version__"}
NOT_ASKED |= {"ContactState", "PronyFit", "scenes", "solvers"}
"""What a run or a fit found, an enumeration, errors, an abstract class, functions without arguments."""


def declared(name):
    """Whether it is a class of declared fields that a scene is made of: tests/scene tries them all."""
    found = getattr(cc, name)
    return inspect.isclass(found) and issubclass(found, Checked) and name != "RunOptions"


def good_arguments(name):
    parameters = inspect.signature(getattr(cc, name)).parameters.values()
    named = [one for one in parameters if one.kind is not one.VAR_KEYWORD]
    return {one.name: REQUIRED[name].get(one.name, one.default) for one in named}


def test_every_public_name_is_asked():
    assert set(REQUIRED) | NOT_ASKED == {name for name in cc.__all__ if not declared(name)}


@pytest.mark.parametrize("name", [name for name in REQUIRED if name[0].isupper() and name != "Fit"])
def test_good_arguments_are_taken(name):
    assert isinstance(getattr(cc, name)(**good_arguments(name)), getattr(cc, name))


@pytest.mark.parametrize("name", REQUIRED)
def test_what_an_argument_cannot_be_is_refused_in_one_line(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moduli.csv").write_text("t,E\n" + "".join(f"{t},{1 + 1 / t}\n" for t in range(1, 9)))
    function, good = getattr(cc, name), good_arguments(name)
    for argument, parameter in inspect.signature(function).parameters.items():
        for what, value in WRONG.items():
            exists = what == TEXT and name.startswith(NAMED) and argument not in ("out", "name")
            optional = value is None and (parameter.default is None or (name, argument) in OPTIONAL)
            if optional or (argument in TAKEN.get(what, ()) and not exists):
                continue
            assert str(refusal(function, **good | {argument: value}))


@pytest.mark.parametrize("what", [what for what in WRONG if what not in ("array", "list")])
def test_what_stands_within_the_arguments_of_a_sweep_is_refused_in_one_line(what):
    value, sample = WRONG[what], {"design": "sobol", "points": 2}
    for values, options in (
        ({"material.modulus": [value]}, {}),
        ({"material.modulus": (value, 2.0)}, sample),
        ({"material.modulus": (1.0, 2.0, value)}, sample),
        ({("material.modulus", "indenter.radius"): [value]}, {}),
        ({"material.modulus": [1.0]}, {"measures": [value]}),
    ):
        assert str(refusal(cc.sweep, SCENE, values, **options))


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: cc.solve("a" * 5000), "aaa"),
        (lambda: cc.solve(SCENE, resolution=0), "resolution: got 0; allowed: a whole number >= 1"),
        (lambda: cc.solve(SCENE, max_steps=0), "max_steps"),
        (lambda: cc.solve(SCENE, stop_times=[-1.0]), "stop_times[0]"),
        (lambda: cc.compare(SCENE, solvers=["bem", "fem"]), "reference"),
        (lambda: cc.builtin("cycle"), "no built-in scene 'cycle'"),
        (lambda: cc.load(""), "folder: is empty"),
        (lambda: cc.fit([3], SCENE, ["adhesion.work"]), "curves: got 3"),
    ],
)
def test_what_is_wrong_is_said(call, text):
    assert text in str(refusal(call))


def test_a_file_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    for place, words in (
        (tmp_path, f"{tmp_path} is a folder; allowed: the path of a file"),
        (tmp_path / "no" / "a.csv", "is in no folder that exists"),
        (tmp_path / "file" / "a.csv", "Not a directory"),
        ("a\0b", "null"),
        ("/dev/null", "/dev/null is not a regular file"),
    ):
        with pytest.raises(cc.SceneError) as caught:
            cc.write_curve(CURVE, place)
        assert str(caught.value).startswith("path: ")
        assert words in str(caught.value)
