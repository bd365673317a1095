"""Step-size control: rates from accepted steps, the step to try, departure from straight lines.

Steps adapt to how far edge and load depart from straight lines within them, and to a limit on the travel of
the edge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

_SAFETY = 0.9
"""Share of the step that the error model predicts to just meet the tolerance."""
_LARGEST_REDUCTION, _LARGEST_GROWTH = 0.2, 2.0
"""Bounds on the ratio of successive steps."""
_SLIVER = 1e-9
"""Part of a step by which it may differ from another by rounding, and still is as long."""
_MEMORY = 64
"""Accepted states that rates may reach back over."""


@dataclass
class AcceptedSteps:
    """Accepted states of an interval: parameter, edge, and the load (force or penetration, the free one)."""

    rows: list[tuple[float, float, float]] = field(default_factory=list)

    def add(self, parameter: float, edge: float, load: float) -> None:
        """Add an accepted state.

        Parameters
        ----------
        parameter : float
            Of the loading interval.
        edge : float
            Contact radius.
        load : float
            Force or penetration, the free one.
        """
        self.rows.append((parameter, edge, load))
        del self.rows[:-_MEMORY]

    def start(self, parameter: float, edge: float, load: float) -> None:
        """Begin after a kink or an instability, before which rates mean nothing.

        Parameters
        ----------
        parameter : float
            Of the loading interval.
        edge : float
            Contact radius.
        load : float
            Force or penetration, the free one.
        """
        self.rows = [(parameter, edge, load)]

    def continue_in_next_interval(self) -> None:
        """Count parameters from the last accepted state."""
        self.rows = [(row[0] - self.rows[-1][0], row[1], row[2]) for row in self.rows]

    @property
    def curved(self) -> bool:
        """Whether there are rows enough for a parabola."""
        return len(self.rows) > 2

    def rates(self, step: float) -> tuple[float, float]:
        """Rates of edge and load over the accepted steps, as far back as ``step`` is long.

        A shorter interval would magnify the small unevenness with which the edge passes the annuli.
        """
        if len(self.rows) < 2:
            return 0.0, 0.0
        now, least = self.rows[-1], (1.0 - _SLIVER) * step
        base = next((row for row in reversed(self.rows[:-1]) if now[0] - row[0] >= least), self.rows[0])
        span = now[0] - base[0]
        return (now[1] - base[1]) / span, (now[2] - base[2]) / span

    def edge_after(self, step: float) -> float:
        """Edge a step ahead, extrapolated by the parabola through the last three states."""
        if len(self.rows) < 3:
            return self.rows[-1][1] + self.rates(step)[0] * step
        (t0, a0, _), (t1, a1, _), (t2, a2, _) = self.rows[-3:]
        late, early = (a2 - a1) / (t2 - t1), (a1 - a0) / (t1 - t0)
        return a2 + step * (late + (t2 - t1 + step) * (late - early) / (t2 - t0))

    def until_load_turns(self) -> float:
        """Distance from the last state to where the parabola through the last three states of the load turns.

        Negative if it has turned, infinite if it does not.
        """
        if len(self.rows) < 3:
            return math.inf
        (t0, _, f0), (t1, _, f1), (t2, _, f2) = self.rows[-3:]
        late, early = (f2 - f1) / (t2 - t1), (f1 - f0) / (t1 - t0)
        if late == early:
            return math.inf
        return -0.5 * (late * (t2 - t0) / (late - early) + t2 - t1)


def departure_from_line(extrapolation_error: float, scale: float) -> float:
    """Departure from a straight line in the middle of a step, relative to ``scale``.

    An eighth of the error of extrapolating the line to the end of the step.
    """
    return 0.125 * abs(extrapolation_error) / scale if scale > 0.0 else 0.0


def grown(step: float, error: float) -> float:
    """Next step after one accepted with ``error`` (in tolerances; second order)."""
    return step * max(
        _LARGEST_REDUCTION, min(_LARGEST_GROWTH, _SAFETY / error**0.5 if error > 0.0 else _LARGEST_GROWTH)
    )


def shrunk(step: float, error: float) -> float:
    """Next trial after one rejected with ``error`` > 1."""
    return step * max(_LARGEST_REDUCTION, _SAFETY / error**0.5)
