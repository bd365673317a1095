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
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from contact_scene.checked import Checked
from contact_scene.errors import SceneError, shown
from contact_scene.material import Branch, Material
from contact_scene.value_checks import (
    LARGEST,
    SMALLEST,
    Column,
    Range,
    number,
    of_class,
    positive,
    true_or_false,
)

Array = NDArray[np.float64]
Moduli = Annotated[Array, Column("numbers > 0, one a row", Range(positive.words, SMALLEST))]

PER_DECADE = 10
"""Grid times a decade: neighbours differ by a quarter, so refinement starts within an eighth of any time."""
TOLERANCE = 1e-3
"""Default root mean square of the relative residuals below which branches are dropped: what the solvers are
checked to, and finer than a rheometer is calibrated."""
ROUNDING = 1e-6
"""Root mean square of the relative residuals below which a series without relaxed modulus meets the data
exactly: the digits that instruments write."""
FEWEST_ROWS, MOST_ROWS = 3, 20_000
"""Rows of measured data, at different times or frequencies: fewer determine no branch beside a relaxed
modulus, and the design matrix of more would not fit into memory comfortably."""
REFINEMENTS, LAST_REFINEMENTS = 12, 100
"""Evaluations of a refinement while branches are dropped, which starts near its end, and of the last one."""


class MeasuredModuli(Checked, ABC):
    """What both kinds of data have in common: columns of numbers > 0, the first of them ascending."""

    columns: ClassVar[tuple[str, ...]]
    over: ClassVar[str]
    shear: bool
    units: tuple[str, ...]

    def rules(self) -> None:
        if len(self.units) != 2:
            raise SceneError("units", f"got {shown(self.units)}", "two strings: units of time and of stress")
        for name in self.columns:
            values = getattr(self, name)
            if values.size == 0 or values.shape != self.points.shape:
                raise SceneError(name, f"shape {values.shape}", "as many numbers as in the other columns")
            values.flags.writeable = False
        if np.any(np.diff(self.points) < 0.0):
            raise SceneError(self.columns[0], "decreases", "ascending values")

    @property
    def points(self) -> Array:
        """Times or angular frequencies of the rows, shape (n,)."""
        points: Array = getattr(self, self.columns[0])
        return points

    @property
    def measured(self) -> Array:
        """All moduli, one column after the other."""
        return np.concatenate([getattr(self, name) for name in self.columns[1:]])

    @abstractmethod
    def window(self) -> tuple[float, float]:
        """Shortest and longest time that the rows tell of."""

    @abstractmethod
    def responses(self, times: Array) -> tuple[Array, Array, Array]:
        """What was measured of a relaxed modulus of 1; of branches of modulus 1, a column each; and the
        derivative of these by the log time."""


@dataclass(frozen=True)
class RelaxationData(MeasuredModuli):
    """Measured relaxation modulus.

    Parameters
    ----------
    times : ndarray, shape (n,)
        > 0, ascending; the moment of the strain step is 0.
    moduli : ndarray, shape (n,)
        Relaxation modulus at these, > 0.
    shear : bool
        Whether they are shear moduli.
    units : pair of str
        Of time and stress, for labels; "" where the file names none.

    Examples
    --------
    >>> times = np.logspace(-2, 2, 30)
    >>> data = cc.RelaxationData(times, 1.0 + 9.0 * np.exp(-times))
    >>> f"{cc.fit_prony(data).branches[0].time:.4f}"
    '1.0000'
    """

    columns = ("times", "moduli")
    over = "times"
    times: Moduli
    moduli: Moduli
    shear: Annotated[bool, true_or_false] = False
    units: tuple[str, ...] = ("", "")

    def window(self) -> tuple[float, float]:
        return float(self.times[0]), float(self.times[-1])

    def responses(self, times: Array) -> tuple[Array, Array, Array]:
        ratio = np.minimum(self.times[:, None] / times, 700.0)
        values = np.exp(-ratio)
        return np.ones(self.times.size), values, ratio * values


@dataclass(frozen=True)
class DynamicData(MeasuredModuli):
    """Measured storage and loss modulus.

    Parameters
    ----------
    angular_frequencies : ndarray, shape (n,)
        > 0, ascending, radians per unit time.
    storage, loss : ndarray, shape (n,)
        > 0.
    shear, units
        As of :class:`RelaxationData`.

    Examples
    --------
    >>> w = np.logspace(-2, 2, 30)
    >>> storage, loss = 1.0 + 9.0 * w**2 / (1.0 + w**2), 9.0 * w / (1.0 + w**2)
    >>> [f"{branch.time:.3f}" for branch in cc.fit_prony(cc.DynamicData(w, storage, loss)).branches]
    ['1.000']
    """

    columns = ("angular_frequencies", "storage", "loss")
    over = "frequencies"
    angular_frequencies: Moduli
    storage: Moduli
    loss: Moduli
    shear: Annotated[bool, true_or_false] = False
    units: tuple[str, ...] = ("", "")

    def window(self) -> tuple[float, float]:
        return 1.0 / float(self.angular_frequencies[-1]), 1.0 / float(self.angular_frequencies[0])

    def responses(self, times: Array) -> tuple[Array, Array, Array]:
        phase = self.angular_frequencies[:, None] * times
        length = np.hypot(1.0, phase)
        cosine, sine = 1.0 / length, phase / length
        slopes = [2.0 * (sine * cosine) ** 2, sine * cosine * (cosine**2 - sine**2)]
        relaxed = np.repeat([1.0, 0.0], self.storage.size)
        return relaxed, np.concatenate([sine**2, sine * cosine]), np.concatenate(slopes)


@dataclass(frozen=True)
class PronySeries:
    """Relaxed modulus, branches (times and moduli), root mean square of the relative residuals."""

    relaxed: float
    times: Array
    moduli: Array
    misfit: float = math.nan

    @property
    def parameters(self) -> int:
        """Numbers that state it: two a branch, and the relaxed modulus if there is one."""
        return 2 * self.times.size + int(self.relaxed > 0.0)


class SeriesDesign:
    """Relative responses of series at the points of the data; ``relaxed``: the relaxed modulus, if known."""

    def __init__(self, data: MeasuredModuli, relaxed: float | None) -> None:
        rows, distinct = data.points.size, np.unique(data.points).size
        if not FEWEST_ROWS <= rows <= MOST_ROWS:
            raise SceneError("", f"{rows} rows of data", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
        if distinct < FEWEST_ROWS:
            allowed = f"{FEWEST_ROWS} {data.over} or more"
            raise SceneError("", f"{rows} rows at {distinct} {data.over}", allowed)
        self.data, self.known, self.grid = data, relaxed, _grid(data)
        measured = data.measured
        self.unit = float(np.exp(np.log(measured).mean()))  # moduli in this unit are of order one
        self.weights = (self.unit / measured)[:, None]
        self.count = measured.size

    def responses(self, times: Array) -> tuple[Array, Array, Array]:
        """Relative responses of a relaxed modulus of one unit, shape (N, 1), of branches, (N, n), and the
        derivatives of these by the log of the time."""
        relaxed, values, slopes = self.data.responses(times)
        return relaxed[:, None] * self.weights, values * self.weights, slopes * self.weights

    def residuals(self, series: PronySeries) -> Array:
        """``fit/measured - 1``."""
        relaxed, values, _ = self.responses(series.times)
        return values @ (series.moduli / self.unit) + relaxed[:, 0] * (series.relaxed / self.unit) - 1.0

    def least_squares(self, times: Array) -> PronySeries:
        """The branches of these times, with non-negative moduli, that meet the data best."""
        from scipy.optimize import nnls

        constant, columns, _ = self.responses(times)
        target = np.ones(self.count)
        if self.known is None:
            columns = np.hstack([constant, columns])
        else:
            target = target - self.known / self.unit * constant[:, 0]
        lengths = np.linalg.norm(columns, axis=0)
        lengths[lengths == 0.0] = 1.0
        # the triangular factor states the same problem in fewer rows
        factor = np.asarray(np.linalg.qr(np.column_stack([columns / lengths, target]), mode="r"))
        solution = np.zeros(0)
        try:
            if lengths.size:  # without columns SciPy 1.17 writes beyond its arrays
                solution = nnls(factor[:, :-1], factor[:, -1], maxiter=100 * lengths.size)[0] / lengths
        except RuntimeError:
            raise SceneError("", "the fit did not converge", "data that a Prony series can meet") from None
        relaxed = float(solution[0]) * self.unit if self.known is None else self.known
        moduli = solution[solution.size - times.size :] * self.unit
        series = PronySeries(relaxed, times[moduli > 0.0], moduli[moduli > 0.0])
        return replace(series, misfit=root_mean_square(self.residuals(series)))

    def refined(self, times: Array, evaluations: int = REFINEMENTS) -> PronySeries:
        """Times near those given, and moduli, that meet the data best."""
        from scipy.optimize import least_squares

        series = self.least_squares(times)
        count, free = series.times.size, int(self.known is None and series.relaxed > 0.0)
        if count == 0:
            return series
        unknown = np.log(np.concatenate([series.times, series.moduli, [series.relaxed] * free]))
        low, high = np.full(unknown.size, -np.inf), np.full(unknown.size, np.inf)
        low[:count], high[:count] = math.log(self.grid[0]), math.log(self.grid[-1])

        def unpacked(logs: Array) -> PronySeries:
            # beyond these nothing changes, and exp would overflow
            values = np.exp(np.clip(logs, math.log(SMALLEST), math.log(LARGEST)))
            relaxed = float(values[-1]) if free else series.relaxed
            return PronySeries(relaxed, values[:count], values[count : 2 * count])

        def jacobian(logs: Array) -> Array:
            at = unpacked(logs)
            constant, values, slopes = self.responses(at.times)
            moduli = at.moduli / self.unit
            parts = [slopes * moduli, values * moduli, constant * (at.relaxed / self.unit)]
            return np.concatenate(parts[: 2 + free], axis=1)

        found = least_squares(
            lambda logs: self.residuals(unpacked(logs)),
            np.clip(unknown, low, high),  # to the last digit
            jacobian,
            bounds=(low, high),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=evaluations,
        )
        return min(series, self.least_squares(unpacked(found.x).times), key=lambda one: one.misfit)

    def without_least(self, series: PronySeries) -> tuple[int, PronySeries]:
        """The branch that the series misses least, and what is best without it."""
        shorter = [self.least_squares(np.delete(series.times, k)) for k in range(series.times.size)]
        least = min(range(len(shorter)), key=lambda k: shorter[k].misfit)
        return least, self.refined(shorter[least].times)

    def prefers(self, shorter: PronySeries, longer: PronySeries, tolerance: float) -> bool:
        """Whether the shorter series is taken: its misfit is tolerated, or better by Schwarz' criterion."""
        if shorter.misfit <= tolerance or longer.misfit <= tolerance:
            return shorter.misfit <= tolerance
        change = 2.0 * self.count * math.log(shorter.misfit / longer.misfit)
        return change <= (longer.parameters - shorter.parameters) * math.log(self.count)


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

    Examples
    --------
    >>> times = np.logspace(-2, 2, 30)
    >>> data = cc.RelaxationData(times, 1.0 + 9.0 * np.exp(-times))
    >>> fitted = cc.fit_prony(data)
    >>> fitted.misfit < 1e-3, fitted.material(poisson=0.5).glassy_modulus < 10.1
    (True, True)
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

    def __str__(self) -> str:
        kind = "shear modulus" if self.data.shear else "Young's modulus"
        rows = [("relaxed", self.modulus), *((f"{one.time:.4g}", one.modulus) for one in self.branches)]
        table = [f"{time:>12}  {modulus:.6g}" for time, modulus in rows]
        return "\n".join([f"{'time':>12}  {kind}", *table, f"{'misfit':>12}  {self.misfit:.1e}"])

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

    Examples
    --------
    >>> times = np.logspace(-2, 2, 30)
    >>> data = cc.RelaxationData(times, np.round(1.0 + 9.0 * np.exp(-times), 3))
    >>> print(cc.fit_prony(data))
            time  Young's modulus
         relaxed  0.999922
               1  9.00008
          misfit  1.0e-04
    """
    measured = "RelaxationData or DynamicData, as read_measured reads them from a file"
    of_class(data, "data", (RelaxationData, DynamicData), measured)
    number(tolerance, "tolerance", "0 <= tolerance <= 1", low=0.0, high=1.0)
    known = None if relaxed is None else positive(relaxed, "modulus")
    design = SeriesDesign(data, known)
    start = design.least_squares(design.grid)
    used = start.times.size
    series = design.refined(_joined(start, design.grid))
    joined = series.times.size
    if series.misfit > tolerance:  # a continuous spectrum, say, needs more
        unjoined = design.refined(start.times)
        if not design.prefers(series, unjoined, tolerance):
            series, joined = unjoined, used
    dropped = []
    while series.times.size:
        least, shorter = design.without_least(series)
        if not design.prefers(shorter, series, tolerance):
            break
        gone = Branch(float(series.moduli[least]), float(series.times[least]))
        dropped.append(DroppedBranch(gone, series.misfit, shorter.misfit))
        series = shorter
    if relaxed is None and series.relaxed > 0.0:
        melt = SeriesDesign(data, 0.0).refined(series.times)
        if design.prefers(melt, series, ROUNDING):
            series = melt
    last = design if series.relaxed > 0.0 else SeriesDesign(data, 0.0)
    series = last.refined(series.times, LAST_REFINEMENTS)
    order = np.argsort(series.times)
    branches = tuple(Branch(float(series.moduli[k]), float(series.times[k])) for k in order)
    unknowns = series.parameters - int(relaxed is not None)
    residuals = design.residuals(series)
    return PronyFit(
        data, series.relaxed, branches, residuals, design.grid, used, joined, tuple(dropped), unknowns
    )


def _grid(data: MeasuredModuli) -> Array:
    """Times within the window of the data: half a decade beyond its first and its last point.

    There the fastest still shows 4 % of its modulus, and the slowest has lost 27 % of it.
    """
    first, last = data.window()
    first, last = max(first / math.sqrt(10.0), SMALLEST), min(last * math.sqrt(10.0), LARGEST)
    count = max(2, math.ceil(PER_DECADE * math.log10(last / first)) + 1)
    return np.clip(np.geomspace(first, last, count), first, last)


def _joined(series: PronySeries, grid: Array) -> Array:
    """Times of one branch for each run of neighbours on the grid: their mean log weighted by modulus."""
    used = np.searchsorted(grid, series.times)
    runs = np.split(np.arange(used.size), np.flatnonzero(np.diff(used) > 1) + 1) if used.size else []
    logs = np.log(series.times)
    means = [np.average(logs[run], weights=series.moduli[run] / series.moduli[run].sum()) for run in runs]
    return np.exp(np.array(means, float))


def root_mean_square(residuals: Array) -> float:
    """Of relative residuals, shape (N,)."""
    return float(np.sqrt(np.mean(residuals**2)))
