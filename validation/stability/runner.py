"""Run the matrix of stiff and extreme probes; every cell is judged as soon as its runs are there."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from contact_scene import Scene
from validation.execution.fingerprints import fingerprint
from validation.execution.processes import processes
from validation.execution.store import Store
from validation.execution.tasks import Task, TaskResult, run_tasks
from validation.solvers import REFERENCE, SOLVERS
from validation.stability.case import EquivalentScene, ReferenceRuns, StabilityCase
from validation.stability.probe_runs import ProbeAnswer, ProbeRun, solve_probe
from validation.stability.verdict import Cell, cell_of, skipped_cell

OnCell = Callable[[Cell, list[Cell]], None]
SolveProbe = Callable[[ProbeRun], ProbeAnswer]


@dataclass(frozen=True)
class StabilityMatrix:
    """All cells, in the order of the probes, and the wall time in seconds that they took."""

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
    on_cell: OnCell = lambda cell, cells: None,
    solve: SolveProbe = solve_probe,
    store: Store | None = None,
) -> StabilityMatrix:
    """Run every probe with every solver, in processes that can be killed where a run hangs.

    Parameters
    ----------
    probes : sequence of StabilityCase
    jobs : int
        Processes at the same time.
    solvers : collection of str
        Names.
    on_cell : callable
        Called with each cell and all cells so far.
    solve : callable
        What a process does.
    store : Store or None
        Runs that it holds are taken over; those that crashed or hung are not in it.

    Returns
    -------
    StabilityMatrix
    """
    store = store or Store()
    columns = [(probe, solver) for probe in probes for solver in solvers]
    needed = [_tasks(probe, solver, solve) for probe, solver in columns]
    results: dict[str, TaskResult] = {}
    cells: dict[int, Cell] = {}

    def judge_complete() -> None:
        for index, tasks in enumerate(needed):
            if index not in cells and all(task.key in results for task in tasks):
                cells[index] = _cell(*columns[index], [results[task.key] for task in tasks])
                on_cell(cells[index], in_order())

    def in_order() -> list[Cell]:
        return [cells[index] for index in sorted(cells)]

    def on_result(result: TaskResult) -> None:
        results[result.task.key] = result
        judge_complete()

    judge_complete()  # cells without any run
    with processes(jobs, isolated=True) as executor:
        unique = {task.key: task for tasks in needed for task in tasks}
        run_tasks(unique.values(), executor, store, on_result=on_result)
    return StabilityMatrix(tuple(in_order()), store.seconds)


def _tasks(probe: StabilityCase, solver: str, solve: SolveProbe) -> list[Task]:
    """Runs that a cell rests on: the solver's own, and those of its truth."""
    if not isinstance(probe.scene, Scene) or solver in probe.skip_reasons:
        return []
    own = probe.resolution(solver)
    runs = [ProbeRun(solver, probe.scene, own, probe.max_steps)]
    if isinstance(probe.truth, ReferenceRuns):
        for resolution in (probe.truth.fine, probe.truth.coarse):
            runs.append(ProbeRun(REFERENCE, probe.scene, resolution, probe.max_steps))
    if isinstance(probe.truth, EquivalentScene):
        runs.append(ProbeRun(solver, probe.truth.scene, own, probe.max_steps))
    return [
        Task(
            fingerprint("stability", run),
            f"{probe.name}: {run.solver}",
            solve,
            (run,),
            expected_seconds=probe.seconds,
            time_limit=probe.seconds,
        )
        for run in runs
    ]


def _cell(probe: StabilityCase, solver: str, results: list[TaskResult]) -> Cell:
    if results:
        return cell_of(probe, solver, results[0], tuple(results[1:]))
    return (
        cell_of(probe, solver, None, ())
        if not isinstance(probe.scene, Scene)
        else skipped_cell(probe, solver)
    )
