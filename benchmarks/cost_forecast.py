"""Forecast and measurement side by side: ``python -m benchmarks.cost_forecast [SOLVER ...]``.

Prints, for scenes that differ in the length of the process zone, the branches, the cycles and the adhesion,
the steps, the processor time and the growth of the memory of a run, each with its forecast, from which the
constants of a :class:`~validation.solvers.cost.CostModel` are read. Times are those of this machine, one run
each; memory is that of the process, so a large scene hides what smaller ones after it take.
"""

from __future__ import annotations

import resource
import sys
import time
from dataclasses import replace

from contact_scene import Adhesion, Branch, Loading, Material, Oscillate, Ramp, Scene, Sphere
from validation.solvers.registry import SOLVERS, solvers

WORK = 5e-4
CYCLE = Loading("jump-in", 0.0, (Ramp(0.032, 0.1), Ramp(-0.5, 0.1)))
ONE = Material(0.75, 0.5, (Branch(6.75, 1.0),))
ROUND = Scene(ONE, Sphere(1.0), CYCLE, Adhesion(WORK, 0.013))
SCENES = {
    "adhesionless": replace(ROUND, adhesion=None),
    "elastic": replace(ROUND, material=Material(0.75, 0.5)),
    "elastic, short zone": replace(ROUND, material=Material(0.75, 0.5), adhesion=Adhesion(WORK, 0.003)),
    "one branch": ROUND,
    "one branch, short zone": replace(ROUND, adhesion=Adhesion(WORK, 0.006)),
    "ten branches": replace(
        ROUND, material=Material(0.75, 0.5, tuple(Branch(0.675, 10.0 ** (0.5 * n - 2.0)) for n in range(10)))
    ),
    "five cycles": replace(ROUND, loading=Loading("relaxed", 0.01, (Oscillate(0.002, 6.283, 5.0),))),
}
"""Scenes of seconds."""


def main(names: list[str]) -> None:
    """Run the scenes by the named solvers, all by default, and print the table."""
    print(f"{'solver':10} {'scene':24} {'steps':>14} {'seconds':>14} {'megabytes':>14}   found/forecast")
    for solver in [SOLVERS[name] for name in names] or solvers():
        solver.load()
        for label, scene in SCENES.items():
            forecast = solver.expected_cost(scene)
            before, begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
            trace = solver.solve(scene)
            spent = time.process_time() - begin
            grown = 1e-3 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
            steps = f"{trace.counters.steps}/{forecast.steps:.0f}"
            seconds = f"{spent:.2f}/{forecast.seconds:.2f}"
            memory = f"{grown:.0f}/{1e-6 * forecast.bytes:.0f}"
            print(f"{solver.name:10} {label:24} {steps:>14} {seconds:>14} {memory:>14}")


if __name__ == "__main__":
    main(sys.argv[1:])
