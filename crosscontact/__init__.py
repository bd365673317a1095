"""Adhesive viscoelastic contact of a rigid indenter: scenes, solvers, results.

::

    import crosscontact as cc

    result = cc.solve("cycle-v0.02")
    result.pull_off.force
    result.plot()

Names are loaded where they are first used: the import itself loads no package that computes or draws.
"""

# ruff: noqa: F403, F405  (type checkers read the names of contact_scene from there)
from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from crosscontact.shadowing import check_packages, started_as_command

try:
    check_packages()
except ImportError as error:
    if started_as_command():
        raise SystemExit(str(error)) from None  # on the command line the message alone, exit code 1
    raise

if TYPE_CHECKING:  # the same names as in __getattr__, which keeps NumPy and SciPy unloaded
    from contact_scene import *
    from crosscontact.api import SolverComparison, builtin, compare, scenes, solve, solvers
    from crosscontact.exam import export_exam, judge
    from crosscontact.fitting import Fit, fit, fit_each, read_curve, read_curves, write_curve
    from crosscontact.result import ContactState, Result, load
    from crosscontact.sweeps import explore, sweep
    from validation.fits.record import MeasuredCurve
    from validation.fits.synthetic import synthetic
    from validation.solvers import RunOptions, Solver

    __version__: str

__all__ = [
    "WLF",
    "Adhesion",
    "Approach",
    "Arrhenius",
    "Branch",
    "BulkRelaxation",
    "Cone",
    "ContactState",
    "DynamicData",
    "Fit",
    "FlatPunch",
    "Force",
    "ForceRamp",
    "Hold",
    "Layer",
    "Loading",
    "Machine",
    "Material",
    "MeasuredCurve",
    "Oscillate",
    "Outcome",
    "OutcomeKind",
    "PowerLaw",
    "PowerLawRelaxation",
    "PowerRate",
    "PronyFit",
    "Ramp",
    "RateTable",
    "RelaxationData",
    "Result",
    "RunOptions",
    "Scene",
    "SceneError",
    "ShiftTable",
    "Solver",
    "SolverComparison",
    "Sphere",
    "StandardLinearSolid",
    "SurfaceProfile",
    "Sweep",
    "Table",
    "TabulatedProfile",
    "Trace",
    "Units",
    "UnsupportedScene",
    "__version__",
    "at_temperature",
    "builtin",
    "compare",
    "explore",
    "export_exam",
    "fit",
    "fit_each",
    "fit_prony",
    "judge",
    "load",
    "read_curve",
    "read_curves",
    "read_material",
    "read_measured",
    "read_scene",
    "read_shift_factors",
    "scene_from_dict",
    "scenes",
    "solve",
    "solvers",
    "sweep",
    "synthetic",
    "write_curve",
    "write_material",
    "write_scene",
]

_HOMES = {
    "crosscontact.api": ("SolverComparison", "builtin", "compare", "scenes", "solve", "solvers"),
    "crosscontact.exam": ("export_exam", "judge"),
    "crosscontact.fitting": ("Fit", "fit", "fit_each", "read_curve", "read_curves", "write_curve"),
    "crosscontact.result": ("ContactState", "Result", "load"),
    "crosscontact.sweeps": ("explore", "sweep"),
    "validation.fits.record": ("MeasuredCurve",),
    "validation.fits.synthetic": ("synthetic",),
    "validation.solvers": ("RunOptions", "Solver"),
}
"""Module of each name that is not of ``contact_scene``."""


def _installed_version() -> str:
    """The version the package was installed with, from the git tags."""
    from importlib import metadata

    try:
        return metadata.version("crosscontact")
    except metadata.PackageNotFoundError:
        return "0+unknown"


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return _installed_version()
    if name not in __all__:
        raise AttributeError(f"module 'crosscontact' has no attribute {name!r}")
    home = next((module for module, names in _HOMES.items() if name in names), "contact_scene")
    return getattr(import_module(home), name)


def __dir__() -> list[str]:
    return __all__
