"""Least squares of a Prony series with given or refined times: relative responses of unit branches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from contact_scene.measured_moduli import DynamicData, RelaxationData
from contact_scene.value_checks import LARGEST, SMALLEST

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
    times: NDArray[np.float64]
    moduli: NDArray[np.float64]
    misfit: float
    origin: NDArray[np.int64]

    def without(self, gone: NDArray[np.bool_]) -> PronySeries:
        """The same without some branches; its misfit holds if their moduli are zero."""
        return PronySeries(
            self.relaxed, self.times[~gone], self.moduli[~gone], self.misfit, self.origin[~gone]
        )


class SeriesDesign:
    """Relative responses of unit moduli at the points of the data."""

    def __init__(
        self, data: RelaxationData | DynamicData, grid: NDArray[np.float64], relaxed: float | None
    ) -> None:
        at = data.times if isinstance(data, RelaxationData) else data.angular_frequencies
        if not FEWEST_ROWS <= at.size <= MOST_ROWS:
            raise SceneError("", f"{at.size} rows of data", f"{FEWEST_ROWS} to {MOST_ROWS} rows")
        distinct, what = np.unique(at).size, "times" if isinstance(data, RelaxationData) else "frequencies"
        if distinct < FEWEST_ROWS:
            raise SceneError("", f"{at.size} rows at {distinct} {what}", f"{FEWEST_ROWS} {what} or more")
        self.known = relaxed
        self.window = math.log(grid[0]), math.log(grid[-1])
        if isinstance(data, RelaxationData):
            self.dynamic, self.points, self.measured = False, data.times, data.moduli
            constant = np.ones(at.size)
        else:
            self.dynamic, self.points = True, data.angular_frequencies
            self.measured = np.concatenate([data.storage, data.loss])
            constant = np.concatenate([np.ones(at.size), np.zeros(at.size)])
        self.unit = float(np.exp(np.log(self.measured).mean()))  # moduli in this unit are of order one
        self.weights = self.unit / self.measured
        self.constant = constant * self.weights
        self.count = self.measured.size

    def responses(self, times: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Relative responses of unit branches, shape (N, n), and their derivatives by the log of the time."""
        if not self.dynamic:
            ratio = np.minimum(self.points[:, None] / times, 700.0)
            values = np.exp(-ratio) * self.weights[:, None]
            return values, ratio * values
        p = self.points[:, None] * times
        length = np.hypot(1.0, p)
        cosine, sine = 1.0 / length, p / length
        values = np.concatenate([sine**2, sine * cosine]) * self.weights[:, None]
        slopes = np.concatenate([2.0 * (sine * cosine) ** 2, sine * cosine * (cosine**2 - sine**2)])
        return values, slopes * self.weights[:, None]

    def least_squares(
        self, times: NDArray[np.float64], origin: NDArray[np.int64] | None = None
    ) -> PronySeries:
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

    def residuals(self, series: PronySeries) -> NDArray[np.float64]:
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

        def unpacked(logs: NDArray[np.float64]) -> PronySeries:
            # beyond these nothing changes, and exp would overflow
            values = np.exp(np.clip(logs, math.log(SMALLEST), math.log(LARGEST)))
            relaxed = float(values[-1]) if free else series.relaxed
            return PronySeries(relaxed, values[:count], values[count : 2 * count], 0.0, series.origin)

        def jacobian(logs: NDArray[np.float64]) -> NDArray[np.float64]:
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
        """Whether the shorter series is to be taken: within tolerance, or better by Schwarz' criterion.

        Parameters
        ----------
        shorter, longer : PronySeries
        tolerance : float
            Misfit that is allowed.

        Returns
        -------
        bool
        """
        if shorter.misfit <= tolerance:
            return True
        if longer.misfit <= tolerance:
            return False
        parameters = 2 * (longer.times.size - shorter.times.size)
        parameters += int(longer.relaxed > 0.0) - int(shorter.relaxed > 0.0)
        change = 2.0 * self.count * math.log(shorter.misfit / longer.misfit)
        return change <= parameters * math.log(self.count)


def root_mean_square(residuals: NDArray[np.float64]) -> float:
    """Of relative residuals, shape (N,)."""
    return float(np.sqrt(np.mean(residuals**2)))
