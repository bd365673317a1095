"""Carrying out a plan: only what is not stored, in batches, and each batch is stored when it is there.

A batch is as long as its overhead allows, so that a kill loses little: runs of some length travel alone. The
overhead of a task, of the processes and of Dask, is measured by ``python -m benchmarks.sweep_price``.
Without an executor a batch spares the writing of each run by itself.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from contact_scene.errors import SceneError
from validation.execution.engines import Engine
from validation.execution.pool import Task, TaskResult, completed_tasks
from validation.execution.process import keep_freed
from validation.execution.progress import duration
from validation.execution.provenance import version
from validation.execution.run_table import RunRecord, RunTable, StoredRun
from validation.sweeps.batch import BatchedRun, OtherVersion, SweepOptions, run_batch
from validation.sweeps.plan import Rows, SweepPlan

TAIL = 2
"""Batches for each place of an engine that the runs left are divided into, so that all workers end
together."""
SHORTEST = 4
"""Part of a full batch that is the least for that: a task costs Dask 2 to 8 ms of processor time, which is
to stay small beside its work, as is the start of a job in a queue."""


@dataclass(frozen=True)
class SweepRuns:
    """The runs of a plan, carried out.

    Parameters
    ----------
    keys : list of str
        Fingerprints, in the order of ``plan.rows()``.
    table : RunTable
        Holds them.
    failed : dict of str to StoredRun
        Those that the table does not hold because another attempt may end otherwise.
    """

    keys: list[str]
    table: RunTable
    failed: dict[str, StoredRun] = field(default_factory=dict)

    def record(self, key: str) -> RunRecord:
        """What is known about a run."""
        known = self.failed[key].record if key in self.failed else self.table.record(key)
        if known is None:
            raise LookupError(key)
        return known


def options_of(plan: SweepPlan) -> SweepOptions:
    """How the runs of a plan are carried out."""
    return SweepOptions(plan.solver, plan.resolution, plan.max_steps, plan.estimate)


def missing_runs(plan: SweepPlan, table: RunTable) -> tuple[list[str], dict[str, Rows]]:
    """Fingerprints of all runs of a plan, and those that are not stored, each once, with their rows."""
    options = options_of(plan)
    keys, missing = [], {}
    for rows in plan.rows():
        key = options.fingerprint(plan.scene(rows))
        keys.append(key)
        if key not in missing and not table.holds(key, bool(plan.traces)):
            missing[key] = rows
    return keys, missing


class _Batches:
    """Batches of the runs that are missing, sized by what the runs before them took.

    Parameters
    ----------
    plan : SweepPlan
    runs : list of (str, Rows)
        What is missing.
    engine : Engine
    largest : int or None
        Most runs of a batch, where it is known better than by their cost.
    """

    def __init__(
        self, plan: SweepPlan, runs: list[tuple[str, Rows]], engine: Engine, largest: int | None = None
    ) -> None:
        self._plan, self._runs, self._engine, self._largest = plan, runs, engine, largest
        self._seconds, self._done = 0.0, 0

    def measured(self, runs: list[BatchedRun]) -> None:
        """Take note of what runs took."""
        self._seconds += sum(run.stored.seconds for run in runs)
        self._done += len(runs)

    def __iter__(self) -> Iterator[tuple[int, Task]]:
        options, at = options_of(self._plan), 0
        while at < len(self._runs):
            size = self._size(len(self._runs) - at)
            scenes = [(key, self._plan.scene(rows)) for key, rows in self._runs[at : at + size]]
            label = f"runs {at + 1} to {at + len(scenes)}"
            arguments = (scenes, options, bool(self._plan.traces), version())
            yield at, Task(scenes[0][0], label, run_batch, arguments)
            at += len(scenes)

    def _size(self, left: int) -> int:
        if self._done == 0:  # what a run takes is not known yet
            return 1
        by_cost = round(self._engine.batch_seconds / max(self._seconds / self._done, 1e-6))
        tail = -(-left // (TAIL * self._engine.outstanding))
        size = max(1, min(by_cost, max(tail, by_cost // SHORTEST)))
        return size if self._largest is None else min(size, self._largest)


def carry_out(
    plan: SweepPlan,
    table: RunTable,
    engine: Engine | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> SweepRuns:
    """Run what is missing.

    Parameters
    ----------
    plan : SweepPlan
        Whose scenes can all be built.
    table : RunTable
        Holds the runs of earlier attempts and of other plans, and receives new ones.
    engine : Engine, optional
        By default this process.
    progress : callable, optional
        Called with the share of the runs that is done, 0 to 1, and a line of text: their number, rate and
        the remaining time.

    Returns
    -------
    SweepRuns

    Raises
    ------
    SceneError
        If a worker has another version of the program.
    """
    engine = engine or Engine()
    if engine.executor is None:
        keep_freed()  # as a worker process does
    keys, missing = missing_runs(plan, table)
    found = SweepRuns(keys, table)
    tell = _Teller(len(missing), len(keys), progress)
    left, largest = list(missing.items()), None
    while left:
        batches = _Batches(plan, left, engine, largest)
        again: list[tuple[str, Rows]] = []
        for at, result in completed_tasks(batches, engine.executor, engine.outstanding):
            if result.value is not None:
                batches.measured(result.value)
                _keep(result.value, found)
                tell(len(result.value))
                continue
            _refuse_other_version(result)
            lost = left[at : at + len(result.task.arguments[0])]
            if len(lost) > 1:  # one run may have ended the process of all: each for itself
                again += lost
                continue
            found.failed[lost[0][0]] = StoredRun(lost[0][0], RunRecord("failed", result.failure), 0.0)
            tell(1)
        left, largest = again, 1
    return found


def _keep(runs: list[BatchedRun], found: SweepRuns) -> None:
    found.table.put(run.stored for run in runs if run.repeatable)
    found.failed.update({run.stored.fingerprint: run.stored for run in runs if not run.repeatable})


def _refuse_other_version(result: TaskResult) -> None:
    if result.failure.startswith(OtherVersion.__name__):
        problem = result.failure.partition(": ")[2]
        raise SceneError("executor", problem, "the same installation on every worker")


class _Teller:
    """Tells how many runs are done, how many a second, and how long the rest will take."""

    def __init__(self, missing: int, total: int, progress: Callable[[float, str], None] | None) -> None:
        self._missing, self._total, self._progress = missing, total, progress
        self._done, self._began = 0, time.monotonic()

    def __call__(self, count: int) -> None:
        self._done += count
        if self._progress is None:
            return
        lasted = max(time.monotonic() - self._began, 1e-9)
        rate = self._done / lasted
        done = self._total - self._missing + self._done
        text = f"{done}/{self._total} runs, {rate:.3g} a second"
        if self._done < self._missing:
            text += f", about {duration((self._missing - self._done) / rate)} left"
        self._progress(self._done / self._missing, text)
