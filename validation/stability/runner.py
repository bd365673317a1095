"""Run the matrix: probes shared out among workers, every cell told and kept as soon as it is judged."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass

from contact_scene import Scene
from validation.execution.checkpoints import question
from validation.execution.store import Store
from validation.execution.workers import Reply, Worker
from validation.solvers import REFERENCE, SOLVERS
from validation.stability.case import EquivalentScene, ReferenceRuns, StabilityCase
from validation.stability.verdict import Cell, CellVerdict, cell_of, skipped_cell
from validation.stability.work import Job, Perform, perform

Tell = Callable[[Cell, list[Cell]], None]


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
    probes: Sequence[StabilityCase],
    jobs: int = 1,
    solvers: Collection[str] = SOLVERS,
    tell: Tell = lambda cell, cells: None,
    work: Perform = perform,
    store: Store | None = None,
) -> Matrix:
    """Run every probe with every solver.

    ``tell`` is given each cell and all cells so far, one call at a time. An interrupt kills the workers.
    Cells that ``store`` holds are taken over, except for runs that crashed or hung.
    """
    store = store or Store()
    found: dict[str, list[Cell]] = {}
    telling = threading.Lock()
    with _workers(jobs) as workers:
        idle = list(workers)

        def carry_out(probe: StabilityCase) -> None:
            with telling:
                known = {solver: store.get(_question(probe, solver)) for solver in solvers}
            for cell in filter(None, known.values()):
                add(probe, cell)
            missing = [solver for solver, cell in known.items() if cell is None]
            if not missing:
                return
            worker = idle.pop()
            try:
                for cell in _cells(probe, missing, worker, work):
                    add(probe, cell)
                    if cell.verdict not in (CellVerdict.CRASH, CellVerdict.HANG):
                        with telling:
                            store.put(_question(probe, cell.solver), cell)
            finally:
                idle.append(worker)

        def add(probe: StabilityCase, cell: Cell) -> None:
            with telling:
                found.setdefault(probe.name, []).append(cell)
                tell(cell, in_order())

        def in_order() -> list[Cell]:
            order = list(solvers)
            return [
                cell
                for probe in probes
                for cell in sorted(found.get(probe.name, []), key=lambda cell: order.index(cell.solver))
            ]

        threads = ThreadPoolExecutor(jobs)
        try:
            longest_first = sorted(probes, key=lambda probe: -probe.seconds)
            for done in as_completed([threads.submit(carry_out, probe) for probe in longest_first]):
                done.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
    return Matrix(tuple(in_order()), store.seconds)


def _question(probe: StabilityCase, solver: str) -> str:
    """The sources are part of a question, and the sources are what makes a probe of this name."""
    return question("stability", probe.name, solver)


@contextmanager
def _workers(count: int) -> Iterator[list[Worker]]:
    workers = [Worker() for _ in range(count)]
    try:
        yield workers
    finally:
        for worker in workers:
            worker.retire()


def _cells(probe: StabilityCase, solvers: Collection[str], worker: Worker, work: Perform) -> Iterator[Cell]:
    if not isinstance(probe.scene, Scene):
        for solver in solvers:
            yield cell_of(probe, solver, None, ())
        return
    common: tuple[Reply, ...] = ()
    if isinstance(probe.truth, ReferenceRuns):
        levels = (probe.truth.fine, probe.truth.coarse)
        common = tuple(_ask(probe, REFERENCE, probe.scene, worker, work, level) for level in levels)
    for solver in solvers:
        if solver in probe.skip_reasons:
            yield skipped_cell(probe, solver)
            continue
        reply, truths = _ask(probe, solver, probe.scene, worker, work), common
        if isinstance(probe.truth, EquivalentScene):
            truths = (_ask(probe, solver, probe.truth.scene, worker, work),)
        yield cell_of(probe, solver, reply, truths)


def _ask(
    probe: StabilityCase, solver: str, scene: Scene, worker: Worker, work: Perform, level: int | None = None
) -> Reply:
    job = Job(solver, scene, level or probe.resolution(solver), probe.max_steps)
    return worker.ask(work, job, probe.seconds)
