"""Every argument of every public name, given what it cannot be: one line that says what is allowed."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from support.wrong_values import WRONG, refused

import crosscontact as cc
from contact_scene import Counters
from contact_scene.checked import Checked
from validation.runs.run import Run

NUMBERS = {"array", "list"}
OPTIONAL, TEXT, FLAG = {"None"}, {"text"}, {"truth value"}
NAMES = {"text", "texts", "empty array"}
TIMES = NUMBERS | {"empty array"}

ROWS = np.linspace(0.1, 1.0, 30)
ELASTIC = cc.Material(1.0, 0.3)
SCENE = cc.Scene(ELASTIC, cc.Sphere(1.0), cc.Loading("relaxed", 0.01, (cc.Ramp(0.02, 0.02),)))
CURVE = cc.MeasuredCurve(ROWS, ROWS**2, ROWS)
MODULI = cc.RelaxationData(ROWS, 1.0 + np.exp(-ROWS))
COMPLETED = cc.Outcome(cc.OutcomeKind.COMPLETED, "the end", 1.0)
COLUMNS = dict.fromkeys(
    ("time", "penetration", "force", "contact_radius", "stored_energy", "external_work", "dissipated_energy"),
    ROWS,
)
PLACE = {"time": 0.0, "penetration": 0.0, "force": 0.0, "contact_radius": 1.0}

# name: (what it takes, {argument: which of WRONG it takes all the same})
TABLE = {
    "DynamicData": (
        {"angular_frequencies": ROWS, "storage": ROWS, "loss": ROWS, "shear": False, "units": ("s", "Pa")},
        {"shear": FLAG, "units": {"texts"}},
    ),
    "MeasuredCurve": (
        {
            "time": ROWS,
            "force": ROWS,
            "penetration": None,
            "stage": ROWS,
            "contact_radius": ROWS,
            "stiffness": 1.0,
            "indenter_radius": 1.0,
            "noise": 1.0,
            "name": "curve",
        },
        {"penetration": OPTIONAL, "contact_radius": OPTIONAL, "indenter_radius": OPTIONAL}
        | {"noise": OPTIONAL, "name": TEXT},
    ),
    "Outcome": (
        {"kind": cc.OutcomeKind.COMPLETED, "reason": "the end", "time": 1.0, "past_extremum": False},
        {"reason": TEXT, "time": {"nan", "huge"}, "past_extremum": FLAG},
    ),
    "RelaxationData": (
        {"times": ROWS, "moduli": ROWS, "shear": False, "units": ("s", "Pa")},
        {"shear": FLAG, "units": {"texts"}},
    ),
    "RunOptions": (
        {
            "step_tolerance": None,
            "stop_times": (),
            "profile_times": (),
            "max_steps": None,
            "progress": None,
            "monitor": None,
            "estimate_errors": False,
        },
        {"step_tolerance": OPTIONAL, "stop_times": TIMES, "profile_times": TIMES, "max_steps": OPTIONAL}
        | {"progress": OPTIONAL, "monitor": OPTIONAL, "estimate_errors": FLAG},
    ),
    "SurfaceProfile": (
        PLACE | dict.fromkeys(("radius", "pressure", "displacement", "gap"), ROWS),
        {key: {"nan", "huge"} for key in PLACE},
    ),
    "Trace": (
        {"solver": "none"}
        | COLUMNS
        | {"outcome": COMPLETED, "counters": Counters(), "extra": {}, "events": (), "profiles": ()}
        | {"errors": {}, "wall_seconds": 0.0},
        {"solver": TEXT, "extra": {"mapping"}, "events": {"empty array"}, "profiles": {"empty array"}}
        | {"errors": {"mapping"}, "wall_seconds": {"nan", "huge"}},
    ),
    "Fit": ({"result": None}, {}),
    "Result": (
        {
            "scene": SCENE,
            "run": Run("scene", "none", cc.Trace("none", *COLUMNS.values(), COMPLETED, Counters())),
        },
        {},
    ),
    "at_temperature": (
        {"material": ELASTIC, "shift": cc.Arrhenius(1.0, 300.0), "temperature": 310.0},
        {},
    ),
    "builtin": ({"name": "cycle-v0.1"}, {}),
    "compare": (
        {"scene": SCENE, "solvers": None, "resolution": 4, "estimate_errors": False, "max_steps": 5},
        {"solvers": OPTIONAL, "resolution": OPTIONAL, "estimate_errors": FLAG, "max_steps": OPTIONAL},
    ),
    "export_exam": (
        {"folder": "exam", "suite": "quick", "with_reference": False},
        {"folder": TEXT, "with_reference": FLAG},
    ),
    "fit": (
        {
            "curves": CURVE,
            "scene": SCENE,
            "vary": ("material.modulus",),
            "tie": (),
            "per_curve": (),
            "free": (),
            "prony": (),
            "regularisation": None,
            "starts": 1,
            "seed": 0,
            "profile": (),
            "solver": "reference",
            "resolution": 4,
            "check_solver": None,
            "max_steps": 5000,
            "executor": None,
            "out": None,
            "progress": None,
        },
        {"tie": {"empty array"}, "per_curve": {"empty array"}, "free": {"empty array"}}
        | {"prony": TIMES, "profile": {"empty array"}, "out": OPTIONAL | TEXT}
        | dict.fromkeys(
            ("regularisation", "resolution", "check_solver", "max_steps", "executor", "progress"), OPTIONAL
        ),
    ),
    "fit_prony": (
        {"data": MODULI, "relaxed": None, "tolerance": 1e-3},
        {"relaxed": OPTIONAL},
    ),
    "judge": ({"folder": "answers", "out": None}, {"out": OPTIONAL | TEXT}),
    "load": ({"folder": "run"}, {}),
    "read_curves": ({"path": "curve.csv"}, {}),
    "read_material": (
        {"path": "moduli.csv", "poisson": 0.5, "modulus": None, "format": None},
        {"modulus": OPTIONAL, "format": OPTIONAL},
    ),
    "read_measured": ({"path": "moduli.csv", "format": None}, {"format": OPTIONAL}),
    "read_scene": ({"path": "scene.toml"}, {}),
    "read_shift_factors": ({"path": "shift.csv"}, {}),
    "scene_from_dict": ({"data": {}, "folder": "."}, {}),
    "solve": (
        {
            "scene": SCENE,
            "solver": "reference",
            "resolution": 4,
            "estimate_errors": False,
            "stop_times": (),
            "profile_times": None,
            "max_steps": 5,
            "progress": None,
        },
        {"resolution": OPTIONAL, "estimate_errors": FLAG, "stop_times": TIMES}
        | {"profile_times": TIMES | OPTIONAL, "max_steps": OPTIONAL, "progress": OPTIONAL},
    ),
    "sweep": (
        {
            "scene": SCENE,
            "values": {"material.modulus": [1.0, 2.0]},
            "solver": "reference",
            "resolution": 4,
            "design": "grid",
            "points": None,
            "seed": 0,
            "estimate_errors": False,
            "measures": (),
            "traces": None,
            "max_steps": 5,
            "out": None,
            "executor": None,
            "jobs": 1,
            "batch_seconds": None,
            "progress": None,
        },
        {"estimate_errors": FLAG, "out": OPTIONAL | TEXT, "measures": {"empty array"}}
        | dict.fromkeys(("resolution", "points", "traces", "max_steps", "executor"), OPTIONAL)
        | dict.fromkeys(("batch_seconds", "progress"), OPTIONAL),
    ),
    "synthetic": (
        {
            "scene": SCENE,
            "noise": 0.01,
            "sampling": None,
            "seed": 0,
            "contact_point": 0.0,
            "baseline": 0.0,
            "drift": 0.0,
            "stiffness": None,
            "solver": "reference",
            "resolution": 4,
            "name": "",
        },
        {"sampling": OPTIONAL, "stiffness": OPTIONAL, "resolution": OPTIONAL, "name": TEXT},
    ),
    "write_curve": ({"curve": CURVE, "path": "curve.csv"}, {"path": TEXT}),
    "write_material": (
        {"material": ELASTIC, "path": "material.toml", "remark": ""},
        {"path": TEXT, "remark": TEXT},
    ),
    "write_scene": ({"scene": SCENE, "path": "scene.toml"}, {"path": TEXT}),
}
NOT_ASKED = {
    "ContactState": "what a run found",
    "OutcomeKind": "an enumeration",
    "PronyFit": "what a fit of moduli found",
    "SceneError": "an error",
    "Solver": "an abstract class",
    "SolverComparison": "what a comparison found",
    "UnsupportedScene": "an error",
    "__version__": "a text",
}
ARGUMENTS = [(name, argument) for name, (good, _) in TABLE.items() for argument in good]


@pytest.mark.parametrize(
    "call", [cc.load, cc.judge, cc.solve, cc.compare, cc.read_scene, cc.read_curves, cc.export_exam]
)
def test_a_name_that_is_too_long_for_a_file_is_one_line(call):
    with pytest.raises(cc.SceneError):
        call("a" * 5000)


def declared(name):
    """Whether it is a class of declared fields: tests/scene/test_every_field.py tries them all."""
    return inspect.isclass(getattr(cc, name)) and issubclass(getattr(cc, name), Checked)


def test_the_table_holds_every_public_name_and_argument():
    asked = {name for name in cc.__all__ if name in TABLE or not declared(name)}
    assert set(TABLE) | set(NOT_ASKED) | {"scenes", "solvers"} == asked
    for name, (good, _) in TABLE.items():
        assert list(inspect.signature(getattr(cc, name)).parameters) == list(good), name
    for name in ("scenes", "solvers"):
        assert not inspect.signature(getattr(cc, name)).parameters


@pytest.mark.parametrize("name", [name for name in TABLE if name[0].isupper() and name != "Fit"])
def test_what_the_table_calls_good_is_taken(name):
    good, _ = TABLE[name]
    assert isinstance(getattr(cc, name)(**good), getattr(cc, name))


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
def test_what_an_argument_cannot_be_is_refused_in_one_line(name, argument, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "moduli.csv").write_text("t,E\n" + "".join(f"{t},{1 + 1 / t}\n" for t in range(1, 9)))
    good, taken = TABLE[name]
    for what, value in WRONG.items():
        if what in taken.get(argument, ()):
            continue
        with pytest.raises(cc.SceneError) as caught:
            getattr(cc, name)(**good | {argument: value})
        refused(caught.value)


@pytest.mark.parametrize("what", [what for what in WRONG if what not in NUMBERS])
def test_what_stands_within_the_arguments_of_a_sweep_is_refused_in_one_line(what):
    value, sample = WRONG[what], {"design": "sobol", "points": 2}
    for values, options in (
        ({"material.modulus": [value]}, {}),
        ({"material.modulus": (value, 2.0)}, sample),
        ({"material.modulus": (1.0, 2.0, value)}, sample),
        ({("material.modulus", "indenter.radius"): [value]}, {}),
        ({"material.modulus": [1.0]}, {"measures": [value]}),
    ):
        with pytest.raises(cc.SceneError) as caught:
            cc.sweep(SCENE, values, **options)
        assert caught.value.allowed
        assert str(caught.value).isprintable()
