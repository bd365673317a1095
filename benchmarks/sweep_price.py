"""What a sweep costs beside its runs: ``python -m benchmarks.sweep_price [--runs N] [--dask]``.

An elastic sphere is pressed in without adhesion, by default deep enough for a run to take as many steps as
one with adhesion at resolution 4; with ``--depth 0.0101`` runs are about as short as there are, and the
overhead shows most. Each engine is measured against the bare solver: the same scenes in as many plain
processes, a loop around ``Solver.solve`` in each. Sweep and bare solver take turns, each first in every
second one. Efficiency is the time a run takes there over what it takes in the sweep, start of the processes
left out of both: by the clock, and by the processor time of this process and its workers, which other
programs on the machine change less. The median of the turns is told with its quartiles: a machine whose pace
changes by the second disturbs single turns, in either direction. The memory of this process and of its
workers is read as the runs pass.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from multiprocessing import get_context
from multiprocessing.pool import Pool
from pathlib import Path
from statistics import median, quantiles

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
TURNS = 20
"""Of the sweep and of the bare solver, by default."""


@dataclass(frozen=True)
class Spent:
    """Time (s) of one run, on average, by the clock times the number of processes, of the processors, and of
    them in this process, where batches are made and stored and a local Dask cluster has its scheduler."""

    wall: float
    processor: float
    here: float


def plan_of(runs: int, folder: Path, depth: float = DEPTH, first: float = 1.0) -> SweepPlan:
    """A plan of runs over the radius of the sphere."""
    loading = Loading("relaxed", START, (Ramp(depth, START),))
    scene = Scene(Material(1.0, 0.5), Sphere(1.0), loading)
    radii = {"name": "radius", "key": "indenter.radius", "linspace": [first, 2.0 * first, runs]}
    table = {"coordinates": [radii], "resolution": RESOLUTION, "estimate": False, "drawn": []}
    return plan_from_dict(table, folder, of_scene(scene, folder))


def bare(plan: SweepPlan, pool: Pool, processes: int) -> Spent:
    """The bare solver on the scenes of a plan, shared out over the plain processes of a pool."""
    scenes = [plan.scene(rows) for rows in plan.rows()]
    return spent_in(
        lambda: pool.map(_solve_all, [scenes[part::processes] for part in range(processes)], chunksize=1),
        processes,
        len(scenes),
    )


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
    """A sweep."""
    return spent_in(lambda: carry_out(plan, table, engine, progress), processes, plan.count)


def spent_in(work: Callable[[], object], processes: int, runs: int) -> Spent:
    """What some work takes, each run of it."""
    before, here, began = processor_seconds(), time.process_time(), time.perf_counter()
    work()
    wall, here = time.perf_counter() - began, time.process_time() - here
    return Spent(processes * wall / runs, (processor_seconds() - before) / runs, here / runs)


class Memory:
    """Bytes of this process and of its largest worker at ``SHARES`` of all runs."""

    def __init__(self, turns: int) -> None:
        self.read: list[tuple[float, float]] = []
        self._turns = turns

    def of_turn(self, turn: int) -> Callable[[float, str], None]:
        """Progress of a turn."""

        def look(share: float, text: str) -> None:
            if len(self.read) < len(SHARES) and (turn + share) / self._turns >= SHARES[len(self.read)]:
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
    arguments.add_argument("--turns", type=int, default=TURNS, help="among which the runs are divided")
    arguments.add_argument("--depth", type=float, default=DEPTH, help=f"largest penetration, above {START}")
    arguments.add_argument("--dask", action="store_true", help="by a local Dask cluster")
    options = arguments.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    for jobs in options.jobs:
        _measure(options.runs, options.turns, options.depth, jobs, LOCAL_CLUSTER if options.dask else None)


def _measure(runs: int, turns: int, depth: float, jobs: int, dask: str | None) -> None:
    with (
        tempfile.TemporaryDirectory() as folder,
        own_engine(jobs, dask) as engine,
        get_context("spawn").Pool(jobs, keep_freed) as pool,
    ):
        out = Path(folder)
        plans = [plan_of(runs // turns, out, depth, FIRST * APART**turn) for turn in range(turns)]
        sweeps, alone, memory = [], [], Memory(turns)
        with RunTable(out) as table:
            first = plan_of(16 * jobs, out, depth, FIRST / APART)  # imports are left out of both
            carry_out(first, table, engine)
            bare(first, pool, jobs)
            for turn, plan in enumerate(plans):
                if turn % 2 == 0:
                    alone.append(bare(plan, pool, jobs))
                sweeps.append(swept(plan, jobs, engine, table, memory.of_turn(turn)))
                if turn % 2 == 1:
                    alone.append(bare(plan, pool, jobs))
        began = time.perf_counter()
        with RunTable(out) as table:
            again = [carry_out(plan, table) for plan in plans]
            resumed = time.perf_counter() - began
            write_results(plans[-1], again[-1], out)
        writing = time.perf_counter() - began - resumed
        size = sum(file.stat().st_size for file in out.iterdir())
    walls, processors = (
        [getattr(free, name) / getattr(spent, name) for free, spent in zip(alone, sweeps, strict=True)]
        for name in ("wall", "processor")
    )
    spent, free = (
        Spent(*(median(getattr(turn, entry.name) for turn in each) for entry in fields(Spent)))
        for each in (sweeps, alone)
    )
    what = f"Dask, {jobs} workers" if dask else f"{jobs} process{'es' if jobs > 1 else ''}"
    print(f"{what}: {runs} runs, {jobs / spent.wall:.1f} a second; bare solver {jobs / free.wall:.1f}")
    print(f"  efficiency {_spread(walls)} by the clock, {_spread(processors)} by the processors")
    print(
        f"  processor time of a run {1e3 * spent.processor:.2f} ms, bare {1e3 * free.processor:.2f} ms;"
        f" in this process {1e3 * spent.here:.2f} ms, {100 * spent.here / spent.processor:.1f} %"
    )
    told = ", ".join(
        f"{100 * share:.0f} %: {own / 1e6:.1f} and {worker / 1e6:.1f} MB"
        for share, (own, worker) in zip(SHARES, memory.read, strict=False)
    )
    print(f"  memory of this process and of its largest worker at {told}")
    print(f"  once more, all stored: {resumed:.2f} s; {size / 1e6:.1f} MB on disk")
    print(f"  writing {runs // turns} of them: {writing:.2f} s")


def _spread(turns: Sequence[float]) -> str:
    """Median and quartiles."""
    low, middle, high = quantiles(turns, method="inclusive")
    return f"{middle:.3f} ({low:.3f} to {high:.3f})"


if __name__ == "__main__":
    main()
