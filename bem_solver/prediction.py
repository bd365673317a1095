"""What the next step is predicted from, and how far a step departs from a straight line."""

from __future__ import annotations

from dataclasses import dataclass, field

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 2.0


@dataclass
class Past:
    """Edge and load (force or penetration, whichever is free) at the accepted parameters of a piece."""

    rows: list[tuple[float, float, float]] = field(default_factory=list)

    def add(self, parameter: float, edge: float, load: float) -> None:
        """One accepted state."""
        self.rows.append((parameter, edge, load))
        del self.rows[:-64]

    def rates(self, step: float) -> tuple[float, float]:
        """Rates of edge and load over a past stretch no shorter than ``step``, where there is one.

        A shorter one would magnify the small unevenness with which the edge passes the annuli.
        """
        if len(self.rows) < 2:
            return 0.0, 0.0
        now = self.rows[-1]
        base = next((row for row in reversed(self.rows[:-1]) if now[0] - row[0] >= step), self.rows[0])
        span = now[0] - base[0]
        return (now[1] - base[1]) / span, (now[2] - base[2]) / span

    def edge_after(self, step: float) -> float:
        """Edge a step ahead by the parabola through the last three states: where its search starts."""
        if len(self.rows) < 3:
            return self.rows[-1][1] + self.rates(step)[0] * step
        (t0, a0, _), (t1, a1, _), (t2, a2, _) = self.rows[-3:]
        late, early = (a2 - a1) / (t2 - t1), (a1 - a0) / (t1 - t0)
        return a2 + step * (late + (t2 - t1 + step) * (late - early) / (t2 - t0))


def departure(miss: float, scale: float) -> float:
    """Departure from a straight line in the middle of a step, relative to ``scale``.

    An eighth of ``miss``, the error of extrapolating the line to the end of the step.
    """
    return 0.125 * abs(miss) / scale if scale > 0.0 else 0.0


def grown(step: float, error: float) -> float:
    """Next step after one accepted with ``error`` (in tolerances; second order)."""
    return step * max(_SHRINK, min(_GROW, _SAFETY / error**0.5 if error > 0.0 else _GROW))


def shrunk(step: float, error: float) -> float:
    """Next trial after one rejected with ``error`` > 1."""
    return step * max(_SHRINK, _SAFETY / error**0.5)
