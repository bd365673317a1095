"""Kinds of load steps: ramps, holds, forces, oscillations, tables.

Penetration ``D`` is positive downwards, force ``F`` positive in compression. A step is turned into a
:class:`Segment` once the state it starts from is known (a ramp after a force step starts where that ended).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from contact_scene.errors import SceneError
from contact_scene.segment import Segment, Step, straight
from contact_scene.table import Table
from contact_scene.trigger import Trigger, level
from contact_scene.value_checks import finite, not_negative, positive


@dataclass(frozen=True)
class Ramp(Step):
    """Penetration goes linearly to ``to`` at speed ``rate`` > 0; ends early at detachment.

    With ``until_force`` or ``until_radius`` the step ends where the force, or the contact radius, reaches
    that level; a run that gets to ``to`` without it ends there, and says so.
    """

    to: float
    rate: float
    until_force: float | None = None
    until_radius: float | None = None
    kind: ClassVar[str] = "ramp"

    def __post_init__(self) -> None:
        object.__setattr__(self, "to", finite(self.to, "to"))
        object.__setattr__(self, "rate", positive(self.rate, "rate"))
        object.__setattr__(self, "until_force", level(self.until_force, "until_force"))
        object.__setattr__(self, "until_radius", level(self.until_radius, "until_radius", positive))
        if self.until_force is not None and self.until_radius is not None:
            raise SceneError("until_radius", "given beside until_force", "one of the two")

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``to``."""
        if self.until_radius is not None:
            return Trigger("radius", self.until_radius)
        return None if self.until_force is None else Trigger("force", self.until_force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """A straight line from the penetration to ``to``.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        end = time + abs(self.to - penetration) / self.rate
        return replace(straight("penetration", time, end, penetration, self.to), trigger=self.trigger)


@dataclass(frozen=True)
class Hold(Step):
    """Penetration stays for ``duration`` >= 0, or until the force has come to ``until_force`` before."""

    duration: float
    until_force: float | None = None
    kind: ClassVar[str] = "hold"

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", not_negative(self.duration, "duration"))
        object.__setattr__(self, "until_force", level(self.until_force, "until_force"))

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``duration`` is over."""
        return None if self.until_force is None else Trigger("force", self.until_force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The penetration, held.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        held = straight("penetration", time, time + self.duration, penetration, penetration)
        return replace(held, trigger=self.trigger)


@dataclass(frozen=True)
class Force(Step):
    """Force steps to ``value`` (compressive positive) and stays for ``duration``; penetration is free.

    With ``until_penetration`` it stays until the indenter has come to that penetration before. The step to
    ``value`` comes first, whole: a penetration that it passes ends the load step right after it.
    """

    value: float
    duration: float
    until_penetration: float | None = None
    kind: ClassVar[str] = "force"

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", finite(self.value, "value"))
        object.__setattr__(self, "duration", not_negative(self.duration, "duration"))
        object.__setattr__(self, "until_penetration", level(self.until_penetration, "until_penetration"))

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``duration`` is over."""
        return None if self.until_penetration is None else Trigger("penetration", self.until_penetration)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The force, constant.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        constant = straight("force", time, time + self.duration, self.value, self.value)
        return replace(constant, trigger=self.trigger)


@dataclass(frozen=True)
class ForceRamp(Step):
    """Force goes linearly to ``to`` at ``rate`` > 0 (force per time); penetration is free."""

    to: float
    rate: float
    kind: ClassVar[str] = "force-ramp"

    def __post_init__(self) -> None:
        object.__setattr__(self, "to", finite(self.to, "to"))
        object.__setattr__(self, "rate", positive(self.rate, "rate"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """A straight line from the force to ``to``.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        return straight("force", time, time + abs(self.to - force) / self.rate, force, self.to)


@dataclass(frozen=True)
class Oscillate(Step):
    """``D = D_start + amplitude sin(w t) - drift t``, t from the start of the step."""

    amplitude: float
    angular_frequency: float
    duration: float
    drift: float = 0.0
    kind: ClassVar[str] = "oscillate"

    def __post_init__(self) -> None:
        object.__setattr__(self, "amplitude", finite(self.amplitude, "amplitude"))
        object.__setattr__(self, "angular_frequency", positive(self.angular_frequency, "angular_frequency"))
        object.__setattr__(self, "duration", positive(self.duration, "duration"))
        object.__setattr__(self, "drift", finite(self.drift, "drift"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """A sine about a drifting penetration.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """
        w = self.angular_frequency

        def value(at: float) -> float:
            t = at - time
            return penetration + self.amplitude * math.sin(w * t) - self.drift * t

        def rate(at: float) -> float:
            return self.amplitude * w * math.cos(w * (at - time)) - self.drift

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)


@dataclass(frozen=True)
class Sweep(Step):
    """``D = D_start + amplitude sin(chirp t^2/2)``: angular frequency ``chirp t`` (paper, Fig. 6)."""

    amplitude: float
    chirp: float
    duration: float
    kind: ClassVar[str] = "sweep"

    def __post_init__(self) -> None:
        object.__setattr__(self, "amplitude", finite(self.amplitude, "amplitude"))
        object.__setattr__(self, "chirp", positive(self.chirp, "chirp"))
        object.__setattr__(self, "duration", positive(self.duration, "duration"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """A sine of rising frequency about the penetration.

        Parameters
        ----------
        time, penetration, force
            As of :meth:`contact_scene.segment.Step.segment`.

        Returns
        -------
        Segment
        """

        def value(at: float) -> float:
            return penetration + self.amplitude * math.sin(0.5 * self.chirp * (at - time) ** 2)

        def rate(at: float) -> float:
            t = at - time
            return self.amplitude * self.chirp * t * math.cos(0.5 * self.chirp * t * t)

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)


STEPS: dict[str, type[Step]] = {
    step.kind: step for step in (Ramp, Hold, Force, ForceRamp, Oscillate, Sweep, Table)
}
