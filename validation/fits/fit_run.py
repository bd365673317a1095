"""A run of a fit: the columns that are compared, and their values between the rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contact_scene import OutcomeKind, Scene, SceneError
from contact_scene.errors import one_line
from validation import solvers
from validation.fits.record import Array
from validation.measure.curves import RowCurve

ON_TIME = 1e-9
"""Distance of a row from the corner it was stepped onto, over the duration, at most: round-off of times."""


@dataclass(frozen=True)
class FitRun:
    """The part of a run that a fit compares.

    Parameters
    ----------
    time, force, contact_radius, penetration : ndarray, shape (n,)
        Rows; empty if there is no contact at all.
    lost : float or None
        When contact was lost.
    failure : str
        Why the run did not reach its end; its rows up to there count.
    refused : bool
        Whether the solver does not take the scene.
    """

    time: Array
    force: Array
    contact_radius: Array
    penetration: Array
    lost: float | None = None
    failure: str = ""
    refused: bool = False


NO_CONTACT = FitRun(*(np.empty(0),) * 4)


def run_of(
    scene: Scene,
    solver: str,
    resolution: int | None,
    tolerance: float | None = None,
    max_steps: int | None = None,
) -> FitRun:
    """Solve a scene; what goes wrong is part of the answer.

    Parameters
    ----------
    scene : Scene
    solver : str
    resolution : int or None
    tolerance : float or None
        Of the time steps, where no resolution is given.
    max_steps : int or None
        ``None``: the solver's own bound.

    Returns
    -------
    FitRun
    """
    method = solvers.solver(solver)
    method.load()
    try:
        trace = method.solve(scene, resolution, step_tolerance=tolerance, max_steps=max_steps)
    except SceneError as error:
        return replace(NO_CONTACT, failure=str(error), refused=True)
    except Exception as error:
        if tolerance is not None:  # steps as coarse as a fit can do with may be too coarse for this scene
            return run_of(scene, solver, resolution, None, max_steps)
        return replace(NO_CONTACT, failure=one_line(error))
    columns = trace.time, trace.force, trace.contact_radius, trace.penetration
    finite = np.isfinite(columns).all(axis=0)
    if not finite.all():
        return replace(NO_CONTACT, failure="the run is not finite")
    ended = trace.outcome.finished and trace.outcome.kind is not OutcomeKind.COMPLETED
    failure = "" if trace.outcome.finished else f"{trace.outcome.kind}: {trace.outcome.reason}"
    return FitRun(*columns, float(trace.time[-1]) if ended else None, failure)


def sampled(time: Array, value: Array, corners: Array, at: Array) -> Array:
    """A column of a run between its rows, each stretch between corners of the loading for itself.

    Parameters
    ----------
    time, value : ndarray, shape (n,)
        Rows of the run; it steps onto every corner.
    corners : ndarray
        Times of the corners, rising; some may be outside the run.
    at : ndarray, shape (N,)
        Times within the run.

    Returns
    -------
    ndarray, shape (N,)
    """
    places = np.searchsorted(time, corners[(corners > time[0]) & (corners < time[-1])] - ON_TIME * time[-1])
    ends = np.unique(np.concatenate([[0], places, [time.size - 1]]))
    result = np.empty(at.size)
    for first, last in pairwise(ends.tolist()):
        rows = slice(first, last + 1)
        inside = (at >= time[first]) & (at <= time[last])
        if inside.any():
            result[inside] = RowCurve(time[rows], value[rows]).values(at[inside])
    return result
