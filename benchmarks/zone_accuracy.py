"""How accurate a solver is with zones of every length under every kind of loading.

``python -m benchmarks.zone_accuracy SOLVER [SCENE ...]`` runs built-in scenes with process zones of
given ratios to their contact radius and prints the errors against the reference at twice its default
resolution. The reference itself is measured so against a finer run of its own.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace

from contact_scene import Adhesion, Oscillate, Scene
from validation import cases
from validation.measure.curves import CURVES, distance
from validation.measure.difference import of_numbers
from validation.runs.run import Run, run
from validation.solvers import REFERENCE, SOLVERS, solver
from validation.studies.knobs import Zones

SCENES = (
    "cycle-v0.002",
    "cycle-v0.1",
    "retraction-v0.02",
    "retraction-fast",
    "dwell-1",
    "force-4",
    "pdms-dead-load-1um",
    "three-branches",
    "oscillation-w1.4",
    "cone-cycle",
    "elastic-relaxed",
    "spring-relaxed-si",
)
"""Approach, reversal, dwell, dead loads with delayed detachment, oscillation, branches, jump at a spring."""
CYCLES = 10
"""Cycles of an oscillation: those that follow repeat them."""
MEASURES = ("pull_off_force", "loop_energy", "detachment_time")


def _with_zone(scene: Scene, work: float, zone: float) -> Scene:
    """The scene with another zone, its oscillations no longer than ``CYCLES``."""
    steps = tuple(
        replace(step, duration=min(step.duration, CYCLES * 2.0 * math.pi / step.angular_frequency))
        if isinstance(step, Oscillate)
        else step
        for step in scene.loading.steps
    )
    return replace(scene, adhesion=Adhesion(work, zone), loading=replace(scene.loading, steps=steps))


def _errors(answer: Run, exact: Run) -> dict[str, float]:
    """Of measures and curves; none where one of the two has no answer."""
    if answer.curves is None or exact.curves is None:
        return {}
    numbers = of_numbers(answer, exact, MEASURES)
    errors = {one.quantity: one.error for one in numbers if math.isfinite(one.error)}
    for name in CURVES:
        if (apart := distance(answer.curves, exact.curves, name)) is not None:
            errors[f"{name}, RMS"] = apart.rms
    return errors


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for every scene and zone, the longest first; exit code 2 for what cannot be run."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.zone_accuracy", description=__doc__.partition("\n")[0]
    )
    parser.add_argument("solver", choices=[*SOLVERS])
    parser.add_argument("scenes", nargs="*", default=SCENES, help="built-in names or TOML files")
    parser.add_argument(
        "--zones", type=float, nargs="+", default=Zones.values, help="over the contact radius"
    )
    parser.add_argument("--times", type=int, default=1, help="multiple of the default resolution")
    chosen = parser.parse_args(arguments)
    for case in cases.load_all(chosen.scenes):
        adhesion, own = case.scene.adhesion, run(case, REFERENCE)
        if adhesion is None or own.curves is None:
            print(f"{case.name}: {own.ending}; allowed: a scene with adhesion that the reference answers")
            return 2
        radius = float(own.curves.contact_radius.max())
        for ratio in sorted(chosen.zones, reverse=True):
            there = replace(case, scene=_with_zone(case.scene, adhesion.work, ratio * radius))
            exact = run(there, REFERENCE, 2 * SOLVERS[REFERENCE].default_resolution(there.scene))
            fineness = chosen.times * solver(chosen.solver).default_resolution(there.scene)
            answer = run(there, chosen.solver, fineness)
            steps = 0 if answer.trace is None else answer.trace.counters.steps
            errors = ", ".join(f"{name} {error:.1e}" for name, error in _errors(answer, exact).items())
            what = f"{steps} steps, {answer.cpu_seconds:.2f} s, {errors or 'no errors'}; {answer.ending}"
            print(f"{case.name}, {ratio:.0e}: {what}", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
