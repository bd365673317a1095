r"""Posterior of the numbers of a fit, by an ensemble of walkers.

The density is :math:`\exp(-\chi^2/2)`, with :math:`\chi^2` as the least squares weigh it (the variance of a
residual, correlated rows counted as their number of independent ones), and flat within the bounds in what the
search sees: the logarithms of positive numbers. The background follows each point. Walkers move by stretches
of the lines between them (Goodman and Weare, Comm. App. Math. Comp. Sci. 5, 65, 2010), half of them at once
(``emcee``: Foreman-Mackey et al., Publ. Astron. Soc. Pac. 125, 306, 2013): the runs of half an ensemble are
one batch.
"""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np

from contact_scene import SceneError
from validation.fits.contact import Array
from validation.fits.problem import FitProblem
from validation.fits.result import Posterior, covariance, independent

WALKERS, IN_BATCH = 32, 64
"""Walkers, more than twice the parameters: few where each run has its price, more where half of them share a
batch; still more would cost the same as longer walks, and set out as often."""
MOST_STEPS, BURN_IN, CHECKED, ENOUGH = 600, 3, 100, 500
"""Steps of a walker, at most; autocorrelation times left out at first, as walkers set out from the covariance
of the least squares; and independent samples behind that are enough, counted every so many steps: they know
the ends of a 95 % interval to an eighth of the deviation."""
AFFORDABLE = 2.0
"""Hours that a posterior may take, by the time of half of its first step."""
WIDEST = 1.0
"""Standard deviation, of a number of the search, from which walkers set out, at most."""


def sampler_module() -> Any:
    """``emcee``, of the extra ``fit``."""
    try:
        import emcee
    except ImportError:
        raise SceneError("posterior", "emcee is not installed", "pip install 'crosscontact[fit]'") from None
    return emcee


def sampled(problem: FitProblem, runs: FitProblem, best: Array, variance: float) -> Posterior:
    """Sample about the best point by ``runs`` of the problem, or of it in batches; ``SceneError`` where the
    time of a point makes that too long."""
    (low, high), settings = problem.bounds, problem.settings
    solver, walkers = ("batch", IN_BATCH) if runs.batched else (settings.solver, WALKERS)
    walkers = max(walkers, 2 * best.size + 2)
    weights = independent(problem.at(best))
    weighed = problem.derivatives(best, following=True) * weights[:, None]
    _, deviations, directions = covariance(weighed, variance)
    generator = np.random.RandomState(settings.seed)
    drawn = generator.standard_normal((walkers, best.size)) * np.minimum(deviations, WIDEST)
    start = np.clip(best + drawn @ directions, low, high)

    def density(points: Array) -> Array:
        """Its logarithm at points of the search, shape (W, P), all runs at once."""
        inside, found = ((points >= low) & (points <= high)).all(axis=1), np.full(len(points), -np.inf)
        left = [np.concatenate([one.values for one in point]) for point in runs.all_at(points[inside])]
        found[inside] = [-0.5 * np.sum((one * weights) ** 2) / variance for one in left]
        runs.kept.clear()
        return found

    if not runs.batched:
        began = time.perf_counter()
        density(start[: walkers // 2])  # as many as the sampler asks for together, side by side
        hours = (time.perf_counter() - began) * 2.0 * MOST_STEPS / 3600.0
        if hours > AFFORDABLE:
            took = f"{walkers * MOST_STEPS} points by {solver} take up to {hours:.1f} h"
            raise SceneError("posterior", took, f"{AFFORDABLE:g} h, or curves that are solved in batches")
    sampler = sampler_module().EnsembleSampler(walkers, best.size, density, vectorize=True)
    sampler.random_state = generator.get_state()
    length, began = np.inf, time.perf_counter()
    for step, _ in enumerate(sampler.sample(start, iterations=MOST_STEPS), 1):
        left = (time.perf_counter() - began) / step * (MOST_STEPS - step)
        problem.tell(f"posterior by {solver}: step {step} of at most {MOST_STEPS}, at most {left:.0f} s left")
        if step % CHECKED == 0:
            length = float(sampler.get_autocorr_time(tol=0).max())
            if walkers * (step - BURN_IN * length) >= ENOUGH * length:
                break
    discarded = min(math.ceil(BURN_IN * length), step // 2)
    plain = sampler.get_chain(discard=discarded, flat=True).T.tolist()
    named = zip(problem.unknowns, plain, strict=True)
    samples = np.array([[one.value(at) for at in column] for one, column in named])
    ends = np.percentile(samples, [2.5, 50.0, 97.5], axis=1).T.tolist()
    intervals = {
        name: dict(zip(("low", "median", "high"), row, strict=True))
        for name, row in zip(problem.names, ends, strict=True)
    }
    acceptance = float(np.mean(sampler.acceptance_fraction))
    return Posterior(solver, walkers, step, discarded, length, acceptance, intervals, samples.T)
