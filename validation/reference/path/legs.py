"""Load steps as legs: stretches over which the load is smooth in one parameter.

A jump of the load is a leg of its own. Time stands, and the parameter is the share of the jump. A load step
may end before its legs do, at a level.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from contact_scene import Segment, Trigger
from contact_scene.loading import Control
from validation.reference.path.state import State

SHORTEST = 16.0
"""Leg, in units of the last place of its end, below which it is lost in rounding."""
AT_ONCE = 1e-9
"""Of a leg: what sets the indenter going later finds it at rest."""
AT_LOAD = 1e-12
"""Difference from the load that a leg begins with, relative to it, which is rounding and no jump."""


@dataclass(frozen=True)
class Leg:
    """From parameter ``start`` to ``end``; ``rate``: of a penetration that is linear in time."""

    control: Control
    value: Callable[[float], float]
    start: float
    end: float
    timed: bool
    rate: float | None = None
    compliance: float = 0.0

    @property
    def free(self) -> bool:
        """Whether the penetration follows from the balance of forces."""
        return self.control != "penetration"

    @property
    def presses(self) -> bool:
        """Whether an indenter that is at the surface, and free of load, is pressed on from the start."""
        soon = self.start + AT_ONCE * (self.end - self.start)
        return self.control == "force" or self.value(soon) > 0.0


@dataclass
class Level:
    """The level that ends a load step, and the side of it on which the path is."""

    trigger: Trigger
    side: float

    @classmethod
    def of(cls, trigger: Trigger | None, state: State) -> Level | None:
        """That of a load step which begins at a state."""
        if trigger is None:
            return None
        return cls(trigger, trigger.side(trigger.excess(state.depth, state.force, state.radius)))

    def excess(self, depth: float, force: float, radius: float) -> float:
        """How far beyond the level, seen from the side it is approached from."""
        return -self.side * self.trigger.excess(depth, force, radius)


def jump(segment: Segment, penetration: float, force: float) -> Leg | None:
    """The jump of the load with which a load step begins, if it does."""
    have, first = segment.present(penetration, force), segment.value(segment.start)
    if abs(first - have) <= AT_LOAD * max(abs(have), abs(first)):
        return None

    def value(share: float) -> float:
        return have + (first - have) * share

    return Leg(segment.control, value, 0.0, 1.0, False, None, segment.compliance)


def timed_legs(segment: Segment, tolerance: float) -> Iterator[Leg]:
    """What a load step is made of between its kinks.

    One at which the rate differs by less than the tolerance from that at which the leg began is none.
    """
    marks = sorted({segment.start, *segment.kinks})
    kept = marks[:1]
    for at in marks[1:]:
        before, after = segment.rate(kept[-1]), segment.rate(at)
        if abs(after - before) > tolerance * max(abs(before), abs(after)):
            kept.append(at)
    straight = segment.linear and segment.control == "penetration"
    for begin, end in pairwise((*kept, segment.end)):
        if end - begin >= SHORTEST * math.ulp(end):
            rate = (segment.value(end) - segment.value(begin)) / (end - begin) if straight else None
            yield Leg(segment.control, segment.value, begin, end, True, rate, segment.compliance)
