"""What a sweep costs beside its runs: ``python -m validation.sweeps.benchmark [--runs N] [--dask]``.

The cheapest runs there are, an elastic sphere pressed in without adhesion, show the overhead largest. Each
engine is measured against the bare solver: the same scenes in as many plain processes, a loop around
``Solver.solve`` in each. Both are repeated in turn, so that a busy machine slows both, and the shorter time
of each counts. Efficiency is the time of the bare solver over that of the sweep, start of the processes left
out of both. The memory of this process is read as the runs pass.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Sequence
from multiprocessing import get_context
from pathlib import Path

from contact_scene import Hold, Loading, Material, Ramp, Scene, Sphere
from validation import solvers
from validation.execution.engines import LOCAL_CLUSTER, Engine, own_engine
from validation.execution.memory import keep_freed
from validation.execution.run_table import RunTable
from validation.sweeps.plan import SweepPlan, plan_from_dict
from validation.sweeps.run_plan import carry_out
from validation.sweeps.scene_table import of_scene
from validation.sweeps.write import write_results

SCENE = Scene(Material(1.0, 0.5), Sphere(1.0), Loading("relaxed", 0.01, (Ramp(0.02, 0.01), Hold(1.0))))
RESOLUTION = 4
SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)
"""Of the runs, at which memory is read; the first is past what imports and the first batches take."""
REPEATS = 2


def plan_of(runs: int, folder: Path, first: float = 1.0) -> SweepPlan:
    """A plan of so many runs, over the radius of the sphere; another ``first`` shares no run with it."""
    radii = {"name": "radius", "key": "indenter.radius", "linspace": [first, 2.0 * first, runs]}
    table = {"coordinates": [radii], "resolution": RESOLUTION, "estimate": False, "drawn": []}
    return plan_from_dict(table, folder, of_scene(SCENE, folder))


def bare_seconds(plan: SweepPlan, processes: int) -> float:
    """Wall time of the bare solver on the scenes of a plan, shared out over plain processes."""
    scenes = [plan.scene(rows) for rows in plan.rows()]
    with get_context("spawn").Pool(processes, keep_freed) as pool:
        pool.map(_solve_all, [scenes[:2]] * processes, chunksize=1)
        began = time.perf_counter()
        pool.map(_solve_all, [scenes[part::processes] for part in range(processes)], chunksize=1)
        return time.perf_counter() - began


def _solve_all(scenes: Sequence[Scene]) -> None:
    method = solvers.solver(solvers.REFERENCE)
    for scene in scenes:
        method.solve(scene, RESOLUTION)


def sweep_seconds(plan: SweepPlan, warm: SweepPlan, engine: Engine, out: Path) -> tuple[float, list[float]]:
    """Wall time of a sweep on warm workers, and this process's memory (bytes) at ``SHARES`` of its runs."""
    memory: list[float] = []

    def read(share: float, text: str) -> None:
        if len(memory) < len(SHARES) and share >= SHARES[len(memory)]:
            memory.append(resident(os.getpid()))

    with RunTable(out, fresh=True) as table:
        carry_out(warm, table, engine)
        began = time.perf_counter()
        carry_out(plan, table, engine, read)
        return time.perf_counter() - began, memory


def resident(process: int) -> float:
    """Bytes of memory of a process; 0 where the system does not tell."""
    try:
        pages = Path(f"/proc/{process}/statm").read_text().split()[1]
    except OSError:
        return 0.0
    return float(pages) * os.sysconf("SC_PAGE_SIZE")


def main() -> None:
    """Measure and print."""
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--runs", type=int, default=10_000)
    arguments.add_argument("--dask", action="store_true", help="a local Dask cluster too")
    options = arguments.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    cores = min(2, os.cpu_count() or 1)
    engines = [(1, None), (cores, None), *([(cores, LOCAL_CLUSTER)] if options.dask else [])]
    for jobs, dask in engines:
        _measure(options.runs, jobs, dask)


def _measure(runs: int, jobs: int, dask: str | None) -> None:
    bare: list[float] = []
    swept: list[float] = []
    memory: list[float] = []
    with tempfile.TemporaryDirectory() as folder, own_engine(jobs, dask) as engine:
        out = Path(folder)
        plan, warm = plan_of(runs, out), plan_of(8 * jobs, out, first=3.0)
        for _ in range(REPEATS):
            bare.append(bare_seconds(plan, jobs))
            seconds, memory = sweep_seconds(plan, warm, engine, out)
            swept.append(seconds)
        began = time.perf_counter()
        with RunTable(out) as table:
            write_results(plan, carry_out(plan, table), out)
        writing = time.perf_counter() - began
        size = sum(file.stat().st_size for file in out.iterdir())
    what = f"Dask, {jobs} workers" if dask else f"{jobs} process{'es' if jobs > 1 else ''}"
    print(f"{what}: {runs} runs, {runs / min(swept):.1f} a second, bare solver {runs / min(bare):.1f}")
    print(f"  efficiency {min(bare) / min(swept):.3f}; all times (s): {bare} bare, {swept} swept")
    told = ", ".join(f"{100 * s:.0f} %: {m / 1e6:.1f} MB" for s, m in zip(SHARES, memory, strict=False))
    print(f"  memory of this process at {told}")
    print(f"  again, with every run stored, and writing: {writing:.2f} s; {size / 1e6:.1f} MB on disk")


if __name__ == "__main__":
    main()
