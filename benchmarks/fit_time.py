"""Time of a fit of three curves with its check by a second solver, against two minutes on two cores.

::

    python -m benchmarks.fit_time --jobs 2

The curves are those of a random material of :mod:`benchmarks.fit_recovery`, at three speeds, with a noise of
1 % of the pull-off force; work of adhesion and one branch are fitted, and each curve's baseline. Curves are
made before the clock starts. On a machine that does other work besides, processor seconds tell more.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.fit_recovery import VARIED, random_scenes, recorded
from validation.execution.processes import processes
from validation.fits.fit import fit_curves
from validation.fits.fit_result import FitResult
from validation.fits.fit_settings import FitSettings

LIMIT = 120.0
"""Wall seconds that such a fit may take on two cores."""


@dataclass(frozen=True)
class FitTime:
    """How long a fit took.

    Parameters
    ----------
    wall, processor : float
        Seconds, the second of all processes together.
    result : FitResult
    """

    wall: float
    processor: float
    result: FitResult

    @property
    def text(self) -> str:
        """In a line."""
        checked = [] if self.result.check is None else self.result.check.differences
        second = ", ".join(f"{one.root_mean_square:.2g}" for one in checked) or "none"
        verdict = "pass" if self.wall <= LIMIT else "FAIL"
        return (
            f"{len(self.result.curves)} curves, {len(self.result.estimates)} parameters, {self.result.runs} "
            f"runs: {self.wall:.0f} s of at most {LIMIT:.0f} s ({verdict}), {self.processor:.0f} s of all "
            f"processors; difference of the second solver over the noise: {second}"
        )


def timed_fit(material: int, jobs: int, check_solver: str | None = "bem") -> FitTime:
    """Fit the three curves of a random material."""
    scenes, guess = random_scenes(material)
    curves = recorded(material, scenes)
    settings = FitSettings(vary=VARIED, free=("baseline",), check_solver=check_solver)
    before, began = _processor_seconds(), time.perf_counter()
    with processes(jobs) as executor:
        result = fit_curves(curves, guess, settings, executor)
    wall = time.perf_counter() - began  # workers count as children once they have ended
    return FitTime(wall, _processor_seconds() - before, result)


def _processor_seconds() -> float:
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line of this module; 1 if the fit took longer than it may."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fit_time")
    parser.add_argument("--material", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args(arguments)
    found = timed_fit(options.material, options.jobs)
    print(found.text)
    return 0 if found.wall <= LIMIT else 1


if __name__ == "__main__":
    raise SystemExit(main())
