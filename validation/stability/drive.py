"""Run the matrix: probes shared out among workers, every cell told and kept as soon as it is judged."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass

from scene import Scene
from validation.stability.probe import SOLVERS, Computed, Equivalent, Probe
from validation.stability.verdict import Cell, judge
from validation.stability.work import Job, Perform, perform
from validation.stability.workers import Reply, Worker

Tell = Callable[[Cell, list[Cell]], None]
TRUTH = "reference"


@dataclass(frozen=True)
class Matrix:
    """All cells, in the order of the probes, and the wall time it took."""

    cells: tuple[Cell, ...]
    wall_seconds: float

    @property
    def faults(self) -> tuple[Cell, ...]:
        """Cells that must not be."""
        return tuple(cell for cell in self.cells if cell.fault)


def run(
    probes: Sequence[Probe],
    jobs: int = 1,
    solvers: Sequence[str] = SOLVERS,
    tell: Tell = lambda cell, cells: None,
    work: Perform = perform,
) -> Matrix:
    """Run every probe with every solver.

    ``tell`` is given each cell and all cells so far, one call at a time. An interrupt kills the workers.
    """
    began = time.perf_counter()
    found: dict[str, list[Cell]] = {}
    telling = threading.Lock()
    with _workers(jobs) as workers:
        idle = list(workers)

        def carry_out(probe: Probe) -> None:
            worker = idle.pop()
            try:
                for cell in _cells(probe, solvers, worker, work):
                    with telling:
                        found.setdefault(probe.name, []).append(cell)
                        tell(cell, in_order())
            finally:
                idle.append(worker)

        def in_order() -> list[Cell]:
            return [cell for probe in probes for cell in found.get(probe.name, [])]

        threads = ThreadPoolExecutor(jobs)
        try:
            for done in as_completed([threads.submit(carry_out, probe) for probe in probes]):
                done.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
    return Matrix(tuple(in_order()), time.perf_counter() - began)


@contextmanager
def _workers(count: int) -> Iterator[list[Worker]]:
    workers = [Worker() for _ in range(count)]
    try:
        yield workers
    finally:
        for worker in workers:
            worker.retire()


def _cells(probe: Probe, solvers: Sequence[str], worker: Worker, work: Perform) -> Iterator[Cell]:
    if not isinstance(probe.scene, Scene):
        for solver in solvers:
            yield judge(probe, solver, None, ())
        return
    common: tuple[Reply, ...] = ()
    if isinstance(probe.truth, Computed):
        levels = (probe.truth.fine, probe.truth.coarse)
        common = tuple(_ask(probe, TRUTH, probe.scene, worker, work, level) for level in levels)
    for solver in solvers:
        reply, truths = _ask(probe, solver, probe.scene, worker, work), common
        if isinstance(probe.truth, Equivalent):
            truths = (_ask(probe, solver, probe.truth.scene, worker, work),)
        yield judge(probe, solver, reply, truths)


def _ask(
    probe: Probe, solver: str, scene: Scene, worker: Worker, work: Perform, level: int | None = None
) -> Reply:
    job = Job(solver, scene, level or probe.resolutions[solver], probe.max_steps)
    return worker.ask(work, job, probe.seconds)
