"""The time series of a sweep in files of some hundred runs each, HDF5 or Parquet, in order of the plan."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from contact_scene.errors import SceneError
from validation.execution.run_table import Columns
from validation.sweeps.plan import SweepPlan
from validation.sweeps.run_plan import SweepRuns

FOLDER = "traces"
RUNS_PER_FILE = 500
"""Runs of one file: some 10 MB at 200 rows and a dozen columns a run, which is what is held in memory."""
_PACKAGES = {"hdf5": "h5py", "parquet": "pyarrow"}


def check_writable(plan: SweepPlan) -> None:
    """Refuse traces before anything runs, if they could not be written.

    Raises
    ------
    SceneError
    """
    if plan.traces and find_spec(_PACKAGES[plan.traces]) is None:
        problem = f"{_PACKAGES[plan.traces]} is not installed"
        raise SceneError("traces", problem, f"pip install {_PACKAGES[plan.traces]}")


def write_traces(plan: SweepPlan, runs: SweepRuns, out: Path) -> None:
    """Write all traces, where the plan keeps them, in place of those of an earlier plan.

    HDF5: a group for each run, named by its number, with the columns and the coordinates as attributes.
    Parquet: one table, with the columns ``run`` and those of the coordinates in front.
    """
    folder = out / FOLDER
    if not plan.traces:
        return
    stage = out / f".{FOLDER}.part"
    shutil.rmtree(stage, ignore_errors=True)
    stage.mkdir()
    labels = [{c.name: row[0] for c, row in zip(plan.coordinates, rows, strict=True)} for rows in plan.rows()]
    for first in range(0, len(runs.keys), RUNS_PER_FILE):
        block = range(first, min(first + RUNS_PER_FILE, len(runs.keys)))
        name = f"runs-{block[0]:07d}-{block[-1]:07d}"
        if plan.traces == "hdf5":
            _hdf5(stage / f"{name}.h5", block, labels, runs)
        else:
            _parquet(stage / f"{name}.parquet", block, labels, runs)
    shutil.rmtree(folder, ignore_errors=True)
    stage.rename(folder)


def _traces(block: range, runs: SweepRuns) -> Iterator[tuple[int, Columns]]:
    for index in block:
        key = runs.keys[index]
        columns = runs.failed[key].columns if key in runs.failed else runs.table.columns(key)
        if columns is not None:
            yield index, columns


def _hdf5(path: Path, block: range, labels: Sequence[dict[str, object]], runs: SweepRuns) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for index, columns in _traces(block, runs):
            group = file.create_group(f"{index:07d}")
            for name, column in columns.items():
                group.create_dataset(name, data=column)
            group.attrs.update(labels[index])


def _parquet(path: Path, block: range, labels: Sequence[dict[str, object]], runs: SweepRuns) -> None:
    import pyarrow
    from pyarrow import parquet

    tables = []
    for index, columns in _traces(block, runs):
        rows = len(columns["time"])
        head = {"run": np.full(rows, index)} | {k: np.full(rows, v) for k, v in labels[index].items()}
        tables.append(pyarrow.table(head | columns))
    if tables:
        parquet.write_table(pyarrow.concat_tables(tables, promote_options="default"), path)
