"""Prony series from measured moduli: non-negative least squares on a log grid of times, then pruning.

Unknown are the relaxed modulus and the moduli of branches with times on a grid; all of them are >= 0 (Lawson
and Hanson's non-negative least squares), which makes the material passive and the solution sparse. Residuals
are relative, ``fit/measured - 1``, so that every decade counts alike. Then

1. grid neighbours that are both in use stand for one branch between them: they are joined;
2. all times and moduli are refined together, by nonlinear least squares in their logarithms;
3. the branch that is missed least is dropped and 2. repeated, as long as the misfit stays below
   ``tolerance``; where the data scatter by more, as long as Schwarz' criterion (Ann. Statist. 6, 1978)
   prefers the shorter series, ``N ln(misfit_new^2/misfit_old^2) <= 2 ln N`` for ``N`` residuals and two
   parameters a branch;
4. last the relaxed modulus is left out where the same criterion says that the data show none.

Branches outside the window of the data cannot be told from it and are not tried: faster ones have relaxed
before the first point, slower ones look like the relaxed modulus.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from contact_scene.material import Branch, Material
from contact_scene.measured_moduli import DynamicData, RelaxationData
from contact_scene.series_design import LAST_REFINEMENTS, PronySeries, SeriesDesign, root_mean_square
from contact_scene.value_checks import LARGEST, SMALLEST, number, of_class, positive

PER_DECADE = 10
"""Grid times a decade: neighbours differ by a quarter, so refinement starts within an eighth of any time."""

TOLERANCE = 1e-3
"""Default root mean square of the relative residuals below which branches are dropped: what the solvers are
checked to, and finer than a rheometer is calibrated."""

ROUNDING = 1e-6
"""Root mean square of the relative residuals below which a series without relaxed modulus meets the data
exactly: the digits that instruments write."""


@dataclass(frozen=True)
class DroppedBranch:
    """A branch left out by pruning.

    Parameters
    ----------
    branch : Branch
        As it was.
    misfit_before, misfit_after : float
        Root mean square of the relative residuals with it, and without it.
    """

    branch: Branch
    misfit_before: float
    misfit_after: float


@dataclass(frozen=True)
class PronyFit:
    """A Prony series and how it meets the data.

    Parameters
    ----------
    data : RelaxationData or DynamicData
    modulus : float
        Relaxed modulus, of the kind of the data (shear or Young's); 0 where the data show none.
    branches : tuple of Branch
        Of the same kind, ascending in time.
    residuals : ndarray, shape (n,) or (2 n,)
        ``fit/measured - 1``; of dynamic data storage moduli first, then loss moduli.
    grid : ndarray, shape (m,)
        Times that were tried.
    used : int
        How many of them non-negative least squares took.
    joined : int
        Branches left when neighbours among these were joined.
    dropped : tuple of DroppedBranch
        In the order in which they were dropped.
    unknowns : int
        Numbers that were fitted: two a branch, and the relaxed modulus where it was not given.
    """

    data: RelaxationData | DynamicData
    modulus: float
    branches: tuple[Branch, ...]
    residuals: NDArray[np.float64]
    grid: NDArray[np.float64]
    used: int
    joined: int
    dropped: tuple[DroppedBranch, ...]
    unknowns: int

    @property
    def determined(self) -> bool:
        """Whether there are at least as many measured moduli as fitted numbers."""
        return self.unknowns <= self.residuals.size

    @property
    def misfit(self) -> float:
        """Root mean square of the relative residuals."""
        return root_mean_square(self.residuals)

    @property
    def largest_residual(self) -> float:
        """Largest relative residual."""
        return float(np.abs(self.residuals).max())

    def material(self, poisson: float) -> Material:
        """The series as a material; shear moduli become Young's, ``E = 2 (1 + nu) G``.

        Raises
        ------
        SceneError
            If the data show no relaxed modulus.
        """
        if self.modulus == 0.0:
            raise SceneError(
                "modulus", "the data show no relaxed modulus", "a relaxed modulus > 0, given beside the data"
            )
        return series_material(self.modulus, self.branches, poisson, self.data.shear)


def series_material(modulus: float, branches: Sequence[Branch], poisson: float, shear: bool) -> Material:
    """A material from a series; shear moduli become Young's, ``E = 2 (1 + nu) G``.

    Parameters
    ----------
    modulus : float
        Relaxed modulus.
    branches : sequence of Branch
    poisson : float
        Poisson's ratio.
    shear : bool
        Whether ``modulus`` and ``branches`` are shear moduli.

    Returns
    -------
    Material
    """
    scale = young_over(shear, poisson)
    return Material(
        scale * modulus, poisson, tuple(Branch(scale * branch.modulus, branch.time) for branch in branches)
    )


def young_over(shear: bool, poisson: float) -> float:
    """Young's modulus over a modulus of the given kind: ``2 (1 + nu)`` for shear, else 1."""
    nu = number(poisson, "poisson", "0 <= nu <= 0.5", low=0.0, high=0.5)
    return 2.0 * (1.0 + nu) if shear else 1.0


def fit_prony(
    data: RelaxationData | DynamicData, *, relaxed: float | None = None, tolerance: float = TOLERANCE
) -> PronyFit:
    """The shortest series that meets measured moduli.

    Parameters
    ----------
    data : RelaxationData or DynamicData
        At least 3 rows, at most 20,000 (:mod:`contact_scene.series_design`).
    relaxed : float, optional
        Relaxed modulus > 0, of the kind of the data, where it is known; fitted otherwise.
    tolerance : float
        Branches are dropped as long as the root mean square of the relative residuals stays below, 0 to 1;
        of data that scatter by more, as long as Schwarz' criterion prefers the shorter series.

    Returns
    -------
    PronyFit
    """
    measured = "RelaxationData or DynamicData, as read_measured reads them from a file"
    of_class(data, "data", (RelaxationData, DynamicData), measured)
    number(tolerance, "tolerance", "0 <= tolerance <= 1", low=0.0, high=1.0)
    grid = _grid(data)
    design = SeriesDesign(data, grid, None if relaxed is None else positive(relaxed, "modulus"))
    start = design.least_squares(grid)
    used = int(np.count_nonzero(start.moduli))
    series = design.refined(_joined(start, grid))
    joined = series.times.size
    if series.misfit > tolerance:  # a continuous spectrum, say, needs more
        unjoined = design.refined(start.without(start.moduli == 0.0))
        if not design.prefers(series, unjoined, tolerance):
            series, joined = unjoined, used
    dropped = []
    while series.times.size:
        shorter = design.refined(design.without_least(series))
        if not design.prefers(shorter, series, tolerance):
            break
        gone = _missing(series, shorter)
        dropped += [DroppedBranch(branch, series.misfit, shorter.misfit) for branch in gone]
        series = shorter
    if relaxed is None and series.relaxed > 0.0:
        melt = SeriesDesign(data, grid, 0.0).refined(series)
        if design.prefers(melt, series, ROUNDING):
            series = melt
    last = design if series.relaxed > 0.0 else SeriesDesign(data, grid, 0.0)
    series = last.refined(series, LAST_REFINEMENTS)
    order = np.argsort(series.times)
    branches = tuple(Branch(float(series.moduli[k]), float(series.times[k])) for k in order)
    unknowns = 2 * len(branches) + int(relaxed is None and series.relaxed > 0.0)
    return PronyFit(
        data, series.relaxed, branches, design.residuals(series), grid, used, joined, tuple(dropped), unknowns
    )


def _grid(data: RelaxationData | DynamicData) -> NDArray[np.float64]:
    """Times within the window of the data: half a decade beyond its first and its last point.

    There the fastest still shows 4 % of its modulus, and the slowest has lost 27 % of it.
    """
    if isinstance(data, RelaxationData):
        first, last = float(data.times[0]), float(data.times[-1])
    else:
        first, last = 1.0 / float(data.angular_frequencies[-1]), 1.0 / float(data.angular_frequencies[0])
    first, last = max(first / math.sqrt(10.0), SMALLEST), min(last * math.sqrt(10.0), LARGEST)
    count = max(2, math.ceil(PER_DECADE * math.log10(last / first)) + 1)
    return np.clip(np.geomspace(first, last, count), first, last)


def _joined(series: PronySeries, grid: NDArray[np.float64]) -> PronySeries:
    """Runs of neighbours on the grid as one branch each, at their mean log time weighted by modulus."""
    used = np.flatnonzero(series.moduli)
    runs = np.split(used, np.flatnonzero(np.diff(used) > 1) + 1) if used.size else []
    times = [
        float(np.exp(np.average(np.log(grid[run]), weights=series.moduli[run] / series.moduli[run].sum())))
        for run in runs
    ]
    moduli = [float(series.moduli[run].sum()) for run in runs]
    return PronySeries(series.relaxed, np.array(times), np.array(moduli), series.misfit, np.arange(len(runs)))


def _missing(longer: PronySeries, shorter: PronySeries) -> list[Branch]:
    """The branches that only the longer series has."""
    gone = np.flatnonzero(~np.isin(longer.origin, shorter.origin))
    return [Branch(float(longer.moduli[k]), float(longer.times[k])) for k in gone]
