"""Cost and convergence of the reference: ``python -m benchmarks.reference_accuracy``.

One table a case: resolution, steps, processor time, errors against a run at ``FINEST``, the order that a
straight line through the logarithms of all errors has, and the run's own estimates. Force and contact radius
are compared at ``MOMENTS`` of the run, which all runs step onto: no interpolation error is in them.
The cases are cycles on materials with one to thirty branches, slow and fast, a retraction from the relaxed
state, and the start of the frequency sweep. ``--quick`` leaves out the expensive ones.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere, Sweep, Trace
from validation.measure.observables import observe
from validation.reference.path import Options, solve
from validation.studies.orders import fitted_slope

WORK = math.pi * 1.6e-4
"""Work of adhesion of ``gamma~ = 1.6e-4``, over ``E0* R``."""
ZONE = 0.013
"""Process-zone length, over ``R``."""
RESOLUTIONS = (4, 8, 16, 32)
"""Other words for tolerances, which fall with their squares."""
FINEST = 96
"""Resolution of the run that errors are measured against."""
MOMENTS = np.linspace(0.06, 0.96, 11)
"""Times of comparison, as shares of the run."""
COLUMNS = ("pull_off_force", "loop_energy", "force", "contact_radius")
USUAL = 16
"""The default resolution, at which the run estimates its own errors."""


def spectrum(count: int, low: float, high: float) -> tuple[Branch, ...]:
    """Branches of equal modulus, nine times E0 in all, at times evenly spread over decades."""
    return tuple(Branch(6.75 / count, float(t)) for t in np.logspace(low, high, count))


MATERIALS = {
    "one": (Branch(6.75, 1.0),),
    "two": (Branch(3.0, 0.1), Branch(3.75, 10.0)),
    "seven": spectrum(7, -3, 3),
    "thirty": spectrum(30, -10, 5),
}


def pulled(loading: Loading, material: str = "one") -> Scene:
    """The contact of the paper's Fig. 2 under a loading."""
    return Scene(Material(0.75, 0.5, MATERIALS[material]), Sphere(1.0), loading, Adhesion(WORK, ZONE))


def cycle(speed: float, material: str = "one") -> Scene:
    """Approach to 0.032 R and retraction until contact is lost (paper, Fig. 2)."""
    return pulled(Loading("jump-in", 0.0, (Ramp(0.032, speed), Ramp(-0.5, speed))), material)


RELAXED = pulled(Loading("relaxed", 0.032, (Ramp(-0.5, 0.1),)))
SWEEP = Scene(
    Material(0.75, 0.5, MATERIALS["one"]),
    Sphere(1.0),
    Loading("relaxed", 5.7e-5, (Sweep(-1.7e-5, 0.006, 132.0),)),
    Adhesion(math.pi * 5e-8, 8.5e-4),
)
"""The frequency sweep of Fig. 6 as far as eight cycles."""
CASES = {
    "cycle, V = 0.02, 1 branch": cycle(0.02),
    "cycle, V = 0.1": cycle(0.1),
    "cycle, V = 0.02, 2 branches": cycle(0.02, "two"),
    "cycle, V = 0.02, 7 branches over 6 decades": cycle(0.02, "seven"),
    "cycle, V = 0.02, 30 branches over 15 decades": cycle(0.02, "thirty"),
    "cycle, V = 0.002": cycle(0.002),
    "cycle, V = 2e-5": cycle(2e-5),
    "relaxed, then pulled at V = 0.1": RELAXED,
    "sweep, 8 cycles": SWEEP,
}
QUICK = tuple(CASES)[:2]


@dataclass(frozen=True)
class AccuracyLevel:
    """One run: errors are relative, ``estimates`` those the run itself gives."""

    resolution: int
    steps: int
    cpu_seconds: float
    errors: dict[str, float]
    estimates: dict[str, float]

    @property
    def worst(self) -> float:
        """Largest of the errors."""
        return max(self.errors.values())


def measured(trace: Trace, moments: tuple[float, ...]) -> dict[str, NDArray[np.float64]]:
    """Two scalars of the run and two columns at the moments, all as arrays."""
    observed = observe(trace)
    rows = [int(np.abs(trace.time - moment).argmin()) for moment in moments]
    return {
        "pull_off_force": np.array([observed.pull_off_force]),
        "loop_energy": np.array([observed.loop_energy]),
        "force": trace.force[rows],
        "contact_radius": trace.contact_radius[rows],
    }


def levels(
    scene: Scene, resolutions: tuple[int, ...] = RESOLUTIONS, finest: int = FINEST, usual: int = USUAL
) -> list[AccuracyLevel]:
    """Runs at several resolutions and their errors, relative to the largest value of the finest run."""
    end = solve(scene, Options(resolutions[0])).time[-1]
    moments = tuple(float(moment) for moment in MOMENTS * end)
    exact = measured(solve(scene, Options(finest, profile_times=moments)), moments)
    accuracies = []
    for resolution in resolutions:
        begin = time.process_time()
        trace = solve(scene, Options(resolution, profile_times=moments))
        spent = time.process_time() - begin
        own = solve(scene, Options(resolution, estimate_errors=True)).errors if resolution == usual else {}
        values = measured(trace, moments)
        errors = {
            name: float(np.abs(values[name] - exact[name]).max() / np.abs(exact[name]).max())
            for name in COLUMNS
        }
        accuracies.append(AccuracyLevel(resolution, trace.counters.steps, spent, errors, own))
    return accuracies


def order(accuracies: list[AccuracyLevel], name: str, finest: int = FINEST) -> float:
    """Order in the resolution: slope of the straight line through the logarithms of the errors of all levels.

    A value may be right by chance, but not be known to be: errors count as no less than what the ``finest``
    run leaves open, that is the worst error of the last level reduced by second order."""
    steps = [1.0 / level.resolution for level in accuracies]
    last = accuracies[-1]
    unknown = last.worst * (last.resolution / finest) ** 2
    slope = fitted_slope(steps, [max(level.errors[name], unknown) for level in accuracies])
    return math.nan if slope is None else slope


def main() -> None:
    """Print a table for each case."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reference_accuracy", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cases only")
    for name in QUICK if parser.parse_args().quick else CASES:
        print(f"{name}\n{'n':>4}{'steps':>7}{'cpu s':>8}" + "".join(f"{c:>18}" for c in COLUMNS))
        found = levels(CASES[name])
        for level in found:
            cells = "".join(f"{level.errors[column]:>18.1e}" for column in COLUMNS)
            print(f"{level.resolution:>4}{level.steps:>7}{level.cpu_seconds:>8.2f}{cells}")
        print(f"{'order':<19}" + "".join(f"{order(found, column):>18.1f}" for column in COLUMNS))
        own = next(level.estimates for level in found if level.estimates)
        print(f"{f'own estimate, n = {USUAL}':<19}" + "".join(f"{own[c]:>18.1e}" for c in COLUMNS) + "\n")


if __name__ == "__main__":
    main()
