"""Batches of runs: what a worker is given, and what it gives back: numbers, and traces only if asked for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from contact_scene import Scene
from validation.cases import Case
from validation.execution.provenance import fingerprint, version
from validation.execution.run import Run, run
from validation.execution.run_table import RunRecord, StoredRun
from validation.execution.solver_tasks import origin_of

NOT_REPEATABLE = ("wall_seconds",)
"""Measures that differ from one attempt to the next."""
_LACK_OF_MEMORY = "MemoryError"


class OtherVersion(RuntimeError):
    """A worker has other sources of this program than the process that asks it."""


@dataclass(frozen=True)
class SweepOptions:
    """How every run of a sweep is carried out.

    Parameters
    ----------
    solver : str
    resolution, max_steps : int or None
        ``None``: the solver's choice.
    estimate : bool
        Whether errors are estimated.
    """

    solver: str
    resolution: int | None = None
    max_steps: int | None = None
    estimate: bool = True

    def fingerprint(self, scene: Scene) -> str:
        """Of a run on a scene: two plans that ask for it share it."""
        options = (self.solver, self.resolution, self.max_steps, self.estimate)
        return fingerprint("sweep", scene, *options, *origin_of(self.solver))


@dataclass(frozen=True)
class BatchedRun:
    """A run that a batch has carried out.

    Parameters
    ----------
    stored : StoredRun
    repeatable : bool
        Whether it would end in the same way again; not where the machine's memory ended it.
    """

    stored: StoredRun
    repeatable: bool = True


def run_batch(
    scenes: Sequence[tuple[str, Scene]], options: SweepOptions, traces: bool, sources: str
) -> list[BatchedRun]:
    """Carry out runs one after the other.

    Parameters
    ----------
    scenes : sequence of (str, Scene)
        With their fingerprints.
    options : SweepOptions
    traces : bool
        Whether the traces are given back.
    sources : str
        ``version()`` where the batch was made.

    Returns
    -------
    list of BatchedRun
        In the order of ``scenes``.

    Raises
    ------
    OtherVersion
        If this process has other sources: its numbers would be kept under a wrong fingerprint.
    """
    if sources != version():
        raise OtherVersion("a worker has another version of crosscontact, NumPy, SciPy or Python")
    done = []
    for key, scene in scenes:
        result = run(
            Case("sweep", scene),
            options.solver,
            options.resolution,
            estimate=options.estimate,
            max_steps=options.max_steps,
        )
        columns = result.trace.columns() if traces and result.trace is not None else None
        seconds = result.cpu_seconds + result.estimate_seconds
        repeatable = not result.failure.startswith(_LACK_OF_MEMORY)
        done.append(BatchedRun(StoredRun(key, record_of(result), seconds, columns), repeatable))
    return done


def record_of(result: Run) -> RunRecord:
    """What a sweep keeps of a run."""
    trace = result.trace
    if trace is None:
        return RunRecord(result.outcome, result.failure)
    measures = {name: value for name, value in result.measures.items() if name not in NOT_REPEATABLE}
    return RunRecord(
        result.outcome,
        trace.outcome.reason,
        result.finished,
        _finite(measures),
        _finite(result.errors),
        result.warnings,
        len(trace),
    )


def _finite(numbers: Mapping[str, float | None]) -> dict[str, float]:
    """Plain floats; what does not apply is left out."""
    return {
        name: float(value) for name, value in numbers.items() if value is not None and math.isfinite(value)
    }
