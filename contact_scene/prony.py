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
from contact_scene.measured_moduli import Array, DynamicData, MeasuredModuli, RelaxationData
from contact_scene.value_checks import LARGEST, SMALLEST, number, of_class, positive

PER_DECADE = 10
"""Grid times a decade: neighbours differ by a quarter, so refinement starts within an eighth of any time."""

TOLERANCE = 1e-3
"""Default root mean square of the relative residuals below which branches are dropped: what the solvers are
checked to, and finer than a rheometer is calibrated."""

ROUNDING = 1e-6
"""Root mean square of the relative residuals below which a series without relaxed modulus meets the data
exactly: the digits that instruments write."""

MOST_ROWS = 20_000
"""Rows of measured data: the design matrix of more would not fit into memory comfortably."""

FEWEST_ROWS = 3
"""Rows of measured data, at different times or frequencies: fewer determine no branch beside a relaxed
modulus."""

REFINEMENTS, LAST_REFINEMENTS = 12, 100
"""Evaluations of a refinement while branches are dropped, which starts near its end, and of the last one."""


@dataclass(frozen=True)
class PronySeries:
    """Relaxed modulus, branches (times, moduli and the number each began with), root mean square residual."""

    relaxed: float
    times: Array
    moduli: Array
    misfit: float
    origin: NDArray[np.int64]

    def without(self, gone: NDArray[np.bool_]) -> PronySeries:
        """The same without some branches; its misfit holds if their moduli are zero."""
        return PronySeries(
            self.relaxed, self.times[~gone], self.moduli[~gone], self.misfit, self.origin[~gone]
        )


class SeriesDesign:
    """Relative responses of unit moduli at the points of the data."""

    def __init__(self, data: MeasuredModuli, grid: Array, relaxed: float | None) -> None:
        rows, distinct = data.points.size, np.unique(data.points).size
        if not FEWEST_ROWS <= rows <= MOST_ROWS:
            raise SceneError("", f"{rows} rows of data", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
        if distinct < FEWEST_ROWS:
            allowed = f"{FEWEST_ROWS} {data.over} or more"
            raise SceneError("", f"{rows} rows at {distinct} {data.over}", allowed)
        self.data, self.known = data, relaxed
        self.window = math.log(grid[0]), math.log(grid[-1])
        measured = data.measured
        self.unit = float(np.exp(np.log(measured).mean()))  # moduli in this unit are of order one
        self.weights = self.unit / measured
        self.constant = data.relaxed_response() * self.weights
        self.count = measured.size

    def responses(self, times: Array) -> tuple[Array, Array]:
        """Relative responses of unit branches, shape (N, n), and their derivatives by the log of the time."""
        values, slopes = self.data.responses(times)
        return values * self.weights[:, None], slopes * self.weights[:, None]

    def least_squares(self, times: Array, origin: NDArray[np.int64] | None = None) -> PronySeries:
        """The non-negative moduli of branches with these times that meet the data best."""
        from scipy.optimize import nnls

        columns, target = self.responses(times)[0], np.ones(self.count)
        if self.known is None:
            columns = np.column_stack([self.constant, columns])
        else:
            target = target - self.known / self.unit * self.constant
        lengths = np.linalg.norm(columns, axis=0)
        lengths[lengths == 0.0] = 1.0
        # the triangular factor states the same problem in fewer rows
        factor = np.asarray(np.linalg.qr(np.column_stack([columns / lengths, target]), mode="r"))
        try:  # without columns SciPy 1.17 writes beyond its arrays
            scaled = (
                nnls(factor[:, :-1], factor[:, -1], maxiter=100 * lengths.size)[0]
                if lengths.size
                else lengths
            )
        except RuntimeError:
            raise SceneError("", "the fit did not converge", "data that a Prony series can meet") from None
        solution = scaled / lengths
        relaxed = float(solution[0]) * self.unit if self.known is None else self.known
        moduli = solution[solution.size - times.size :] * self.unit
        numbers = np.arange(times.size) if origin is None else origin
        series = PronySeries(relaxed, times, moduli, 0.0, numbers)
        return PronySeries(relaxed, times, moduli, root_mean_square(self.residuals(series)), numbers)

    def residuals(self, series: PronySeries) -> Array:
        """``fit/measured - 1``."""
        response = self.responses(series.times)[0] @ (series.moduli / self.unit)
        return response + series.relaxed / self.unit * self.constant - 1.0

    def refined(self, series: PronySeries, evaluations: int = REFINEMENTS) -> PronySeries:
        """Times and moduli near those given that meet the data best; zero moduli are left out."""
        from scipy.optimize import least_squares

        series = self.least_squares(series.times, series.origin)
        series = series.without(series.moduli == 0.0)
        count, free = series.times.size, int(self.known is None and series.relaxed > 0.0)
        if count == 0:
            return series
        unknown = np.log(np.concatenate([series.times, series.moduli, [series.relaxed] * free]))
        low, high = np.full(unknown.size, -np.inf), np.full(unknown.size, np.inf)
        low[:count], high[:count] = self.window
        unknown = np.clip(unknown, low, high)  # to the last digit

        def unpacked(logs: Array) -> PronySeries:
            # beyond these nothing changes, and exp would overflow
            values = np.exp(np.clip(logs, math.log(SMALLEST), math.log(LARGEST)))
            relaxed = float(values[-1]) if free else series.relaxed
            return PronySeries(relaxed, values[:count], values[count : 2 * count], 0.0, series.origin)

        def jacobian(logs: Array) -> Array:
            at = unpacked(logs)
            values, slopes = self.responses(at.times)
            moduli = at.moduli / self.unit
            parts = [slopes * moduli, values * moduli, self.constant[:, None] * (at.relaxed / self.unit)]
            return np.concatenate(parts[: 2 + free], axis=1)

        found = least_squares(
            lambda logs: self.residuals(unpacked(logs)),
            unknown,
            jacobian,
            bounds=(low, high),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=evaluations,
        )
        better = self.least_squares(unpacked(found.x).times, series.origin)
        better = better.without(better.moduli == 0.0)
        return better if better.misfit < series.misfit else series

    def without_least(self, series: PronySeries) -> PronySeries:
        """The series without the branch that it misses least."""
        shorter = [
            self.least_squares(np.delete(series.times, k), np.delete(series.origin, k))
            for k in range(series.times.size)
        ]
        return min(shorter, key=lambda one: one.misfit)

    def prefers(self, shorter: PronySeries, longer: PronySeries, tolerance: float) -> bool:
        """Whether the shorter series is taken: its misfit is tolerated, or better by Schwarz' criterion."""
        if shorter.misfit <= tolerance:
            return True
        if longer.misfit <= tolerance:
            return False
        parameters = 2 * (longer.times.size - shorter.times.size)
        parameters += int(longer.relaxed > 0.0) - int(shorter.relaxed > 0.0)
        change = 2.0 * self.count * math.log(shorter.misfit / longer.misfit)
        return change <= parameters * math.log(self.count)


@dataclass(frozen=True)
class DroppedBranch:
    """A branch left out by pruning, and the misfit with it and without it."""

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
    used, joined : int
        How many of them non-negative least squares took, and branches left when neighbours were joined.
    dropped : tuple of DroppedBranch
        In the order in which they were dropped.
    unknowns : int
        Numbers that were fitted: two a branch, and the relaxed modulus where it was not given.
    """

    data: RelaxationData | DynamicData
    modulus: float
    branches: tuple[Branch, ...]
    residuals: Array
    grid: Array
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
    """A material from a series; shear moduli become Young's, ``E = 2 (1 + nu) G``."""
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
        At least 3 rows, at most 20,000.
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


def _grid(data: MeasuredModuli) -> Array:
    """Times within the window of the data: half a decade beyond its first and its last point.

    There the fastest still shows 4 % of its modulus, and the slowest has lost 27 % of it.
    """
    first, last = data.window()
    first, last = max(first / math.sqrt(10.0), SMALLEST), min(last * math.sqrt(10.0), LARGEST)
    count = max(2, math.ceil(PER_DECADE * math.log10(last / first)) + 1)
    return np.clip(np.geomspace(first, last, count), first, last)


def _joined(series: PronySeries, grid: Array) -> PronySeries:
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


def root_mean_square(residuals: Array) -> float:
    """Of relative residuals, shape (N,)."""
    return float(np.sqrt(np.mean(residuals**2)))
