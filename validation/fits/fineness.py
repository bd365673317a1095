"""How fine the runs of a fit are: time steps whose error is small beside the noise of the curves."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from validation.fits.problem import FitProblem

TOLERANCES = (1.6e-4, 4e-5, 1e-5, 2.5e-6)
"""Tolerances of the reference's time steps that are tried: each is half the step of the one before, the first
is four steps per process zone, the fewest that resolve one."""
ERROR_SHARE = 0.05
"""Error of a run over the noise (root mean square), at most: it moves a parameter by a twentieth of its
standard deviation at the worst."""
ORDER_TWO = 4.0 / 3.0
"""Error of a run over its difference from one of half the step, for a method of second order."""
SMALLEST_STEP, LARGEST_STEP = 1e-4, 1e-2
"""Bounds of the step of differences: the root of the relative error of a run, which makes the error of a
derivative least if the errors of two neighbouring runs have nothing in common, lies between them."""


def fineness(problem: FitProblem) -> tuple[float, float, float]:
    """Tolerance of time steps with an error small beside the noise, that error, the step of differences."""
    x = problem.parameters.start
    forces = [block.rows for block in problem.blocks() if block.kind == "force"]
    data = np.concatenate([model.curve.force / model.features.noise for model in problem.models])
    size = float(np.sqrt(np.mean(data**2)))
    share, coarse = np.inf, None
    for tolerance, finer in pairwise(TOLERANCES):
        found = []
        for one in (tolerance, finer):
            problem.tolerance = one
            found.append(problem.residuals(x) if one == finer or coarse is None else coarse)
        coarse = found[1]
        change = np.concatenate([(found[1] - found[0])[rows] for rows in forces])
        share = ORDER_TWO * float(np.sqrt(np.mean(change**2)))
        if share <= ERROR_SHARE:
            break
    step = float(np.clip(np.sqrt(share / size), SMALLEST_STEP, LARGEST_STEP))
    return tolerance, share, step
