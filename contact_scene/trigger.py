"""Triggers: a load step ends where the force, the contact radius or the penetration reaches a level.

A test approaches until a force is reached, not to a depth. Where the level is reached, a solver finds in its
own way; here is which quantity it is, and from which side it is approached.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from contact_scene.trace import Outcome, OutcomeKind
from contact_scene.value_checks import finite

Quantity = Literal["force", "radius", "penetration"]

AT_LEVEL = 1e-9
"""Distance from a level, relative to it, below which a state is there: rounding of a step before."""


@dataclass(frozen=True)
class Trigger:
    """A load step ends where ``quantity`` reaches ``level``, from whichever side it begins."""

    quantity: Quantity
    level: float

    def excess(self, penetration: float, force: float, radius: float) -> float:
        """Distance beyond the level.

        Parameters
        ----------
        penetration, force, radius : float
            Of the contact.

        Returns
        -------
        float
            Of the quantity the level belongs to.
        """
        return {"force": force, "radius": radius, "penetration": penetration}[self.quantity] - self.level

    def side(self, excess: float) -> float:
        """Side of the level on which a state is, 1 or -1; 0 if it is there but for rounding."""
        return 0.0 if abs(excess) <= AT_LEVEL * abs(self.level) else math.copysign(1.0, excess)

    def not_reached(self, time: float) -> Outcome:
        """The outcome of a run whose load step has ended without it."""
        reason = f"the load step ended before the {self.quantity} was {self.level:.6g}"
        return Outcome(OutcomeKind.TRIGGER_NOT_REACHED, reason, time)


def passed(side: float, excess: float) -> bool:
    """Whether a level approached from ``side`` (0: it is there) is reached."""
    return side * excess <= 0.0


def level(value: Any, key: str, check: Callable[[Any, str], float] = finite) -> float | None:
    """A checked level; ``None`` where none is given."""
    return None if value is None else check(value, key)
