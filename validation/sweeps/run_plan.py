"""Carrying out a plan: only what is not stored, and each run is stored when it is there."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from contact_scene import COLUMNS
from validation.cases import Case
from validation.runs.pool import Engine, Task, completed_tasks, run_of, run_task
from validation.runs.process import keep_freed
from validation.runs.progress import duration
from validation.runs.run import Run
from validation.runs.store import Store, dumps
from validation.sweeps.plan import Row, SweepPlan, measure_names

FILE = "runs.sqlite"
"""The store of a sweep, which keeps it."""
BYTES_OF_NUMBER = 8 + 20
"""A number in the data set, and its digits in the table."""
FIGURES_BYTES = 250_000
"""PNG and SVG of a measure, about."""


def store_of(folder: Path | None = None, fresh: bool = False) -> Store:
    """The runs of sweeps in a folder or, without one, in memory."""
    return Store(folder, fresh, FILE, folder is None)


@dataclass(frozen=True)
class SweepRuns:
    """The runs of a plan: fingerprints in the order of ``plan.rows()``, and the store that holds them.

    ``failed`` are those that are not stored because another attempt may end otherwise.
    """

    keys: list[str]
    store: Store
    failed: dict[str, Run] = field(default_factory=dict)

    def __getitem__(self, key: str) -> Run:
        return self.failed.get(key) or self.store.get(key, Run)

    def __iter__(self) -> Iterator[Run]:
        return map(self.__getitem__, self.keys)


def task_of(plan: SweepPlan, rows: tuple[Row, ...]) -> Task:
    """The run at some values of the coordinates; two plans that ask for it share it."""
    case = Case("sweep", plan.scene_of(rows))
    task = run_task(case, plan.solver, plan.resolution, plan.estimate, plan.max_steps)
    return replace(task, function=partial(kept, plan.traces is not None, task.function))


def kept(traces: bool, run: Callable[..., Run], *asked: Any) -> Run:
    """A run as a sweep keeps it: of its trace no rows, unless ``traces`` are kept, and no profiles."""
    result = run(*asked)
    if result.trace is None:
        return result
    rows = slice(None if traces else 0)
    columns = {name: getattr(result.trace, name)[rows] for name in COLUMNS}
    extra = {name: column[rows] for name, column in result.trace.extra.items()}
    return replace(result, trace=replace(result.trace, **columns, extra=extra, profiles=()))


def missing_runs(plan: SweepPlan, store: Store) -> tuple[list[str], dict[str, tuple[Row, ...]]]:
    """Fingerprints of all runs of a plan, and the values of those that are not stored, each once."""
    rows_of = [(task_of(plan, rows).key, rows) for rows in plan.rows()]
    missing = {key: rows for key, rows in rows_of if not _holds(store.get(key, Run), plan)}
    return [key for key, _ in rows_of], missing


def _holds(stored: Run | None, plan: SweepPlan) -> bool:
    """Whether a run is stored, with its rows if the plan keeps them and the run has any."""
    if stored is None:
        return False
    trace = stored.trace
    return plan.traces is None or trace is None or len(trace) > 0 or trace.counters.steps == 0


def carry_out(
    plan: SweepPlan,
    store: Store,
    engine: Engine | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> SweepRuns:
    """Run what the store does not hold of a plan whose scenes can all be built, and store it there.

    ``progress`` is called with the share of the missing runs that is done, 0 to 1, and a line of text: the
    number of runs, their rate and the remaining time.
    """
    engine = engine or Engine()
    if engine.executor is None:
        keep_freed()  # as a worker process does
    keys, missing = missing_runs(plan, store)
    found, began, before = SweepRuns(keys, store), time.monotonic(), len(keys) - len(missing)
    tasks = enumerate(task_of(plan, rows) for rows in missing.values())
    for done, (_, result) in enumerate(completed_tasks(tasks, engine, len(missing)), 1):
        run = run_of(result)
        if run.breakdown:
            found.failed[result.task.key] = run
        else:
            store.put(result.task.key, run)
        if progress is not None:
            rate = done / max(time.monotonic() - began, 1e-9)
            left = len(missing) - done
            rest = f", about {duration(left / rate)} left" if left else ""
            progress(done / len(missing), f"{before + done}/{len(keys)} runs, {rate:.3g} a second{rest}")
    return found


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


def forecast(plan: SweepPlan, store: Store) -> SweepForecast:
    """Forecast a sweep by the runs that are stored; where there are none, its first run is carried out."""
    keys, missing = missing_runs(plan, store)
    stored = [key for key in keys if key not in missing]
    sample: list[Run] = [store.get(key, Run) for key in stored[:: max(1, len(stored) // 200)]]
    if not sample:
        first = task_of(plan, next(iter(missing.values())))
        sample = [first.function(*first.arguments)]
    spent = sum(run.cpu_seconds + run.estimate_seconds for run in sample) / len(sample)
    rows = [trace.columns().values() for run in sample if (trace := run.trace) is not None]
    numbers = len(plan.measures or measure_names(plan.scene.with_values({}))) * (2 if plan.estimate else 1)
    of_run = max(len(dumps(run)) for run in sample) + BYTES_OF_NUMBER * numbers
    of_run += max((sum(column.nbytes for column in columns) for columns in rows), default=0)
    size = float(of_run * len(keys) + FIGURES_BYTES * len(plan.drawn))
    measured = len(sample) if stored else 0
    return SweepForecast(len(keys), len(stored), spent * len(missing), spent, measured, size)
