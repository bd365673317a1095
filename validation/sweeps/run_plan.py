"""Carrying out a plan: only what is not stored, in batches, and each batch is stored when it is there.

A batch is as long as its overhead allows, so that a kill loses little: runs of some length travel alone. The
overhead of a task, of the processes and of Dask, is measured by ``python -m benchmarks.sweep_price``.
Without an executor a batch spares the writing of each run by itself.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from contact_scene import Scene
from contact_scene.errors import SceneError
from validation.cases import Case
from validation.runs.pool import Engine, Task, completed_tasks, origin_of
from validation.runs.process import keep_freed
from validation.runs.progress import duration
from validation.runs.provenance import fingerprint, version
from validation.runs.run import Run, run
from validation.runs.store import Columns, RunRecord, RunTable, StoredRun
from validation.sweeps.plan import Row, SweepPlan, measure_names

NOT_REPEATABLE = ("wall_seconds",)
"""Measures that differ from one attempt to the next."""
TAIL, SHORTEST = 2, 4
"""The runs left are divided into so many batches for each place of an engine, so that all workers end
together, but into none shorter than that part of a full one: a task costs Dask 2 to 8 ms."""
BYTES_OF_NUMBER = 8 + 20 + 40
"""A number in the data set, its digits in the table, and name and digits in the file of stored runs."""
FIGURES_BYTES = 250_000
"""PNG and SVG of a measure, about."""
Missing = dict[str, tuple[Row, ...]]
"""Runs that are not stored: rows of the coordinates by fingerprint."""


class OtherVersion(RuntimeError):
    """A worker has other sources of this program than the process that asks it."""


@dataclass(frozen=True)
class RunSettings:
    """How every run of a sweep is carried out; ``traces``: whether their traces are kept."""

    solver: str
    resolution: int | None = None
    max_steps: int | None = None
    estimate: bool = True
    traces: bool = False

    @classmethod
    def of(cls, plan: SweepPlan) -> RunSettings:
        """Of the runs of a plan."""
        return cls(plan.solver, plan.resolution, plan.max_steps, plan.estimate, plan.traces is not None)

    def fingerprint(self, scene: Scene) -> str:
        """Of a run on a scene: two plans that ask for it share it."""
        settings = (self.solver, self.resolution, self.max_steps, self.estimate)
        return fingerprint("sweep", scene, *settings, *origin_of(self.solver))

    def carried_out(self, key: str, scene: Scene) -> StoredRun:
        """A run as it is stored."""
        case = Case("sweep", scene)
        result = run(case, self.solver, self.resolution, estimate=self.estimate, max_steps=self.max_steps)
        columns = result.trace.columns() if self.traces and result.trace is not None else None
        return StoredRun(key, record_of(result), result.cpu_seconds + result.estimate_seconds, columns)


def record_of(result: Run) -> RunRecord:
    """What a sweep keeps of a run: finite numbers."""
    if result.trace is None:
        return RunRecord(result.outcome, result.failure)
    measures, errors = (
        {name: float(value) for name, value in found.items() if value is not None and math.isfinite(value)}
        for found in (result.measures, result.errors)
    )
    for name in NOT_REPEATABLE:
        measures.pop(name, None)
    reason, rows = result.trace.outcome.reason, len(result.trace)
    return RunRecord(result.outcome, reason, result.finished, measures, errors, result.warnings, rows)


def run_batch(scenes: Sequence[tuple[str, Scene]], settings: RunSettings, sources: str) -> list[StoredRun]:
    """Carry out runs one after the other, in a worker; ``sources``: ``version()`` where the batch was made.

    Raises :class:`OtherVersion` if this process has other sources: its numbers would be kept under a wrong
    fingerprint.
    """
    if sources != version():
        raise OtherVersion("a worker has another version of crosscontact, NumPy, SciPy or Python")
    return [settings.carried_out(key, scene) for key, scene in scenes]


@dataclass(frozen=True)
class SweepRuns:
    """The runs of a plan: fingerprints in the order of ``plan.rows()``, and the table that holds them.

    ``failed`` are those that the table does not hold because another attempt may end otherwise: the memory or
    the worker gave out.
    """

    keys: list[str]
    table: RunTable
    failed: dict[str, RunRecord] = field(default_factory=dict)

    def record(self, key: str) -> RunRecord:
        """What is known about a run."""
        known = self.failed.get(key) or self.table.record(key)
        if known is None:
            raise LookupError(key)
        return known

    def columns(self, key: str) -> Columns | None:
        """The trace of a run, if it is kept."""
        return None if key in self.failed else self.table.columns(key)

    def keep(self, runs: Sequence[StoredRun]) -> None:
        """Store what a batch has carried out."""
        failed = {run.fingerprint: run.record for run in runs if run.record.reason.startswith("MemoryError")}
        self.table.keep(run for run in runs if run.fingerprint not in failed)
        self.failed.update(failed)


def missing_runs(plan: SweepPlan, table: RunTable) -> tuple[list[str], Missing]:
    """Fingerprints of all runs of a plan, and those that are not stored, each once."""
    settings = RunSettings.of(plan)
    rows_of = [(settings.fingerprint(plan.scene_of(rows)), rows) for rows in plan.rows()]
    missing = {key: rows for key, rows in rows_of if not table.holds(key, settings.traces)}
    return [key for key, _ in rows_of], missing


class _Batches:
    """Batches of the runs that are missing, sized by what the runs before them took, or ``largest``."""

    def __init__(self, plan: SweepPlan, missing: Missing, engine: Engine, largest: int | None = None) -> None:
        self._plan, self._runs, self._engine, self._largest = plan, list(missing.items()), engine, largest
        self._seconds, self._done = 0.0, 0

    def measured(self, runs: Sequence[StoredRun]) -> None:
        """Take note of what runs took."""
        self._seconds += sum(run.seconds for run in runs)
        self._done += len(runs)

    def __iter__(self) -> Iterator[tuple[int, Task]]:
        settings, at = RunSettings.of(self._plan), 0
        while at < len(self._runs):
            size = self._size(len(self._runs) - at)
            scenes = [(key, self._plan.scene_of(rows)) for key, rows in self._runs[at : at + size]]
            label = f"runs {at + 1} to {at + len(scenes)}"
            yield at, Task(scenes[0][0], label, run_batch, (scenes, settings, version()))
            at += len(scenes)

    def _size(self, left: int) -> int:
        if self._done == 0:  # what a run takes is not known yet
            return 1
        by_cost = round(self._engine.batch_seconds / max(self._seconds / self._done, 1e-6))
        tail = math.ceil(left / (TAIL * self._engine.outstanding))
        size = max(1, min(by_cost, max(tail, by_cost // SHORTEST)))
        return size if self._largest is None else min(size, self._largest)


def carry_out(
    plan: SweepPlan,
    table: RunTable,
    engine: Engine | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> SweepRuns:
    """Run what the table does not hold of a plan whose scenes can all be built, and store it there.

    ``progress`` is called with the share of the missing runs that is done, 0 to 1, and a line of text: the
    number of runs, their rate and the remaining time.
    """
    engine = engine or Engine()
    if engine.executor is None:
        keep_freed()  # as a worker process does
    keys, left = missing_runs(plan, table)
    found, began, asked, done, largest = SweepRuns(keys, table), time.monotonic(), len(left), 0, None
    while left:
        batches, again = _Batches(plan, left, engine, largest), Missing()
        for _, result in completed_tasks(batches, engine.executor, engine.outstanding):
            sent = [key for key, _ in result.task.arguments[0]]
            if result.value is not None:
                batches.measured(result.value)
                found.keep(result.value)
            elif result.failure.startswith(OtherVersion.__name__):
                problem = result.failure.partition(": ")[2]
                raise SceneError("executor", problem, "the same installation on every worker")
            elif len(sent) > 1:  # one run may have ended the process of all: each for itself
                again |= {key: left[key] for key in sent}
                continue
            else:
                found.failed[sent[0]] = RunRecord("failed", result.failure)
            done += len(sent)
            if progress is not None:
                rate = done / max(time.monotonic() - began, 1e-9)
                text = f"{len(keys) - asked + done}/{len(keys)} runs, {rate:.3g} a second"
                rest = f", about {duration((asked - done) / rate)} left" if done < asked else ""
                progress(done / asked, text + rest)
        left, largest = again, 1
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


def forecast(plan: SweepPlan, table: RunTable) -> SweepForecast:
    """Forecast a sweep by the runs that are stored; where there are none, its first run is carried out."""
    keys, missing = missing_runs(plan, table)
    stored = [key for key in keys if key not in missing]
    spent = [table.seconds_of(key) or 0.0 for key in stored[:: max(1, len(stored) // 200)]]
    numbers = len(plan.measures or measure_names(plan.scene.with_values({}))) * (2 if plan.estimate else 1)
    size = float(BYTES_OF_NUMBER * numbers * len(keys) + FIGURES_BYTES * len(plan.drawn))
    per_run = sum(spent) / len(spent) if spent else 0.0
    if missing and (plan.traces or not spent):
        key, rows = next(iter(missing.items()))
        first = RunSettings.of(plan).carried_out(key, plan.scene_of(rows))
        per_run = per_run or first.seconds
        size += len(keys) * sum(8.0 * len(column) for column in (first.columns or {}).values())
    return SweepForecast(len(keys), len(stored), per_run * len(missing), per_run, len(spent), size)
