"""What a sweep costs beside its runs: ``python -m benchmarks.sweep_price [--runs N] [--dask]``.

An elastic sphere is pressed in without adhesion. Sweep and bare solver (as many plain processes with a loop
around ``Solver.solve``) take turns on the same scenes, each first in every second one. Efficiency is the
time of a run there over that in the sweep, start of the processes left out of both, as the median of the
turns with its quartiles: a machine whose pace changes disturbs single turns, in either direction.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from pathlib import Path
from statistics import quantiles

from contact_scene import Loading, Material, Ramp, Scene, Sphere
from validation import solvers
from validation.runs.pool import LOCAL_CLUSTER, own_engine
from validation.runs.process import keep_freed
from validation.sweeps.plan import SweepPlan, of_scene, plan_from_dict
from validation.sweeps.run_plan import carry_out, store_of

START, DEPTH = 0.01, 0.02
"""Penetrations, over the radius, of the relaxed contact at the start and at the end."""
RESOLUTION = 4
FIRST, APART = 1.0, 2.5
"""Smallest radius of the first turn, and factor to that of the next: a turn's radii grow by less."""


def plan_of(runs: int, folder: Path, depth: float = DEPTH, first: float = 1.0) -> SweepPlan:
    """A plan of runs over the radius of the sphere; plans with another smallest one share no run."""
    loading = Loading("relaxed", START, (Ramp(depth, START),))
    scene = Scene(Material(1.0, 0.5), Sphere(1.0), loading)
    radii = {"name": "radius", "key": "indenter.radius", "linspace": [first, 2.0 * first, runs]}
    table = {"coordinates": [radii], "resolution": RESOLUTION, "estimate": False, "drawn": []}
    return plan_from_dict(table, folder, of_scene(scene))


def _solve_all(scenes: Sequence[Scene]) -> None:
    method = solvers.solver(solvers.REFERENCE)
    for scene in scenes:
        method.solve(scene, RESOLUTION)


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def efficiencies(runs: int, turns: int, depth: float, jobs: int, dask: str | None) -> list[float]:
    """Time of the bare solver over that of the sweep, turn by turn."""
    found = []
    with (
        tempfile.TemporaryDirectory() as folder,
        own_engine(jobs, dask) as engine,
        get_context("spawn").Pool(jobs, keep_freed) as pool,
        store_of(Path(folder)) as store,
    ):
        for turn in range(-1, turns):  # the first is left out, with all imports
            plan = plan_of(runs // turns, Path(folder), depth, FIRST * APART**turn)
            scenes = [plan.scene_of(rows) for rows in plan.rows()]
            parts = [scenes[part::jobs] for part in range(jobs)]
            works = {
                "bare": lambda parts=parts: pool.map(_solve_all, parts, chunksize=1),
                "sweep": lambda plan=plan: carry_out(plan, store, engine),
            }
            order = list(works) if turn % 2 == 0 else list(works)[::-1]
            spent = {name: _seconds(works[name]) for name in order}
            found.append(spent["bare"] / spent["sweep"])
    return found[1:]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--jobs", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--turns", type=int, default=20, help="among which the runs are divided")
    parser.add_argument("--depth", type=float, default=DEPTH, help=f"largest penetration, above {START}")
    parser.add_argument("--dask", action="store_true", help="by a local Dask cluster")
    options = parser.parse_args()
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    for jobs in options.jobs:
        dask = LOCAL_CLUSTER if options.dask else None
        ratios = efficiencies(options.runs, options.turns, options.depth, jobs, dask)
        low, middle, high = quantiles(ratios, method="inclusive")
        print(f"{jobs} processes{' (Dask)' * bool(dask)}: efficiency {middle:.3f} ({low:.3f} to {high:.3f})")
