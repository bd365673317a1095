"""The fitted curves once more by another solver, and how far it would have moved the parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.fits.problem import FitProblem
from validation.fits.record import Array


@dataclass(frozen=True)
class SolverDifference:
    """One curve by two solvers.

    Parameters
    ----------
    curve : str
    root_mean_square, largest : float
        Difference of the force at the compared rows, over the noise.
    relative : float
        The same root mean square over that of the force.
    failure : str
        Why the second solver gave no curve.
    """

    curve: str
    root_mean_square: float
    largest: float
    relative: float
    failure: str = ""


@dataclass(frozen=True)
class SecondSolver:
    """What a second solver says of a fit.

    Parameters
    ----------
    solver : str
    resolution : int or None
    differences : tuple of SolverDifference
    shifts : mapping of str to float
        By how many of its standard deviations each parameter would move, to first order: what the least
        squares make of the difference. Empty if a run failed.
    """

    solver: str
    resolution: int | None
    differences: tuple[SolverDifference, ...]
    shifts: dict[str, float]


def second_solver(
    problem: FitProblem, x: Array, jacobian: Array, covariance: Array, solver: str, resolution: int | None
) -> SecondSolver:
    """Run it.

    Parameters
    ----------
    problem : FitProblem
        Of the fit.
    x : ndarray, shape (P,)
        Its best point.
    jacobian : ndarray, shape (R, P)
    covariance : ndarray, shape (P, P)
    solver : str
    resolution : int or None

    Returns
    -------
    SecondSolver
    """
    other = FitProblem(
        problem.models,
        problem.parameters,
        solver,
        resolution,
        executor=problem.executor,
        store=problem.store,
        penalty=problem.penalty,
        max_steps=problem.max_steps,
    )
    points = [problem.parameters.of_curve(x, index) for index in range(len(problem.models))]
    found = other.predictions(list(enumerate(points)))
    change = other.residuals(x) - problem.residuals(x)
    differences = []
    for block in problem.blocks():
        if block.kind != "force":
            continue
        model, prediction = problem.models[block.curve], found[block.curve]
        own = change[block.rows]
        size = np.sqrt(np.mean(model.curve.force**2)) / model.features.noise
        rms = float(np.sqrt(np.mean(own**2)))
        differences.append(
            SolverDifference(
                model.curve.name, rms, float(np.abs(own).max()), rms / float(size), prediction.failure
            )
        )
    shifts: dict[str, float] = {}
    deviation = np.sqrt(np.diag(covariance))
    if not any(one.failure for one in differences) and np.isfinite(deviation).all():
        moved = -np.linalg.lstsq(jacobian, change, rcond=None)[0]
        shifts = {
            one.name: float(by / size)
            for one, by, size in zip(problem.parameters.parameters, moved, deviation, strict=True)
        }
    return SecondSolver(solver, resolution, tuple(differences), shifts)
