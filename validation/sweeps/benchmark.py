"""What a sweep costs beside its runs: ``python -m validation.sweeps.benchmark [--runs N] [--dask]``.

An elastic sphere is pressed in without adhesion, by default deep enough for a run to take as many steps as
one with adhesion at resolution 4; with ``--depth 0.0101`` runs are about as short as there are, and the
overhead shows most. Each engine is measured against the bare solver: some of the same scenes in as many plain
processes, a loop around ``Solver.solve`` in each. Sweep and bare solver take turns; of each the shortest time
counts. Efficiency is the time a run takes there over what it takes in the sweep, start of the processes left
out of both: by the clock, and by the processor time of this process and its workers, which other programs on
the machine change less. The memory of this process and of its workers is read as the runs pass.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

from contact_scene import Loading, Material, Ramp, Scene, Sphere
from validation import solvers
from validation.execution.engines import LOCAL_CLUSTER, Engine, own_engine
from validation.execution.memory import keep_freed
from validation.execution.run_table import RunTable
from validation.sweeps.plan import SweepPlan, plan_from_dict
from validation.sweeps.run_plan import carry_out
from validation.sweeps.scene_table import of_scene
from validation.sweeps.write import write_results

START, DEPTH = 0.01, 0.02
"""Penetrations, over the radius, of the relaxed contact at the start and at the end."""
RESOLUTION = 4
FIRST, APART = 1.0, 2.5
"""Smallest radius of the first turn, and factor to that of the next: a turn's radii grow by less."""
SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)
"""Of the runs, at which memory is read; the first is past what imports and the first batches take."""
ROUNDS = 5
"""Turns of the sweep and of the bare solver: on a busy machine one of them is little disturbed."""
BARE_RUNS = 100
"""Runs of the bare solver in a turn: a second or more, so that the ends of the processes' shares do not
count."""


@dataclass(frozen=True)
class Spent:
    """Time (s) of one run, on average, by the clock times the number of processes, and of the processors."""

    wall: float
    processor: float


def plan_of(runs: int, folder: Path, depth: float = DEPTH, first: float = 1.0) -> SweepPlan:
    """A plan of runs over the radius of the sphere.

    Parameters
    ----------
    runs : int
        How many.
    folder : Path
        For tables of the scene.
    depth : float
        Largest penetration.
    first : float
        Smallest radius; plans with other ones share no run.

    Returns
    -------
    SweepPlan
    """
    loading = Loading("relaxed", START, (Ramp(depth, START),))
    scene = Scene(Material(1.0, 0.5), Sphere(1.0), loading)
    radii = {"name": "radius", "key": "indenter.radius", "linspace": [first, 2.0 * first, runs]}
    table = {"coordinates": [radii], "resolution": RESOLUTION, "estimate": False, "drawn": []}
    return plan_from_dict(table, folder, of_scene(scene, folder))


def bare(plan: SweepPlan, processes: int) -> Spent:
    """The bare solver on some scenes of a plan, shared out over plain processes."""
    every = max(1, plan.count // BARE_RUNS)
    scenes = [plan.scene(rows) for rows in plan.rows()][::every]
    with get_context("spawn").Pool(processes, keep_freed) as pool:
        pool.map(_solve_all, [scenes[:4]] * processes, chunksize=1)
        before, began = processor_seconds(), time.perf_counter()
        pool.map(_solve_all, [scenes[part::processes] for part in range(processes)], chunksize=1)
        wall, spent = time.perf_counter() - began, processor_seconds() - before
    return Spent(processes * wall / len(scenes), spent / len(scenes))


def _solve_all(scenes: Sequence[Scene]) -> None:
    method = solvers.solver(solvers.REFERENCE)
    for scene in scenes:
        method.solve(scene, RESOLUTION)


def swept(
    plan: SweepPlan,
    processes: int,
    engine: Engine,
    table: RunTable,
    progress: Callable[[float, str], None] | None = None,
) -> Spent:
    """A sweep.

    Parameters
    ----------
    plan : SweepPlan
    processes : int
        That work on it.
    engine : Engine
    table : RunTable
        Receives the runs.
    progress : callable, optional
        As of :func:`~validation.sweeps.run_plan.carry_out`.

    Returns
    -------
    Spent
    """
    before, began = processor_seconds(), time.perf_counter()
    carry_out(plan, table, engine, progress)
    wall, spent = time.perf_counter() - began, processor_seconds() - before
    return Spent(processes * wall / plan.count, spent / plan.count)


class Memory:
    """Bytes of this process and of its largest worker at ``SHARES`` of all runs."""

    def __init__(self) -> None:
        self.read: list[tuple[float, float]] = []

    def of_turn(self, turn: int) -> Callable[[float, str], None]:
        """Progress of a turn."""

        def look(share: float, text: str) -> None:
            if len(self.read) < len(SHARES) and (turn + share) / ROUNDS >= SHARES[len(self.read)]:
                own, *workers = (resident(process) for process in family())
                self.read.append((own, max(workers, default=0.0)))

        return look


def family() -> list[int]:
    """This process and all that descend from it, from ``/proc``."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:  # it has ended
            continue
        children.setdefault(parent, []).append(int(entry.name))
    found = [os.getpid()]
    for process in found:
        found += children.get(process, [])
    return found


def processor_seconds() -> float:
    """Processor time of this process and its workers so far (s)."""
    ticks = 0
    for process in family():
        try:
            ticks += sum(
                map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13])
            )
        except OSError:
            continue
    return ticks / os.sysconf("SC_CLK_TCK")


def resident(process: int) -> float:
    """Bytes of memory of a process."""
    try:
        pages = Path(f"/proc/{process}/statm").read_text().split()[1]
    except OSError:
        return 0.0
    return float(pages) * os.sysconf("SC_PAGE_SIZE")


def main() -> None:
    """Measure and print."""
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--runs", type=int, default=2000)
    arguments.add_argument("--jobs", type=int, nargs="+", default=[1, 2])
    arguments.add_argument("--depth", type=float, default=DEPTH, help=f"largest penetration, above {START}")
    arguments.add_argument("--dask", action="store_true", help="by a local Dask cluster")
    options = arguments.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    for jobs in options.jobs:
        _measure(options.runs, options.depth, jobs, LOCAL_CLUSTER if options.dask else None)


def _measure(runs: int, depth: float, jobs: int, dask: str | None) -> None:
    with tempfile.TemporaryDirectory() as folder, own_engine(jobs, dask) as engine:
        out = Path(folder)
        plans = [plan_of(runs // ROUNDS, out, depth, FIRST * APART**turn) for turn in range(ROUNDS)]
        sweeps, alone, memory = [], [], Memory()
        with RunTable(out) as table:
            carry_out(plan_of(16 * jobs, out, depth, FIRST / APART), table, engine)
            for turn, plan in enumerate(plans):
                alone.append(bare(plan, jobs))
                sweeps.append(swept(plan, jobs, engine, table, memory.of_turn(turn)))
        began = time.perf_counter()
        with RunTable(out) as table:
            again = [carry_out(plan, table) for plan in plans]
            resumed = time.perf_counter() - began
            write_results(plans[-1], again[-1], out)
        writing = time.perf_counter() - began - resumed
        size = sum(file.stat().st_size for file in out.iterdir())
    spent, free = (Spent(min(s.wall for s in a), min(s.processor for s in a)) for a in (sweeps, alone))
    what = f"Dask, {jobs} workers" if dask else f"{jobs} process{'es' if jobs > 1 else ''}"
    print(f"{what}: {runs} runs, {jobs / spent.wall:.1f} a second; bare solver {jobs / free.wall:.1f}")
    clock, processors = free.wall / spent.wall, free.processor / spent.processor
    print(f"  efficiency {clock:.3f} by the clock, {processors:.3f} by the processors")
    print(f"  processor time of a run {1e3 * spent.processor:.2f} ms, bare {1e3 * free.processor:.2f} ms")
    told = ", ".join(
        f"{100 * share:.0f} %: {own / 1e6:.1f} and {worker / 1e6:.1f} MB"
        for share, (own, worker) in zip(SHARES, memory.read, strict=False)
    )
    print(f"  memory of this process and of its largest worker at {told}")
    print(f"  once more, all stored: {resumed:.2f} s; {size / 1e6:.1f} MB on disk")
    print(f"  writing {runs // ROUNDS} of them: {writing:.2f} s")


if __name__ == "__main__":
    main()
