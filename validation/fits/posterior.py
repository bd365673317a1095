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
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from contact_scene import SceneError
from validation.fits.contact import Array
from validation.fits.problem import ERROR_SHARE, TOLERANCES, FitProblem
from validation.fits.result import FitResult, Posterior, covariance, independent, rms

WALKERS, IN_BATCH = 32, 64
"""Walkers, more than twice the parameters: few where each run has its price, more where half of them share a
batch; still more would cost the same as longer walks, and set out as often."""
MOST_STEPS, BURN_IN, CHECKED, ENOUGH = 600, 3, 100, 500
"""Steps of a walker, at most; autocorrelation times left out at first, as walkers set out from the covariance
of the least squares; and independent samples behind that are enough, counted every so many steps: they know
the ends of a 95 % interval to an eighth of the deviation."""
AFFORDABLE = 2.0
"""Hours that a posterior may take, by the time of the runs before it."""
WIDEST = 1.0
"""Standard deviation, of a number of the search, from which walkers set out, at most."""


def sampler_module() -> Any:
    """``emcee``, of the extra ``fit``."""
    try:
        import emcee
    except ImportError:
        raise SceneError("posterior", "emcee is not installed", "pip install 'crosscontact[fit]'") from None
    return emcee


def _alike(problem: FitProblem, x: Array) -> bool:
    """Whether runs in batches have the residuals of fine ones, but for the error that any run may have."""
    if problem.quick is None:
        return False
    together, fine = problem.quick.at(x), replace(problem, tolerance=TOLERANCES[-1]).at(x)
    sound = not any(one.failure for one in together.predictions)
    return sound and rms(together.residuals - fine.residuals) <= ERROR_SHARE


class _Density:
    """Logarithm of the density at points of the search, shape (W, P), all runs at once."""

    def __init__(self, sampled: FitProblem, problem: FitProblem, best: Array, result: FitResult) -> None:
        self._problem, self._bounds = sampled, problem.unknowns.bounds
        deviation = np.full(problem.size, math.sqrt(result.goodness.variance))
        self._weights = independent(problem, problem.at(best), 1.0 / deviation)

    def __call__(self, points: Array) -> Array:
        problem, (low, high) = self._problem, self._bounds
        inside = ((points >= low) & (points <= high)).all(axis=1)
        found = np.full(len(points), -np.inf)
        left = [point.residuals for point in problem.all_at(points[inside])]
        found[inside] = -0.5 * np.sum((np.reshape(left, (-1, problem.size)) * self._weights) ** 2, axis=1)
        problem.forget()
        return found


def sampled(
    problem: FitProblem, best: Array, result: FitResult, price: float, tell: Callable[[str], None]
) -> Posterior:
    """Sample about the best point; ``SceneError`` if runs of ``price`` seconds make that too long."""
    together = problem.quick if _alike(problem, best) else None
    solver, walkers = problem.settings.solver, WALKERS
    if together is not None:
        solver, walkers = "batch", IN_BATCH
    hours = price * len(problem.models) * walkers * MOST_STEPS / 3600.0
    if together is None and hours > AFFORDABLE:
        took = f"{walkers * MOST_STEPS} points by {solver} take up to {hours:.1f} h"
        raise SceneError("posterior", took, f"{AFFORDABLE:g} h, or retractions, which are solved in batches")
    walkers = max(walkers, 2 * best.size + 2)
    weighed = independent(problem, problem.at(best), problem.jacobian(best))
    _, deviations, directions = covariance(weighed, result.goodness.variance)
    generator = np.random.RandomState(problem.settings.seed)
    drawn = generator.standard_normal((walkers, best.size)) * np.minimum(deviations, WIDEST)
    start = np.clip(best + drawn @ directions, *problem.unknowns.bounds)
    density = _Density(together or problem, problem, best, result)
    sampler = sampler_module().EnsembleSampler(walkers, best.size, density, vectorize=True)
    sampler.random_state = generator.get_state()
    length, began = np.inf, time.perf_counter()
    for step, _ in enumerate(sampler.sample(start, iterations=MOST_STEPS), 1):
        left = (time.perf_counter() - began) / step * (MOST_STEPS - step)
        tell(f"posterior by {solver}: step {step} of at most {MOST_STEPS}, at most {left:.0f} s left")
        if step % CHECKED == 0:
            length = float(sampler.get_autocorr_time(tol=0).max())
            if walkers * (step - BURN_IN * length) >= ENOUGH * length:
                break
    discarded = min(math.ceil(BURN_IN * length), step // 2)
    plain = sampler.get_chain(discard=discarded, flat=True).T.tolist()
    named = zip(problem.unknowns.found, plain, strict=True)
    samples = np.array([[one.value(at) for at in column] for one, column in named])
    ends = np.percentile(samples, [2.5, 50.0, 97.5], axis=1).T.tolist()
    intervals = {
        name: dict(zip(("low", "median", "high"), row, strict=True))
        for name, row in zip(problem.unknowns.names, ends, strict=True)
    }
    acceptance = float(np.mean(sampler.acceptance_fraction))
    return Posterior(solver, walkers, step, discarded, length, acceptance, intervals, samples.T)
