"""Extrapolation of a quantity by the polynomial through its last rows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RowExtrapolation:
    """A quantity at the last rows, newest first; ``times`` count from the newest and are not positive.

    The time itself may be the quantity; ``times`` are then distances in radius, of one sign.
    """

    times: tuple[float, ...] = (0.0,)
    values: tuple[float, ...] = (0.0,)

    def value_after(self, duration: float) -> float:
        """Value after ``duration``, by the polynomial through all rows (Newton's divided differences)."""
        differences = list(self.values)
        for order in range(1, len(differences)):
            for i in range(len(differences) - 1, order - 1, -1):
                gap = self.times[i] - self.times[i - order]
                differences[i] = (differences[i] - differences[i - 1]) / gap
        value = differences[-1]
        for time, difference in zip(self.times[-2::-1], differences[-2::-1], strict=True):
            value = difference + value * (duration - time)
        return value

    def over_square(self) -> RowExtrapolation:
        """Quotient by the square of ``times``, of a quantity that is zero and extreme at the newest row."""
        earlier = self.times[1:]
        quotients = tuple(value / time**2 for time, value in zip(earlier, self.values[1:], strict=True))
        return RowExtrapolation(earlier or (0.0,), quotients or (0.0,))

    def curvature(self, duration: float, end: float) -> float:
        """Second derivative in the middle of a step to ``end``, by the polynomial through it and three rows.

        Linear in ``end``; zero where there is only one row, right after a kink.
        """
        if len(self.times) < 2 or duration == 0.0:
            return 0.0
        first, one = self.values[0], self.times[1]
        rise = (end - first) / duration
        behind = (first - self.values[1]) / -one
        bend = (rise - behind) / (duration - one)
        if len(self.times) == 2:
            return 2.0 * bend
        two = self.times[2]
        earlier = (behind - (self.values[1] - self.values[2]) / (one - two)) / -two
        return 2.0 * bend + (bend - earlier) / (duration - two) * (duration - 2.0 * one)
