"""What an edge that has turned does where it comes to be one process zone from its turn.

Near a place ``A`` where the edge turned smoothly, ``a = A - k (t - t_A)^2/2``, a point ``y`` was covered for
the time ``2 sqrt(2 (A - y)/k)``: what it keeps of that, ahead of the receding edge, goes as ``sqrt(A - y)``.
The closure integral looks one zone ahead. From ``a = A - da`` on it lacks the part next to ``A``, which is of
the power 3/2 of the distance travelled since, and so is what the radius owes to it. Before, the radius is
smooth in time; afterwards it is a smooth function of ``s``, the root of the time since then, with the former
speed in the term in ``s^2``, none in ``s``, and a new one in ``s^3``. The same happens at ``B + da`` to an
edge that has turned outwards at ``B``. Release times have that term, too, and one zone on the radius gets
another in ``s^5``.

Steps end at these places. From the first on ``(v - p(t))/s^2`` is extrapolated over ``s`` for every quantity
``v``, where ``p`` is the polynomial in time through the rows before; it vanishes at ``s = 0``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.reference.tracking.row_extrapolation import RowExtrapolation


@dataclass(frozen=True)
class RootExtrapolation:
    """A quantity at the rows before and since the edge was one zone from its turn.

    ``before``: rows up to then, with times counted from then. ``since``: time passed at the newest row.
    ``changes``: ``(v - p)/s^2`` over ``s`` at the rows since, newest first, and at ``s = 0``.
    """

    before: RowExtrapolation
    since: float
    changes: RowExtrapolation

    def value_after(self, duration: float) -> float:
        """Value after ``duration``."""
        return self._value(self.changes, self.since + duration)

    def middle(self, duration: float, end: float) -> float:
        """Value at half of ``duration`` if it is ``end`` after all of it."""
        after = self.since + duration
        change = (end - self.before.value_after(after)) / after
        changes = RowExtrapolation((math.sqrt(after), *self.changes.times), (change, *self.changes.values))
        return self._value(changes, self.since + 0.5 * duration)

    def _value(self, changes: RowExtrapolation, after: float) -> float:
        return self.before.value_after(after) + after * changes.value_after(math.sqrt(after))
