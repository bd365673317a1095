"""A load step on the time axis: which quantity is prescribed, how it goes, and the level that may end it.

A test approaches until a force is reached, not to a depth. Where the level of a trigger is reached, a solver
finds in its own way; here is which quantity it is, and from which side it is approached.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

from contact_scene.trace import Outcome, OutcomeKind

Control = Literal["penetration", "force", "stage"]
Quantity = Literal["force", "radius", "penetration"]

AT_LEVEL = 1e-9
"""Distance from a level, relative to it, below which a state is there: rounding of a step before."""


@dataclass(frozen=True)
class Trigger:
    """A load step ends where ``quantity`` reaches ``level``, from whichever side it begins."""

    quantity: Quantity
    level: float

    def excess(self, penetration: float, force: float, radius: float) -> float:
        """Distance of a state beyond the level."""
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


@dataclass(frozen=True)
class Segment:
    """One step of the loading on the time axis.

    Parameters
    ----------
    control : "penetration", "force" or "stage"
        Which of them is prescribed.
    start, end : float
        Times; ``end >= start``.
    value, rate : callable(float) -> float
        Prescribed quantity and its time derivative (from the right) at an absolute time within the interval.
    kinks : tuple of float
        Times strictly inside the interval where the rate jumps.
    linear : bool
        Whether ``value`` is linear between kinks.
    compliance : float
        Of the machine, where the stage is prescribed; otherwise 0.
    trigger : Trigger or None
        What ends the step before its ``end``.

    Where ``value(start)`` differs from the state reached before, the load jumps, and the half-space answers
    with its glassy modulus.
    """

    control: Control
    start: float
    end: float
    value: Callable[[float], float]
    rate: Callable[[float], float]
    kinks: tuple[float, ...] = ()
    linear: bool = True
    compliance: float = 0.0
    trigger: Trigger | None = None

    def present(self, penetration: float, force: float) -> float:
        """The prescribed quantity in a state of that penetration and force."""
        if self.control == "force":
            return force
        return penetration + self.compliance * force if self.control == "stage" else penetration


def straight(control: Control, start: float, end: float, first: float, last: float) -> Segment:
    """A control law that is linear in time, from ``first`` at ``start`` to ``last`` at ``end``."""
    rate = (last - first) / (end - start) if end > start else 0.0

    def value(time: float) -> float:
        if time >= end:
            return last
        return first + (last - first) * ((time - start) / (end - start))

    return Segment(control, start, end, value, lambda time: rate)


class Step:
    """A load step; each kind defines :meth:`segment`."""

    kind: ClassVar[str]
    tag = "kind"

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before its end."""
        return None

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The control law of this step, which starts at ``time`` from a penetration and a force."""
        raise AssertionError("defined by every kind of step")

    def largest(self, segment: Segment) -> float:
        """At least the largest value that its control law prescribes."""
        return max(segment.value(segment.start), segment.value(segment.end))

    def cycles_by(self, elapsed: float) -> float:
        """Cycles done when a time has passed since its start, the last not whole; 0 of what is no cycle."""
        return 0.0

    def time_of_cycle(self, number: float) -> float:
        """Time from its start at which a number of cycles is done."""
        raise AssertionError("defined by every kind of step that has cycles")

    def cycle_times(self, elapsed: float) -> tuple[float, ...]:
        """Times from its start at which it has done 0, 1, 2, ... whole cycles, until a time has passed."""
        done = self.cycles_by(elapsed)
        whole = math.floor(done * (1.0 + 1e-12)) if done > 0.0 else -1
        return tuple(self.time_of_cycle(number) for number in range(whole + 1))
