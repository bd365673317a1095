"""The runs of a sweep as an ``xarray.Dataset``, and its files: netCDF, a table, the time series.

A grid has a dimension for each coordinate; a list of points or a sample one, ``run``, along which the
coordinates lie. For each measure there is a variable, for each error estimate one with ``ERROR``, relative;
``outcome`` and ``reason`` tell how each run ended, ``warnings`` where the model comes to its limits. What a
run does not have is NaN.
"""

from __future__ import annotations

import itertools
import math
import os
import shutil
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w

from contact_scene.errors import SceneError
from contact_scene.trace import Array
from validation.measure.difference import of_numbers
from validation.measure.scaling import dimension_of
from validation.runs.folder import move_whole
from validation.sweeps import batch_runs
from validation.sweeps.batch_runs import BATCH
from validation.sweeps.plan import Coordinate, SweepPlan
from validation.sweeps.run_plan import SweepRuns

if TYPE_CHECKING:
    import xarray

FILE, TABLE, TRACES = "sweep.nc", "sweep.csv", "traces"
ERROR = "_error"
"""Ending of the relative error estimate of a measure."""
AGAIN, APART = "solved_again", "largest_difference"
"""Attributes: how many runs of the batch solver the reference solved again, and by how much they differ."""
UNFINISHED_RUNS = "unfinished_runs"
"""Attribute: how many runs did not reach their end."""
SOLVED_BY = "solved_by"
"""Which solver gave a run, of a plan for the batch solver."""
RUN = "run"
"""Dimension of a list of points and of a sample."""
RUNS_PER_FILE = 500
"""Runs of one file of traces: some 10 MB, which is what is held in memory."""
HEAD = ("measure", "unit", "runs", "least", "median", "largest", "largest error")
_STAGE = ".sweep."
_PACKAGES = {"hdf5": "h5py", "parquet": "pyarrow"}
_WORDS = {"outcome": "how the run ended", "reason": "why it ended", "warnings": "warnings"}
_NOT_REPEATABLE = ("wall_seconds",)
"""Measures that differ from one attempt to the next."""


def check_writable(plan: SweepPlan | None = None) -> None:
    """Refuse a sweep before anything runs, if its results, or the traces of a plan, could not be written."""
    for package in ("xarray", "h5netcdf"):
        if find_spec(package) is None:
            raise SceneError("sweep", f"{package} is not installed", "pip install 'crosscontact[sweep]'")
    if plan is not None and plan.traces is not None and find_spec(_PACKAGES[plan.traces]) is None:
        package = _PACKAGES[plan.traces]
        raise SceneError("traces", f"{package} is not installed", f"pip install {package}")


def to_dataset(plan: SweepPlan, runs: SweepRuns) -> xarray.Dataset:
    """All runs of a plan by its coordinates (see the head of this module)."""
    import xarray

    if plan.design == "grid":
        along = {one.name: (one.name,) for one in plan.coordinates}
        values = [[row[0] for row in one.rows] for one in plan.coordinates]
    else:
        along = {one.name: (RUN,) for one in plan.coordinates}
        values = [[row[0] for row in rows] for rows in zip(*plan.rows(), strict=True)]
    dimensions = list(dict.fromkeys(name for names in along.values() for name in names))
    coordinates = {
        one.name: (along[one.name], np.array(numbers), _about_coordinate(one, plan))
        for one, numbers in zip(plan.coordinates, values, strict=True)
    }
    (columns, unfinished), apart = _columns(plan, runs), _differences(runs)
    variables = {
        name: (dimensions, column.reshape(plan.shape), _about(name, plan) | apart.get(name, {}))
        for name, column in columns.items()
    }
    attributes: dict[str, str | float] = {
        UNFINISHED_RUNS: unfinished,
        "title": plan.title,
        "scene": plan.scene.name,
        "scene_table": tomli_w.dumps(plan.scene.data),
        "solver": plan.solver,
        "resolution": "the solver's choice" if plan.resolution is None else plan.resolution,
        "design": plan.design,
        "drawn": ", ".join(plan.drawn),
    }
    if plan.solver == BATCH:
        largest = (apart[name][APART] for name in columns.keys() & apart.keys())
        attributes |= {AGAIN: len(runs.again), APART: max(largest, default=math.nan)}
    return xarray.Dataset(variables, coordinates, attributes)


def _differences(runs: SweepRuns) -> dict[str, dict[str, float]]:
    """By measure the largest relative difference from the reference; infinite where a run ends otherwise."""
    found: dict[str, float] = {}
    for one, other in runs.again:
        for each in of_numbers(one, other, sorted(one.measures.keys() & other.measures.keys())):
            apart = math.inf if one.outcome != other.outcome else 0.0 if each.missing else abs(each.error)
            found[each.quantity] = max(apart, found.get(each.quantity, 0.0))
    return {name: {APART: apart} for name, apart in found.items()}


def _columns(plan: SweepPlan, runs: SweepRuns) -> tuple[dict[str, np.ndarray], int]:
    """One-dimensional, in the order of the plan: numbers, then words; and how many runs are unfinished."""
    column = partial(np.full, plan.count, np.nan)
    numbers = defaultdict(column, {name: column() for name in plan.measures})
    words: dict[str, list[str]] = {name: [] for name in _WORDS}
    by: list[str] = []
    unfinished = 0
    for index, run in enumerate(runs):
        for ending, found in (("", run.measures), (ERROR, run.errors)):
            for name, value in found.items():
                wanted = name in plan.measures if plan.measures else name not in _NOT_REPEATABLE
                if wanted and value is not None and math.isfinite(value):
                    numbers[name + ending][index] = value
        for name, said in zip(_WORDS, (run.outcome, run.reason, "; ".join(run.warnings)), strict=True):
            words[name].append(said)
        by.append(run.solver)
        unfinished += not run.finished
    columns = dict(sorted(numbers.items())) | {name: np.array(said) for name, said in words.items()}
    return columns | ({SOLVED_BY: np.array(by)} if plan.solver == BATCH else {}), unfinished


def _about(name: str, plan: SweepPlan) -> dict[str, str]:
    if name in _WORDS or name == SOLVED_BY:
        return {"long_name": _WORDS.get(name, "solver")}
    if name.endswith(ERROR):
        return {"units": "1", "long_name": f"relative error estimate of {_plain(name.removesuffix(ERROR))}"}
    return {"units": plan.units.named(dimension_of(name)), "long_name": _plain(name)}


def _about_coordinate(one: Coordinate, plan: SweepPlan) -> dict[str, str]:
    return {
        "units": one.unit or plan.units.named(plan.scene.unit(one.paths[0])),
        "long_name": one.label or (one.name if "." in one.name else _plain(one.name)),
        "keys": ", ".join(one.paths),
        "scale": "log" if one.logarithmic else "linear",
    }


def _plain(name: str) -> str:
    return name.replace("pull_off", "pull-off").replace("_", " ").replace(".", " ")


def write_results(plan: SweepPlan, runs: SweepRuns, out: Path) -> xarray.Dataset:
    """Write ``sweep.nc``, ``sweep.csv`` and the traces; the data set.

    Both files are written whole or not at all, and the same data give the same bytes.
    """
    data = to_dataset(plan, runs)
    _write_traces(plan, runs, out)
    dimensions = list(data["outcome"].dims)
    frame = data.to_dataframe(dim_order=dimensions).reset_index()
    names = [*(name for name in data.coords if name != RUN), *data.data_vars]
    for left in out.glob(f"{_STAGE}*"):  # by a program that was killed
        shutil.rmtree(left, ignore_errors=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=_STAGE) as stage:
        frame[names].to_csv(Path(stage) / TABLE, index=False, lineterminator="\n")
        data.to_netcdf(Path(stage) / FILE, engine="h5netcdf")
        move_whole(Path(stage), out)
    return data


def read_dataset(folder: Path) -> xarray.Dataset:
    """The data set of a folder that a sweep was written to."""
    import xarray

    path, allowed = folder / FILE, "a folder written by `crosscontact sweep --out`"
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


def drawn_measures(data: xarray.Dataset) -> list[str]:
    """Names of the measures that the plan of a data set wants drawn, as far as the data set has them."""
    return [name for name in str(data.attrs.get("drawn", "")).split(", ") if name in data]


def summary_rows(data: xarray.Dataset) -> list[tuple[str, ...]]:
    """Heading and, for each measure that is drawn, how many runs have it and its range."""
    rows: list[tuple[str, ...]] = [HEAD]
    for name in drawn_measures(data):
        values = data[name].values[np.isfinite(data[name].values)]
        numbers = [f"{find(values):.6g}" if values.size else "-" for find in (np.min, np.median, np.max)]
        error = float(data[name + ERROR].max()) if name + ERROR in data else np.nan
        largest = f"{error:.1e}" if np.isfinite(error) else "-"
        rows.append((name, str(data[name].attrs.get("units", "")), str(values.size), *numbers, largest))
    return rows


def endings(data: xarray.Dataset) -> list[tuple[str, str, int]]:
    """Outcome, reason and number of runs, the most frequent first."""
    pairs = zip(data["outcome"].values.ravel(), data["reason"].values.ravel(), strict=True)
    counted = Counter((str(outcome), str(reason)) for outcome, reason in pairs)
    return [(outcome, reason, count) for (outcome, reason), count in counted.most_common()]


def _write_traces(plan: SweepPlan, runs: SweepRuns, out: Path) -> None:
    """Write all traces, where the plan keeps them, in place of those of an earlier plan."""
    if plan.traces is None:
        return
    stage, traces = out / f".{TRACES}.part", _traces(plan, runs)
    shutil.rmtree(stage, ignore_errors=True)
    stage.mkdir()
    write = _hdf5 if plan.traces == "hdf5" else _parquet
    for first in range(0, plan.count, RUNS_PER_FILE):
        last = min(first + RUNS_PER_FILE, plan.count) - 1
        found = [one for one in itertools.islice(traces, last + 1 - first) if one[2]]
        write(stage / f"runs-{first:07d}-{last:07d}", found)
    shutil.rmtree(out / TRACES, ignore_errors=True)
    stage.rename(out / TRACES)


Labelled = tuple[int, dict[str, Any], dict[str, Array]]
"""The number of a run, its coordinates, and the columns of its trace."""


def _traces(plan: SweepPlan, runs: SweepRuns) -> Iterator[Labelled]:
    for number, (run, rows) in enumerate(zip(runs, plan.rows(), strict=True)):
        labels = {one.name: row[0] for one, row in zip(plan.coordinates, rows, strict=True)}
        columns = {} if run.trace is None else run.trace.columns()
        given = batch_runs.COLUMNS if run.solver == BATCH else columns
        yield number, labels, {name: columns[name] for name in given if name in columns}


def _hdf5(path: Path, traces: Iterable[Labelled]) -> None:
    """A group for each run, named by its number, with the columns and the coordinates as attributes."""
    import h5py

    with h5py.File(path.with_suffix(".h5"), "w") as file:
        for index, labels, columns in traces:
            group = file.create_group(f"{index:07d}")
            for name, column in columns.items():
                group.create_dataset(name, data=column)
            group.attrs.update(labels)


def _parquet(path: Path, traces: Iterable[Labelled]) -> None:
    """One table, with the columns ``run`` and those of the coordinates in front."""
    import pyarrow
    from pyarrow import parquet

    tables = []
    for index, labels, columns in traces:
        head = {
            name: np.full(len(columns["time"]), value) for name, value in ({"run": index} | labels).items()
        }
        tables.append(pyarrow.table(head | columns))
    if tables:
        whole = pyarrow.concat_tables(tables, promote_options="default")
        parquet.write_table(whole, path.with_suffix(".parquet"))
