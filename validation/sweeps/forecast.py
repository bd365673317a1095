"""How many runs, how long and how large a sweep will be, before it runs."""

from __future__ import annotations

from dataclasses import dataclass

from validation.execution.provenance import version
from validation.execution.run_table import RunTable
from validation.sweeps.batch import run_batch
from validation.sweeps.plan import SweepPlan
from validation.sweeps.plan_entries import measure_names
from validation.sweeps.run_plan import missing_runs, options_of

SAMPLED = 200
"""Stored runs whose time is looked up; of more, so many are, evenly chosen."""
BYTES_OF_NUMBER = 8 + 20 + 40
"""A number in the data set, its digits in the table, and name and digits in the file of stored runs."""
FIGURES_BYTES = 250_000
"""PNG and SVG of a measure, about."""


@dataclass(frozen=True)
class SweepForecast:
    """What a sweep will take: ``runs`` of which some are ``stored``, processor time of the others and
    ``per_run`` (s) as ``measured`` on so many stored runs (0: on the first one, carried out), bytes of all
    files."""

    runs: int
    stored: int
    seconds: float
    per_run: float
    measured: int
    bytes: float


def forecast(plan: SweepPlan, table: RunTable) -> SweepForecast:
    """Forecast a sweep by the runs that are stored; where there are none, its first run is carried out."""
    keys, missing = missing_runs(plan, table)
    stored = [key for key in keys if key not in missing]
    spent = [seconds for key in stored[:: max(1, len(stored) // SAMPLED)] if (seconds := table.seconds(key))]
    scene = plan.scene(next(iter(plan.rows())))
    numbers = len(plan.measures or measure_names(scene)) * (2 if plan.estimate else 1)
    size = float(BYTES_OF_NUMBER * numbers * len(keys) + FIGURES_BYTES * len(plan.drawn))
    per_run = sum(spent) / len(spent) if spent else 0.0
    if missing and (plan.traces or not spent):
        key, rows = next(iter(missing.items()))
        (first,) = run_batch([(key, plan.scene(rows))], options_of(plan), bool(plan.traces), version())
        per_run = per_run or first.stored.seconds
        columns = first.stored.columns or {}
        size += len(keys) * sum(8.0 * len(column) for column in columns.values())
    return SweepForecast(len(keys), len(stored), per_run * len(missing), per_run, len(spent), size)
