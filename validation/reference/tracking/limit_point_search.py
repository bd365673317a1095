"""The limit point of a trial step: where the time at which the edge arrives, over the radius, has a maximum.

In time the edge passes into a limit point with infinite speed. Over the radius nothing is singular there: the
time of arrival is a smooth function with a maximum, whose place follows from the polynomial through the last
rows and is corrected by the times of arrival at the places it shows.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial import Polynomial

from validation.reference.tracking.root import rising_root
from validation.reference.tracking.rounding import rounded_length
from validation.reference.tracking.trial import Trial

MOST_POINTS = 4
"""Points of the polynomial: a cubic, as the extrapolation of the rows."""
MOST_CORRECTIONS = 24
"""Places looked at before the search is given up; four are usual."""

Point = tuple[float, float]
"""Distance from the present radius, and duration until the edge arrives there; before, both of other sign."""


def expected_limit_point(points: list[Point], low: float, high: float) -> Point | None:
    """Maximum of the duration over the distance, by the polynomial through the first four points.

    Parameters
    ----------
    points : list of (float, float)
        Distances and durations, those to be trusted most first.
    low, high : float
        Distances between which it is looked for.

    Returns
    -------
    tuple of float or None
        ``None`` if the polynomial has no maximum there.
    """
    near = points[:MOST_POINTS]
    unit = max((abs(distance) for distance, _ in near), default=0.0)
    if len(near) < 3 or unit == 0.0:
        return None
    shares = np.array([distance / unit for distance, _ in near])
    durations = np.array([duration for _, duration in near])
    curve = Polynomial(np.linalg.solve(np.vander(shares, increasing=True), durations))
    bend = curve.deriv(2)
    for root in curve.deriv().roots():
        share = float(np.real(root))
        if np.isreal(root) and bend(share) < 0.0 and min(low, high) < unit * share < max(low, high):
            return unit * share, float(curve(share))
    return None


@dataclass
class LimitPointSearch:
    """Search for a limit point on the way of an edge, within a duration.

    Attributes
    ----------
    trial : Trial
        Trial step.
    points : list of (float, float)
        Distances and durations of the last rows, the present one, ``(0, 0)``, among them, and of the places
        looked at.
    reach : float
        Signed distance up to which to search.
    longest : float
        Longest duration.
    """

    trial: Trial
    points: list[Point]
    reach: float
    longest: float
    _rise: float = field(default=0.0, init=False)
    _known: dict[Point, float] = field(default_factory=dict, init=False)

    def find(self, nearest: float, close: float) -> Point | None:
        """Distance and duration of the limit point.

        Parameters
        ----------
        nearest : float
            Distance below which it is not looked for.
        close : float
            Distance of two places below which they are one; the error of the duration goes as its square.

        Returns
        -------
        tuple of float or None
            ``None`` if there is none, or the search fails.
        """
        low, high, best = 0.0, self.reach, (0.0, 0.0)
        for _ in range(MOST_CORRECTIONS):
            if abs(high) <= nearest:
                return None
            self.points.sort(key=lambda point: abs(point[0] - best[0]))
            expected = expected_limit_point(self.points, low, high)
            wider = low if abs(best[0] - low) > abs(high - best[0]) else high
            place, guess = expected or (0.5 * (best[0] + wider), 0.0)
            place = rounded_length(place, nearest)
            if place in (low, high):
                return None
            if best[1] > 0.0 and abs(place - best[0]) <= close:
                return best
            duration = self._arrival(place, guess or best[1])
            if duration is None:
                high = place
                continue
            if duration >= self.longest:
                return None
            self.points.append((place, duration))
            beyond = abs(place) > abs(best[0])
            if duration > best[1]:
                low, high = (best[0], high) if beyond else (low, best[0])
                best = place, duration
            else:
                low, high = (low, place) if beyond else (place, high)
        return None

    def _driving(self, duration: float, place: float) -> float:
        """Residual with the sign that rises with the duration."""
        at = (place, duration)
        if at not in self._known:
            residual = self.trial.residual(duration, self.trial.surface.radius + place)
            self._known[at] = residual if self.reach < 0.0 else -residual
        return self._known[at]

    def _arrival(self, place: float, guess: float) -> float | None:
        """Duration after which the edge arrives; ``None`` if it would be beyond at once."""
        if 0.0 < guess < self.longest:
            found = rising_root(
                lambda duration: self._driving(duration, place),
                guess,
                0.1 * guess,
                self._rise,
                (0.0, self.longest),
                self.trial.condition.tolerance,
            )
            if found is not None:
                duration, self._rise = found
                return duration
        return self.trial.duration_to_radius(self.trial.surface.radius + place, self.longest)
