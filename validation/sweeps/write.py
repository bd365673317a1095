"""What a sweep leaves in its folder: data set, table, figures, traces; and the table a terminal shows."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.drawing.export import png, svg_file
from validation.execution.files import write_whole
from validation.sweeps.dataset import FILE, RUN, drawn_measures, to_dataset, write_dataset
from validation.sweeps.figures import errors_of, figures
from validation.sweeps.plan import SweepPlan
from validation.sweeps.run_plan import SweepRuns
from validation.sweeps.traces import write_traces

if TYPE_CHECKING:
    import xarray

TABLE = "sweep.csv"
HEAD = ("measure", "unit", "runs", "least", "median", "largest", "largest error")


def write_results(plan: SweepPlan, runs: SweepRuns, out: Path) -> xarray.Dataset:
    """Write ``sweep.nc``, ``sweep.csv`` and the traces.

    Returns
    -------
    xarray.Dataset
        What was written.
    """
    data = to_dataset(plan, runs)
    write_traces(plan, runs, out)
    write_whole(out / TABLE, table(data))
    write_dataset(data, out / FILE)
    return data


def draw(data: xarray.Dataset, out: Path) -> list[str]:
    """Draw the figures of a data set as PNG and SVG; their names."""
    drawn = figures(data)
    for name, figure in drawn.items():
        write_whole(out / f"{name}.png", png(figure))
        write_whole(out / f"{name}.svg", svg_file(figure))
    return list(drawn)


def table(data: xarray.Dataset) -> str:
    """All runs as CSV, one row each; numbers give themselves back, what a run does not have is empty."""
    names = [str(name) for name in data.coords if name != RUN] + [str(name) for name in data.data_vars]
    shape = next(iter(data.data_vars.values())).shape
    columns = [np.broadcast_to(_along(data, name), shape).reshape(-1) for name in names]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    for row in zip(*columns, strict=True):
        writer.writerow(["" if _missing(value) else value for value in row])
    return stream.getvalue()


def _along(data: xarray.Dataset, name: str) -> np.ndarray:
    """A variable, or a coordinate laid along its own dimension of all runs."""
    if name in data.data_vars or data[name].dims == (RUN,):
        return np.asarray(data[name].values)
    dimensions = list(next(iter(data.data_vars.values())).dims)
    shape = [1] * len(dimensions)
    shape[dimensions.index(name)] = data[name].size
    return np.asarray(data[name].values).reshape(shape)


def _missing(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


def summary_rows(data: xarray.Dataset) -> list[tuple[str, ...]]:
    """Heading and, for each measure that is drawn, how many runs have it and its range."""
    rows: list[tuple[str, ...]] = [HEAD]
    for name in drawn_measures(data):
        values = data[name].values[np.isfinite(data[name].values)]
        error = errors_of(data, name)
        numbers = (values.min(), np.median(values), values.max()) if values.size else ()
        rows.append(
            (
                name,
                str(data[name].attrs.get("units", "")),
                str(values.size),
                *([format(float(number), ".6g") for number in numbers] or ["-"] * 3),
                "-" if error is None else f"{error:.1e}",
            )
        )
    return rows


def endings(data: xarray.Dataset) -> list[tuple[str, str, int]]:
    """Outcome, reason and number of runs, the most frequent first."""
    pairs = zip(data["outcome"].values.ravel(), data["reason"].values.ravel(), strict=True)
    counted = Counter((str(outcome), str(reason)) for outcome, reason in pairs)
    return [(outcome, reason, count) for (outcome, reason), count in counted.most_common()]
