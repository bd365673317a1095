"""The runs of a sweep as an ``xarray.Dataset``, and as a netCDF file that stock xarray opens again."""

from __future__ import annotations

import os
import shutil
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from validation.execution.files import move_whole
from validation.sweeps.coordinates import Coordinate
from validation.sweeps.plan import SweepPlan
from validation.sweeps.run_plan import SweepRuns
from validation.sweeps.units import NONE, of_coordinate, of_measure

if TYPE_CHECKING:
    import xarray

FILE = "sweep.nc"
ERROR = "_error"
"""Ending of the relative error estimate of a measure."""
RUN = "run"
"""Dimension of a list of points and of a sample."""
_STAGE = ".sweep."
PACKAGES = ("xarray", "h5netcdf")


def check_installed() -> None:
    """Refuse a sweep before anything runs, if its results could not be written.

    Raises
    ------
    SceneError
    """
    for package in PACKAGES:
        if find_spec(package) is None:
            allowed = "pip install 'crosscontact[sweep]'"
            raise SceneError("sweep", f"{package} is not installed", allowed)


def to_dataset(plan: SweepPlan, runs: SweepRuns) -> xarray.Dataset:
    """All runs of a plan by its coordinates; what a run does not have is NaN.

    Parameters
    ----------
    plan : SweepPlan
    runs : SweepRuns

    Returns
    -------
    xarray.Dataset
        A grid has a dimension for each coordinate; a list of points or a sample one, ``run``, along which the
        coordinates lie. For each measure a variable, for each error estimate one with ``ERROR``, relative;
        ``outcome`` and ``reason`` tell how each run ended, ``warnings`` where the model comes to its limits.
    """
    import xarray

    columns = _columns(plan, runs)
    grid = plan.design == "grid"
    dimensions = tuple(coordinate.name for coordinate in plan.coordinates) if grid else (RUN,)
    variables = {
        name: (dimensions, column.reshape(plan.shape), _attributes(name, plan))
        for name, column in columns.items()
    }
    values = (
        [coordinate.values for coordinate in plan.coordinates]
        if grid
        else [[row[0] for row in column] for column in zip(*plan.rows(), strict=True)]
    )
    coordinates = {
        coordinate.name: (
            (coordinate.name,) if grid else (RUN,),
            np.array(numbers),
            _coordinate_attributes(coordinate, plan),
        )
        for coordinate, numbers in zip(plan.coordinates, values, strict=True)
    }
    attributes = {
        "title": plan.title,
        "scene": plan.base.name,
        "scene_table": tomli_w.dumps(plan.base.data),
        "solver": plan.solver,
        "resolution": "the solver's choice" if plan.resolution is None else plan.resolution,
        "design": plan.design,
        "drawn": ", ".join(plan.drawn),
    }
    return xarray.Dataset(variables, coordinates, attributes)


def _columns(plan: SweepPlan, runs: SweepRuns) -> dict[str, NDArray[Any]]:
    """One-dimensional, in the order of the plan: numbers by name, then the words."""
    count = len(runs.keys)
    numbers: dict[str, NDArray[np.float64]] = {}
    words: dict[str, list[str]] = {"outcome": [], "reason": [], "warnings": []}
    for index, key in enumerate(runs.keys):
        record = runs.record(key)
        words["outcome"].append(record.outcome)
        words["reason"].append(record.reason)
        words["warnings"].append("; ".join(record.warnings))
        for ending, found in (("", record.measures), (ERROR, record.errors)):
            for name, value in found.items():
                if plan.measures and name not in plan.measures:
                    continue
                numbers.setdefault(name + ending, np.full(count, np.nan))[index] = value
    for name in plan.measures:
        numbers.setdefault(name, np.full(count, np.nan))
    ordered: dict[str, NDArray[Any]] = {name: numbers[name] for name in sorted(numbers)}
    return ordered | {name: np.array(column) for name, column in words.items()}


def _attributes(name: str, plan: SweepPlan) -> dict[str, str]:
    if name in ("outcome", "reason", "warnings"):
        return {"long_name": {"outcome": "how the run ended", "reason": "why it ended"}.get(name, name)}
    if name.endswith(ERROR):
        return {"units": NONE, "long_name": f"relative error estimate of {_words(name.removesuffix(ERROR))}"}
    return {"units": of_measure(name, plan.units), "long_name": _words(name)}


def _coordinate_attributes(coordinate: Coordinate, plan: SweepPlan) -> dict[str, Any]:
    label = coordinate.label or (_words(coordinate.name) if "." not in coordinate.name else coordinate.name)
    return {
        "units": of_coordinate(coordinate, plan.base, plan.units),
        "long_name": label,
        "keys": ", ".join(coordinate.keys),
        "scale": "log" if coordinate.logarithmic else "linear",
    }


def _words(name: str) -> str:
    return name.replace("pull_off", "pull-off").replace("_", " ").replace(".", " ")


def drawn_measures(data: xarray.Dataset) -> list[str]:
    """Names of the measures that the plan of a data set wants drawn, as far as the data set has them."""
    names = str(data.attrs.get("drawn", "")).split(", ")
    return [name for name in names if name in data]


def write_dataset(data: xarray.Dataset, path: Path) -> None:
    """Write a netCDF file, whole or not at all; the same data give the same bytes."""
    for left in path.parent.glob(f"{_STAGE}*"):  # by a program that was killed
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=_STAGE) as stage:
        data.to_netcdf(Path(stage) / path.name, engine="h5netcdf")
        move_whole(Path(stage), path.parent)


def read_dataset(folder: Path) -> xarray.Dataset:
    """The data set of a folder that a sweep was written to.

    Raises
    ------
    SceneError
        If there is none, or one of another program.
    """
    import xarray

    path = folder / FILE
    allowed = "a folder written by `crosscontact sweep --out`"
    if not os.path.isfile(path):
        raise SceneError("", f"has no {FILE}", allowed, str(folder))
    try:
        with xarray.open_dataset(path, engine="h5netcdf") as data:
            found = data.load()
    except (OSError, ValueError) as error:
        raise SceneError("", f"cannot be read: {error}", allowed, str(path)) from None
    if not ({"scene_table", "drawn"} <= set(found.attrs) and {"outcome", "reason"} <= set(found.data_vars)):
        raise SceneError("", "is not the result of a sweep", allowed, str(path))
    return found
