"""Carrying out a plan: only what is not stored, and each run is stored when it is there."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import compress, islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import COLUMNS
from validation.cases import Case
from validation.runs.pool import Engine, Task, completed_tasks, run_of, run_task
from validation.runs.process import keep_freed
from validation.runs.progress import duration
from validation.runs.run import Run
from validation.runs.store import Store, dumps
from validation.solvers import REFERENCE
from validation.sweeps.batch_runs import BATCH, solve_all
from validation.sweeps.plan import Row, SweepPlan, measure_names

FILE = "runs.sqlite"
"""The store of a sweep, which keeps it."""
BYTES_OF_NUMBER = 8 + 20
"""A number in the data set, and its digits in the table."""
FIGURES_BYTES = 250_000
"""PNG and SVG of a measure, about."""
TOGETHER = 1024
"""Runs of a task of the batch solver: what a kill can lose of them, for each worker."""
SAMPLE, LEAST_SAMPLE = 0.01, 20
"""Share of the runs of the batch solver that the reference solves again, and how many at least."""
Progress = Callable[[float, str], None]
Flags = NDArray[np.bool_]


def store_of(folder: Path | None = None, fresh: bool = False) -> Store:
    """The runs of sweeps in a folder or, without one, in memory."""
    return Store(folder, fresh, FILE, folder is None)


@dataclass(frozen=True)
class SweepRuns:
    """The runs of a plan: fingerprints in the order of ``plan.rows()``, and the store that holds them.

    ``failed`` are those that are not stored because another attempt may end otherwise; ``again`` runs of the
    batch solver beside those of the reference.
    """

    keys: list[str]
    store: Store
    failed: dict[str, Run] = field(default_factory=dict)
    again: tuple[tuple[Run, Run], ...] = ()

    def __getitem__(self, key: str) -> Run:
        return self.failed.get(key) or self.store.get(key, Run)

    def __iter__(self) -> Iterator[Run]:
        return map(self.__getitem__, self.keys)


def task_of(plan: SweepPlan, rows: tuple[Row, ...]) -> Task:
    """The run at some values of the coordinates; two plans that ask for it share it.

    Of a plan for the batch solver it is what the reference makes of a scene that has no answer there.
    """
    case = Case("sweep", plan.scene_of(rows))
    task = run_task(case, plan.solver, plan.resolution, plan.estimate, plan.max_steps)
    asked = (case, REFERENCE, None) if plan.solver == BATCH else task.arguments
    return replace(task, function=partial(kept, plan.traces is not None, task.function), arguments=asked)


def kept(traces: bool, run: Callable[..., Run], *asked: Any) -> Run:
    """A run as a sweep keeps it."""
    return thinned(traces, run(*asked))


def thinned(traces: bool, result: Run) -> Run:
    """Without profiles, and without the rows of its trace unless ``traces`` are kept."""
    if result.trace is None:
        return result
    rows = slice(None if traces else 0)
    columns = {name: getattr(result.trace, name)[rows] for name in COLUMNS}
    extra = {name: column[rows] for name, column in result.trace.extra.items()}
    return replace(result, trace=replace(result.trace, **columns, extra=extra, profiles=()))


def batch_task(plan: SweepPlan, some: list[tuple[Row, ...]]) -> Task:
    """Some runs of a plan by the batch solver."""
    return Task("", "batch", solved_together, (plan, some))


def solved_together(plan: SweepPlan, some: list[tuple[Row, ...]]) -> list[Run]:
    """Runs of the batch solver as a sweep keeps them."""
    cases = [Case("sweep", plan.scene_of(rows)) for rows in some]
    return [thinned(plan.traces is not None, run) for run in solve_all(cases, plan.resolution, plan.estimate)]


def rows_of(plan: SweepPlan, chosen: Collection[int] | None) -> Iterator[tuple[Row, ...]]:
    """The values of all runs of a plan, or of those chosen."""
    return (rows for number, rows in enumerate(plan.rows()) if chosen is None or number in chosen)


def missing_runs(
    plan: SweepPlan, store: Store, chosen: Collection[int] | None = None
) -> tuple[list[str], Flags]:
    """Fingerprints of all runs of a plan, or of those chosen, and which are not stored; of equal ones one is.

    Values are made again when they are asked for: kept, they take three times the memory of fingerprints.
    """
    keys, missing, seen = list[str](), bytearray(), set[str]()
    for rows in rows_of(plan, chosen):
        keys.append(task_of(plan, rows).key)
        missing.append(keys[-1] not in seen and not _holds(store.get(keys[-1], Run), plan))
        seen.add(keys[-1])
    return keys, np.array(missing, bool)


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
    progress: Progress | None = None,
    chosen: Collection[int] | None = None,
) -> SweepRuns:
    """Run what the store does not hold of a plan whose scenes can all be built, and store it there.

    ``progress`` is called with the share of the missing runs that is done, 0 to 1, and a line of text: the
    number of runs, their rate and the remaining time. ``chosen``: numbers of runs; by default all.
    """
    engine = engine or Engine()
    if engine.executor is None:
        keep_freed()  # as a worker process does
    keys, missing = missing_runs(plan, store, chosen)
    found, tell = SweepRuns(keys, store), _teller(progress, len(keys), int(missing.sum()))
    if plan.solver == BATCH:
        missing = _by_batch(plan, rows_of(plan, chosen), found, missing, engine, tell)
    tasks = enumerate(task_of(plan, rows) for rows in compress(rows_of(plan, chosen), missing))
    for _, result in completed_tasks(tasks, engine, int(missing.sum())):
        run = run_of(result)
        if run.breakdown:
            found.failed[result.task.key] = run
        else:
            store.put(result.task.key, run)
        tell(1)
    return found


def _teller(progress: Progress | None, runs: int, missing: int) -> Callable[[int], None]:
    """Told how many runs more are done."""
    began, done = time.monotonic(), 0

    def tell(more: int) -> None:
        nonlocal done
        done += more
        if progress is None or not more:
            return
        rate = done / max(time.monotonic() - began, 1e-9)
        left = missing - done
        rest = f", about {duration(left / rate)} left" if left else ""
        progress(done / missing, f"{runs - left}/{runs} runs, {rate:.3g} a second{rest}")

    return tell


def _by_batch(
    plan: SweepPlan,
    every: Iterator[tuple[Row, ...]],
    found: SweepRuns,
    missing: Flags,
    engine: Engine,
    tell: Callable[[int], None],
) -> Flags:
    """Store what the batch solver answers; what it leaves open, a batch whose process has ended too.

    Batches are the same whatever is stored: they are stored whole, so that an interrupted sweep solves no
    scene in other company, and gives the same bits.
    """
    rows, numbers, left = compress(every, missing), np.flatnonzero(missing), missing.copy()
    batches = np.split(numbers, np.flatnonzero(np.diff(numbers // TOGETHER)) + 1)
    tasks = enumerate(batch_task(plan, [*islice(rows, len(some))]) for some in batches if len(some))
    for place, result in completed_tasks(tasks, engine, len(batches)):
        runs = zip(batches[place].tolist(), result.value or (), strict=False)
        answered = {number: run for number, run in runs if run.trace is not None}
        found.store.put_all({found.keys[number]: run for number, run in answered.items()})
        left[[*answered]] = False
        tell(len(answered))
    return left


def sample_size(plan: SweepPlan) -> int:
    """Runs of the batch solver that the reference solves again."""
    return min(plan.count, max(LEAST_SAMPLE, math.ceil(SAMPLE * plan.count)))


def solved_again(
    plan: SweepPlan, runs: SweepRuns, engine: Engine | None = None, progress: Progress | None = None
) -> SweepRuns:
    """The runs of a plan, beside those of the batch solver in a sample what the reference makes of them."""
    if plan.solver != BATCH:
        return runs
    drawn = sorted(np.random.default_rng(0).choice(plan.count, sample_size(plan), replace=False).tolist())
    own = {i: run for i in drawn if (run := runs[runs.keys[i]]).solver == BATCH}
    other = replace(plan, solver=REFERENCE, resolution=None, estimate=False, traces=None)
    again = carry_out(other, runs.store, engine, progress, own.keys())
    return replace(runs, again=tuple(zip(own.values(), again, strict=True)))


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
    lacking = set(compress(keys, missing))
    stored = [key for key in keys if key not in lacking]
    sample: list[Run] = [store.get(key, Run) for key in stored[:: max(1, len(stored) // 200)]]
    if not sample:
        sample = _first_runs(plan, [*islice(compress(plan.rows(), missing), TOGETHER)])
    spent = sum(run.cpu_seconds + run.estimate_seconds for run in sample) / len(sample)
    again = sample_size(plan) * _first_run(plan, plan.rows()).cpu_seconds if plan.solver == BATCH else 0.0
    rows = [trace.columns().values() for run in sample if (trace := run.trace) is not None]
    numbers = len(plan.measures or measure_names(plan.scene.with_values({}))) * (2 if plan.estimate else 1)
    of_run = max(len(dumps(run)) for run in sample) + BYTES_OF_NUMBER * numbers
    of_run += max((sum(column.nbytes for column in columns) for columns in rows), default=0)
    size = float(of_run * len(keys) + FIGURES_BYTES * len(plan.drawn))
    measured = len(sample) if stored else 0
    return SweepForecast(len(keys), len(stored), spent * missing.sum() + again, spent, measured, size)


def _first_runs(plan: SweepPlan, first: list[tuple[Row, ...]]) -> list[Run]:
    """The first run that is missing, or a batch of them; what has no answer there, as the first of these."""
    if plan.solver != BATCH:
        return [_first_run(plan, first)]
    task = batch_task(plan, first)
    found = dict(zip(first, task.function(*task.arguments), strict=True))
    left = [rows for rows, run in found.items() if run.trace is None]
    answered = [run for run in found.values() if run.trace is not None]
    return answered + ([_first_run(plan, left)] * len(left) if left else [])


def _first_run(plan: SweepPlan, rows: Iterable[tuple[Row, ...]]) -> Run:
    first = task_of(plan, next(iter(rows)))
    run: Run = first.function(*first.arguments)
    return run
