"""Energy spent in the interface by an edge that takes up another energy on opening than it gives on closing.

On opening the edge takes up ``w`` per area, which follows its speed; on closing it gives ``work_closing``
back. Along a step ``w`` is the mean of its values at the ends, both known from the closure integral there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact_scene import Adhesion


@dataclass
class InterfaceWork:
    """Energy spent so far, and where the edge was at the last row: time, radius, closure integral."""

    spent: float = 0.0
    time: float = 0.0
    radius: float = 0.0
    closure: float = 0.0
    started: bool = False

    def advance(self, adhesion: Adhesion, time: float, radius: float, closure: float) -> None:
        """Go on to the next row.

        Parameters
        ----------
        adhesion : Adhesion
        time, radius : float
            There.
        closure : float
            The closure integral there, 0 without contact.
        """
        if self.started:
            area = math.pi * (self.radius - radius) * (self.radius + radius)
            self.spent += area * (adhesion.closing if area < 0.0 else self._opening(adhesion, time, closure))
        self.time, self.radius, self.closure, self.started = time, radius, closure, True

    def _opening(self, adhesion: Adhesion, time: float, closure: float) -> float:
        """Mean energy per area between the last row and the next."""
        if adhesion.rate is None:
            return adhesion.work
        before = max(self.closure, adhesion.work)
        at_once = adhesion.opening(math.inf)
        if time == self.time:
            return at_once if math.isfinite(at_once) else before
        return 0.5 * (min(before, at_once) + min(max(closure, adhesion.work), at_once))
