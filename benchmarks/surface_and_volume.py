"""Surface components against internal variables in the volume: ``python -m benchmarks.surface_and_volume``.

The nodal forces of a run go through the Prony updates of the whole body (``fem_solver.volume``). Rows and
nodes are refined together, N the elements of a process zone (without adhesion: divisions of a hundredth of
the largest contact radius). Errors are root mean squares over the rows, relative to the largest of the run.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence

from fem_solver import Options, record
from fem_solver.volume import VolumeAnswer, replayed
from validation import cases
from validation.solvers.finite_elements import FiniteElements

SCENES = ("adhesionless-cycle", "cycle-v0.02")
RESOLUTIONS = (5, 10)


def answers(name: str, resolutions: Sequence[int]) -> Iterator[tuple[int, VolumeAnswer, float, float]]:
    """Resolution, answer, and processor seconds of the run and of the volume."""
    scene, method = cases.load(name).scene, FiniteElements()
    for resolution in resolutions:
        begin = time.process_time()
        options = Options(record=True)
        recording = record(scene, method.mesh(scene, resolution), options)
        ran = time.process_time()
        answer = replayed(recording)
        yield resolution, answer, ran - begin, time.process_time() - ran


def main() -> None:
    """Print a line for every scene and resolution."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--resolution", type=int, nargs="+", default=RESOLUTIONS)
    given = parser.parse_args()
    for name in given.scenes:
        for resolution, answer, ran, volume in answers(name, given.resolution):
            errors = ", ".join(f"{quantity} {error:.1e}" for quantity, error in answer.errors.items())
            rows = len(answer.time)
            print(f"{name}, N = {resolution}, {rows} rows: {errors}; run {ran:.1f} s, volume {volume:.1f} s")


if __name__ == "__main__":
    main()
