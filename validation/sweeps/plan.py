"""Plans of sweeps: a scene, what varies of it and how, the solver, what is kept; read from TOML.

::

    scene = "retraction-fast"        # built-in, or a file beside the plan
    solver = "reference"             # default
    resolution = 4                   # default: the solver's choice
    design = "grid"                  # default | "points" | "latin-hypercube" | "sobol"

    [[coordinates]]
    name = "speed"                   # default: the key
    key = "loading.steps.0.rate"     # or keys = [...], with factors = [...] or with a list of values for each
    geomspace = [1e-5, 100.0, 40]    # or linspace, values; of a sample: range = [low, high], scale = "log"

A sample also has ``points``, how many, and ``seed``. ``estimate = false`` leaves the error estimates out,
``measures`` names those that the data set holds (default: all), ``traces = "hdf5"`` or ``"parquet"`` keeps
the time series, ``max_steps`` bounds a run, ``drawn`` names the measures that are drawn, and ``[units]``
gives the names of the units of ``length``, ``force`` and ``time``.
"""

from __future__ import annotations

import itertools
import math
import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact_scene import Scene
from contact_scene.errors import SceneError, shown
from contact_scene.files import read_text
from contact_scene.run_control.options import whole_number
from contact_scene.value_checks import one_of
from validation import solvers
from validation.sweeps.coordinates import MOST_RUNS, Coordinate
from validation.sweeps.plan_entries import (
    read_coordinates,
    read_flag,
    read_measures,
    read_optional,
    read_points,
    read_units,
    refuse_names_of_measures,
)
from validation.sweeps.samples import DESIGNS, SAMPLES, shares
from validation.sweeps.scene_table import SceneTable, builtin_or_file

PLANS = Path(__file__).with_name("plans")
"""Folder of the built-in plans."""
_KEYS = (
    "title", "scene", "solver", "resolution", "max_steps", "design", "points", "seed", "estimate", "measures",
    "traces", "drawn", "units", "coordinates",
)  # fmt: skip
TRACE_FILES = ("hdf5", "parquet")
DRAWN = ("pull_off_force", "pull_off_penetration", "dissipated_energy")
"""Measures that are drawn unless the plan names others."""
Rows = tuple[tuple[Any, ...], ...]


@dataclass(frozen=True)
class SweepPlan:
    """What is to be run.

    Parameters
    ----------
    base : SceneTable
        The scene that is varied.
    coordinates : tuple of Coordinate
    solver : str
    resolution, max_steps : int or None
        ``None``: the solver's choice.
    design : str
        "grid": every value of one coordinate with every value of the others; "points": the first values of
        all, the second values of all, ...; or a sample.
    points, seed : int
        Of a sample: how many, and which.
    estimate : bool
        Whether errors are estimated.
    measures : tuple of str
        Those the data set holds; empty: all.
    traces : str
        "hdf5" or "parquet", if the time series are kept; else empty.
    drawn : tuple of str
        Measures of the figures.
    units : mapping of str to str
        Names of the units of length, force and time.
    title : str
    """

    base: SceneTable
    coordinates: tuple[Coordinate, ...]
    solver: str = solvers.REFERENCE
    resolution: int | None = None
    max_steps: int | None = None
    design: str = "grid"
    points: int = 0
    seed: int = 0
    estimate: bool = True
    measures: tuple[str, ...] = ()
    traces: str = ""
    drawn: tuple[str, ...] = DRAWN
    units: Mapping[str, str] = field(default_factory=dict)
    title: str = ""

    @property
    def shape(self) -> tuple[int, ...]:
        """Runs along each dimension of the data set."""
        if self.design == "grid":
            return tuple(len(coordinate.rows) for coordinate in self.coordinates)
        return (self.points if self.design in SAMPLES else len(self.coordinates[0].rows),)

    @property
    def count(self) -> int:
        """Number of runs."""
        return math.prod(self.shape)

    def rows(self) -> Iterator[Rows]:
        """For each run, in the order of the data set, the row of every coordinate."""
        if self.design == "grid":
            yield from itertools.product(*(coordinate.rows for coordinate in self.coordinates))
        elif self.design in SAMPLES:
            for point in shares(self.design, len(self.coordinates), self.points, self.seed):
                pairs = zip(self.coordinates, point, strict=True)
                yield tuple(coordinate.sampled(float(share)) for coordinate, share in pairs)
        else:
            yield from zip(*(coordinate.rows for coordinate in self.coordinates), strict=True)

    def scene(self, rows: Rows) -> Scene:
        """The scene of a run.

        Raises
        ------
        SceneError
            If the scene refuses the values, or has no such key; says where in the plan.
        """
        pairs = [(c.keys, row) for c, row in zip(self.coordinates, rows, strict=True)]
        settings = {key: value for keys, row in pairs for key, value in zip(keys, row, strict=True)}
        try:
            return self.base.scene(settings)
        except SceneError as error:
            at = ", ".join(
                f"{c.name} = {shown(row[0])}" for c, row in zip(self.coordinates, rows, strict=True)
            )
            raise SceneError(f"{error.key or 'scene'} at {at}", error.problem, error.allowed) from None

    def check(self) -> None:
        """Build every scene, so that a bad value is refused before anything runs.

        Raises
        ------
        SceneError
        """
        for rows in self.rows():
            self.scene(rows)


def read_plan(name: str) -> SweepPlan:
    """A plan file, or a built-in plan by name; every scene of it is one that can be built.

    Raises
    ------
    SceneError
        One line: file, key, what is wrong, what is allowed.
    """
    file = PLANS / f"{name}.toml" if name in plan_names() else Path(name)
    if not os.path.isfile(file):
        allowed = f"a TOML file, or one of {', '.join(plan_names())}"
        raise SceneError("PLAN", f"{shown(name)} is no file and no built-in plan", allowed)
    try:
        data = tomllib.loads(read_text(file))
    except ValueError as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError("", f"not a TOML file: {error}", "a plan of a sweep", str(file)) from None
    try:
        plan = plan_from_dict(data, file.parent)
        plan.check()
    except SceneError as error:
        raise error.in_file(str(file)) from None
    return plan


def plan_names() -> list[str]:
    """Names of the built-in plans."""
    return sorted(file.stem for file in PLANS.glob("*.toml"))


def plan_from_dict(data: dict[str, Any], folder: Path, base: SceneTable | None = None) -> SweepPlan:
    """A plan from the contents of its file.

    Parameters
    ----------
    data : dict
    folder : Path
        In which scene files are looked up.
    base : SceneTable, optional
        The scene, in place of the one that is named.

    Returns
    -------
    SweepPlan

    Raises
    ------
    SceneError
    """
    for key in data:
        if key not in _KEYS:
            raise SceneError(str(key), "unknown key", ", ".join(_KEYS))
    if base is None:
        name = data.get("scene")
        if not isinstance(name, str) or not name:
            raise SceneError("scene", f"got {shown(name)}", "the name of a built-in scene or of a scene file")
        base = builtin_or_file(name, folder)
    design = one_of(data.get("design", "grid"), "design", DESIGNS)
    coordinates = read_coordinates(data.get("coordinates"), design)
    refuse_names_of_measures(coordinates, base)
    solver = one_of(data.get("solver", solvers.REFERENCE), "solver", tuple(solvers.SOLVERS))
    least = solvers.solver(solver).least_resolution
    title = data.get("title", "")
    if not isinstance(title, str):
        raise SceneError("title", f"got {shown(title)}", "a string")
    plan = SweepPlan(
        base,
        coordinates,
        solver,
        read_optional(data, "resolution", least),
        read_optional(data, "max_steps", 1),
        design,
        read_points(data, design),
        whole_number(data.get("seed", 0), "seed", 0),
        read_flag(data, "estimate", True),
        read_measures(data, "measures", (), base),
        "" if data.get("traces") is None else one_of(data["traces"], "traces", TRACE_FILES),
        read_measures(data, "drawn", DRAWN, base),
        read_units(data.get("units", {})),
        title,
    )
    if plan.count > MOST_RUNS:
        raise SceneError("coordinates", f"make {plan.count} runs", f"at most {MOST_RUNS}")
    return plan
