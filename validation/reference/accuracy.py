"""What the front tracking costs and how well it converges: ``python -m validation.reference.accuracy``.

One table a case: resolution, steps, processor time, errors against a run at ``TRUTH``, the order between
the coarsest and the finest, and the run's own estimates. The cases are cycles on materials with one to thirty
branches, slow and fast, and the start of the frequency sweep. ``--quick`` leaves out the expensive ones.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np

from scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere, Sweep, Trace
from validation.observables import observe
from validation.reference import Options, solve

WORK = math.pi * 1.6e-4  # gamma~ = 1.6e-4 with R = 1, E0* = 1
ZONE = 0.013
RESOLUTIONS = (4, 8, 16, 32)
TRUTH = 64
SCALARS = ("pull_off_force", "loop_energy", "approach_force", "approach_radius")
USUAL = 16  # the default resolution


def spectrum(count: int, low: float, high: float) -> tuple[Branch, ...]:
    """Branches of equal modulus, nine times E0 in all, at times evenly spread over decades."""
    return tuple(Branch(6.75 / count, float(t)) for t in np.logspace(low, high, count))


MATERIALS = {
    "one": (Branch(6.75, 1.0),),
    "two": (Branch(3.0, 0.1), Branch(3.75, 10.0)),
    "seven": spectrum(7, -3, 3),
    "thirty": spectrum(30, -10, 5),
}


def cycle(speed: float, material: str = "one") -> Scene:
    """Approach to 0.032 R and retraction until contact is lost (paper, Fig. 2)."""
    return Scene(
        Material(0.75, 0.5, MATERIALS[material]),
        Sphere(1.0),
        Loading("jump-in", 0.0, (Ramp(0.032, speed), Ramp(-0.5, speed))),
        Adhesion(WORK, ZONE),
    )


def sweep(duration: float) -> Scene:
    """The frequency sweep of Fig. 6 as far as ``duration``."""
    return Scene(
        Material(0.75, 0.5, MATERIALS["one"]),
        Sphere(1.0),
        Loading("relaxed", 5.7e-5, (Sweep(-1.7e-5, 0.006, duration),)),
        Adhesion(math.pi * 5e-8, 8.5e-4),
    )


CASES = {
    "cycle, V = 0.02, 1 branch": cycle(0.02),
    "cycle, V = 0.02, 2 branches": cycle(0.02, "two"),
    "cycle, V = 0.02, 7 branches over 6 decades": cycle(0.02, "seven"),
    "cycle, V = 0.02, 30 branches over 15 decades": cycle(0.02, "thirty"),
    "cycle, V = 0.1": cycle(0.1),
    "cycle, V = 0.002": cycle(0.002),
    "cycle, V = 2e-5": cycle(2e-5),
    "sweep, 8 cycles": sweep(132.0),
}
QUICK = tuple(name for name in CASES if "V = 0.02, 1" in name or name == "cycle, V = 0.1")


@dataclass(frozen=True)
class Level:
    """One run: errors are relative, ``estimates`` those the run itself gives."""

    resolution: int
    steps: int
    cpu_seconds: float
    errors: dict[str, float]
    estimates: dict[str, float]

    @property
    def worst(self) -> float:
        """Largest of the errors."""
        return max(abs(error) for error in self.errors.values())


def measured(trace: Trace) -> dict[str, float]:
    """The scalars that errors are told of, as far as they apply."""
    seen = observe(trace).as_dict()
    return {name: value for name in SCALARS if (value := seen[name]) is not None}


def levels(
    scene: Scene, resolutions: tuple[int, ...] = RESOLUTIONS, truth: int = TRUTH, usual: int = USUAL
) -> list[Level]:
    """Runs at several resolutions, judged by one at ``truth``; the one at ``usual`` estimates its errors."""
    exact = measured(solve(scene, Options(truth)))
    found = []
    for resolution in resolutions:
        began = time.process_time()
        trace = solve(scene, Options(resolution))
        spent = time.process_time() - began
        own = solve(scene, Options(resolution, estimate_errors=True)).errors if resolution == usual else {}
        errors = {name: value / exact[name] - 1.0 for name, value in measured(trace).items()}
        found.append(Level(resolution, trace.counters.steps, spent, errors, own))
    return found


def order(found: list[Level], name: str = "loop_energy") -> float:
    """Order between the first and the last level, by the errors against the finest run."""
    first, last = found[0], found[-1]
    ratio = abs(first.errors[name]) / max(abs(last.errors[name]), 1e-16)
    return math.log(ratio) / math.log(last.resolution / first.resolution)


def table(name: str, found: list[Level]) -> list[str]:
    """The lines of one case."""
    head = f"{'n':>4}{'steps':>7}{'cpu s':>8}" + "".join(f"{column:>18}" for column in SCALARS)
    lines = [name, head]
    for level in found:
        cells = "".join(f"{level.errors.get(column, math.nan):>18.1e}" for column in SCALARS)
        lines.append(f"{level.resolution:>4}{level.steps:>7}{level.cpu_seconds:>8.2f}{cells}")
    lines.append("order: " + ", ".join(f"{name} {order(found, name):.1f}" for name in found[0].errors))
    own = next((level.estimates for level in found if level.estimates), {})
    lines.append("own estimates at default: " + ", ".join(f"{k} {v:.1e}" for k, v in own.items()))
    return lines


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m validation.reference.accuracy", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cases only")
    quick = parser.parse_args().quick
    for name in QUICK if quick else CASES:
        print("\n".join(table(name, levels(CASES[name]))), flush=True)
        print()


if __name__ == "__main__":
    main()
