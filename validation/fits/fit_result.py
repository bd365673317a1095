"""What a fit found: estimates with errors, the fitted curves, what is to be known of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from validation.fits.fit_settings import FitSettings
from validation.fits.goodness import Goodness
from validation.fits.profile_likelihood import LikelihoodProfile
from validation.fits.record import Array, MeasuredCurve
from validation.fits.second_solver import SecondSolver
from validation.fits.statistics import Combination, Estimate


@dataclass(frozen=True)
class FittedCurve:
    """One curve beside what the fit makes of it.

    Parameters
    ----------
    curve : MeasuredCurve
    force : ndarray, shape (N,)
        Fitted, baseline and drift included.
    residuals : ndarray, shape (N,)
        Measured minus fitted over the noise.
    compared : ndarray of bool, shape (N,)
        Rows that took part.
    position : ndarray, shape (N,)
        Of stage or indenter as measured, from the fitted contact point.
    noise : float
    noise_source : str
    failure : str
        Why the run of the best point did not reach its end.
    """

    curve: MeasuredCurve
    force: Array
    residuals: Array
    compared: NDArray[np.bool_]
    position: Array
    noise: float
    noise_source: str
    failure: str = ""


@dataclass(frozen=True)
class FitResult:
    """What a fit found, with its errors.

    Parameters
    ----------
    scene : Scene
        The scene with the fitted numbers that all curves share.
    settings : FitSettings
    curves : tuple of FittedCurve
    estimates : tuple of Estimate
    correlations : ndarray, shape (P, P)
    combinations : tuple of Combination
    confused : list of (str, str, float)
    goodness : Goodness
    profiles : tuple of LikelihoodProfile
    check : SecondSolver or None
    resolution : int or None
    tolerance : float or None
        Of the time steps.
    error_share : float or None
        Error of the runs over the noise, root mean square.
    ended : str
    converged : bool
    starts : tuple of float
        Sum of squares after the first iterations of each start.
    warnings : tuple of str
    runs : int
    seconds : float
    question : mapping of str to str
        What was asked, as hashes.
    """

    scene: Scene
    settings: FitSettings
    curves: tuple[FittedCurve, ...]
    estimates: tuple[Estimate, ...]
    correlations: Array
    combinations: tuple[Combination, ...]
    confused: list[tuple[str, str, float]]
    goodness: Goodness
    profiles: tuple[LikelihoodProfile, ...]
    check: SecondSolver | None
    resolution: int | None
    tolerance: float | None
    error_share: float | None
    ended: str
    converged: bool
    starts: tuple[float, ...]
    warnings: tuple[str, ...]
    runs: int
    seconds: float
    question: dict[str, str]


class InterruptedFit(KeyboardInterrupt):
    """Ctrl-C during a fit; ``result`` holds the best so far, or ``None`` before the first point."""

    def __init__(self, result: FitResult | None) -> None:
        super().__init__()
        self.result = result
