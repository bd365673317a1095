"""How many runs, how long and how large a sweep will be, before it runs."""

from __future__ import annotations

from dataclasses import dataclass

from contact_scene import Scene
from validation import solvers
from validation.cases import Case
from validation.execution.run_table import RunTable
from validation.execution.solver_tasks import expected_seconds
from validation.solvers.cost import relative_time
from validation.sweeps.batch import SweepOptions
from validation.sweeps.plan import SweepPlan
from validation.sweeps.plan_entries import measure_names
from validation.sweeps.run_plan import missing_runs, options_of

SAMPLED = 200
"""Runs whose cost is forecast one by one; of more, so many are, evenly chosen."""
TRACE_COLUMNS = 12
"""Columns of a trace, about: those of every solver and a few of its own."""
BYTES_OF_NUMBER = 8 + 20 + 40
"""A number in the data set, its digits in the table, and name and digits in the file of stored runs."""
FIGURES_BYTES = 250_000
"""PNG and SVG of a measure, about."""


@dataclass(frozen=True)
class SweepForecast:
    """What a sweep will take.

    Parameters
    ----------
    runs, stored : int
        All runs, and those that are stored already.
    seconds : float
        Processor time of the others.
    per_run : float
        The same of one of them, on average.
    measured : int
        Stored runs of the plan whose time corrects the forecast of the others; 0: none.
    bytes : float
        Of all files: stored runs, data set, table, figures, and traces if they are kept.
    """

    runs: int
    stored: int
    seconds: float
    per_run: float
    measured: int
    bytes: float


def forecast(plan: SweepPlan, table: RunTable) -> SweepForecast:
    """Forecast a sweep: by the solvers' measured cost models, corrected by the runs that are stored.

    Parameters
    ----------
    plan : SweepPlan
    table : RunTable

    Returns
    -------
    SweepForecast
    """
    keys, missing = missing_runs(plan, table)
    options = options_of(plan)
    every = max(1, len(missing) // SAMPLED)
    chosen = list(missing.values())[::every]
    model = sum(_modelled(plan, plan.scene(rows), options) for rows in chosen) / max(len(chosen), 1)
    spent = modelled = 0.0
    measured = 0
    stored = [(key, rows) for key, rows in zip(keys, plan.rows(), strict=True) if key not in missing]
    for key, rows in stored[:: max(1, len(stored) // SAMPLED)]:
        seconds = table.seconds(key)
        if seconds:
            spent, modelled = spent + seconds, modelled + _modelled(plan, plan.scene(rows), options)
            measured += 1
    per_run = model * spent / modelled if modelled > 0.0 else model
    return SweepForecast(
        len(keys), len(stored), per_run * len(missing), per_run, measured, _bytes(plan, len(keys))
    )


def _modelled(plan: SweepPlan, scene: Scene, options: SweepOptions) -> float:
    case = Case("sweep", scene)
    seconds = expected_seconds(case, plan.solver, plan.resolution, plan.max_steps)
    return seconds * relative_time(options.estimate)


def _bytes(plan: SweepPlan, runs: int) -> float:
    scene = plan.scene(next(iter(plan.rows())))
    numbers = len(plan.measures or measure_names(scene)) * (2 if plan.estimate else 1)
    size = float(BYTES_OF_NUMBER * numbers * runs + FIGURES_BYTES * len(plan.drawn))
    if plan.traces:
        cost = solvers.solver(plan.solver).expected_cost(scene, plan.resolution).within(plan.max_steps)
        size += 8.0 * TRACE_COLUMNS * cost.steps * runs
    return size
