"""Run the matrix of stiff and extreme cases; every cell has its verdict as soon as its runs are there."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from contact_scene import Scene
from validation.runs.pool import Task, TaskResult, processes, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS
from validation.stability.case import EquivalentScene, ReferenceRuns, StabilityCase
from validation.stability.case_runs import CaseAnswer, CaseRun, solve_case
from validation.stability.verdict import Cell, cell_of

OnCell = Callable[[Cell, list[Cell]], None]
SolveCase = Callable[[CaseRun], CaseAnswer]


@dataclass(frozen=True)
class StabilityMatrix:
    """All cells, in the order of the cases, and their wall time (s)."""

    cells: tuple[Cell, ...]
    wall_seconds: float

    @property
    def faults(self) -> tuple[Cell, ...]:
        """Cells at fault."""
        return tuple(cell for cell in self.cells if cell.fault)


def run(
    cases: Sequence[StabilityCase],
    jobs: int = 1,
    solvers: Collection[str] = SOLVERS,
    on_cell: OnCell = lambda cell, cells: None,
    solve: SolveCase = solve_case,
    store: Store | None = None,
) -> StabilityMatrix:
    """Run every case with every solver, in processes that can be killed where a run hangs.

    Parameters
    ----------
    cases : sequence of StabilityCase
    jobs : int
        Processes at the same time.
    solvers : collection of str
        Names.
    on_cell : callable
        Called with each cell and all cells so far.
    solve : callable
        Carries out one run, in a process.
    store : Store or None
        Stored runs are not repeated; runs that crashed or hung are not stored.

    Returns
    -------
    StabilityMatrix
    """
    store = store or Store()
    columns = [(case, solver) for case in cases for solver in solvers]
    needed = [_tasks(case, solver, solve) for case, solver in columns]
    results: dict[str, TaskResult] = {}
    cells: dict[int, Cell] = {}

    def add_complete_cells() -> None:
        for index, tasks in enumerate(needed):
            if index not in cells and all(task.key in results for task in tasks):
                cells[index] = _cell(*columns[index], [results[task.key] for task in tasks])
                on_cell(cells[index], in_order())

    def in_order() -> list[Cell]:
        return [cells[index] for index in sorted(cells)]

    def on_result(result: TaskResult) -> None:
        results[result.task.key] = result
        add_complete_cells()

    add_complete_cells()  # cells without any run
    with processes(jobs, isolated=True) as executor:
        unique = {task.key: task for tasks in needed for task in tasks}
        longest_first = sorted(unique.values(), key=lambda task: -(task.time_limit or 0.0))
        run_tasks(longest_first, executor, store, on_result=on_result)
    return StabilityMatrix(tuple(in_order()), store.seconds)


def _tasks(case: StabilityCase, solver: str, solve: SolveCase) -> list[Task]:
    """Runs that a cell rests on: the solver's own, and those that give the expected answer."""
    if not isinstance(case.scene, Scene):
        return []
    own = case.resolution(solver)
    runs = [CaseRun(solver, case.scene, own, case.max_steps)]
    if isinstance(case.expected, ReferenceRuns):
        for resolution in (case.expected.fine, case.expected.coarse):
            runs.append(CaseRun(REFERENCE, case.scene, resolution, case.max_steps))
    if isinstance(case.expected, EquivalentScene):
        runs.append(CaseRun(solver, case.expected.scene, own, case.max_steps))
    return [
        Task(
            fingerprint("stability", run),
            f"{case.name}: {run.solver}",
            solve,
            (run,),
            CaseAnswer,
            time_limit=case.seconds,
        )
        for run in runs
    ]


def _cell(case: StabilityCase, solver: str, results: list[TaskResult]) -> Cell:
    return cell_of(case, solver, results[0] if results else None, tuple(results[1:]))
