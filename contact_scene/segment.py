"""A load step on the time axis: which quantity is prescribed, and how it goes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

from contact_scene.trigger import Trigger

Control = Literal["penetration", "force", "stage"]


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
    """A control law that is linear in time.

    Parameters
    ----------
    control : "penetration", "force" or "stage"
    start, end : float
        Times.
    first, last : float
        Values there.

    Returns
    -------
    Segment
    """
    rate = (last - first) / (end - start) if end > start else 0.0

    def value(time: float) -> float:
        if time >= end:
            return last
        return first + (last - first) * ((time - start) / (end - start))

    return Segment(control, start, end, value, lambda time: rate)


class Step:
    """A load step; each kind defines :meth:`segment`."""

    kind: ClassVar[str]

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before its end."""
        return None

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The control law of this step.

        Parameters
        ----------
        time : float
            At which it starts.
        penetration, force : float
            From which it starts.

        Returns
        -------
        Segment
        """
        raise AssertionError("defined by every kind of step")
