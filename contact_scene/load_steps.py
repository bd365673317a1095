"""Kinds of load steps: ramps, holds, forces, oscillations, tables, and the usual test in one entry.

Penetration ``D`` is positive downwards, force ``F`` positive in compression. A step is turned into a
:class:`Segment` once the state it starts from is known (a ramp after a force step starts where that ended).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from contact_scene.checked import Checked, Finite, Key, Kinds, NotNegative, Positive, Tabulated
from contact_scene.errors import SceneError
from contact_scene.segment import Segment, Step, Trigger, straight


@dataclass(frozen=True)
class Ramp(Step, Checked):
    """Penetration goes linearly to ``to`` at speed ``rate`` > 0; ends early at detachment.

    With ``until_force`` or ``until_radius`` the step ends where the force, or the contact radius, reaches
    that level; a run that gets to ``to`` without it ends there, and says so.
    """

    to: Annotated[Finite, Key("penetration it goes to", "length")]
    rate: Annotated[Positive, Key("speed", "length time-1")]
    until_force: Annotated[Finite | None, Key("force at which it ends", "force")] = None
    until_radius: Annotated[Positive | None, Key("contact radius at which it ends", "length")] = None
    kind: ClassVar[str] = "ramp"

    def rules(self) -> None:
        if self.until_force is not None and self.until_radius is not None:
            raise SceneError("until_radius", "given beside until_force", "one of the two")

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``to``."""
        if self.until_radius is not None:
            return Trigger("radius", self.until_radius)
        return None if self.until_force is None else Trigger("force", self.until_force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        end = time + abs(self.to - penetration) / self.rate
        return replace(straight("penetration", time, end, penetration, self.to), trigger=self.trigger)


@dataclass(frozen=True)
class Hold(Step, Checked):
    """Penetration stays for ``duration`` >= 0, or until the force has come to ``until_force`` before."""

    duration: Annotated[NotNegative, Key("how long the penetration stays", "time")]
    until_force: Annotated[Finite | None, Key("force at which it ends", "force")] = None
    kind: ClassVar[str] = "hold"

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``duration`` is over."""
        return None if self.until_force is None else Trigger("force", self.until_force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        held = straight("penetration", time, time + self.duration, penetration, penetration)
        return replace(held, trigger=self.trigger)


@dataclass(frozen=True)
class Force(Step, Checked):
    """Force steps to ``value`` (compressive positive) and stays for ``duration``; penetration is free.

    With ``until_penetration`` it stays until the indenter has come to that penetration before. The step to
    ``value`` comes first, whole: a penetration that it passes ends the load step right after it.
    """

    value: Annotated[Finite, Key("force", "force")]
    duration: Annotated[NotNegative, Key("how long the force stays", "time")]
    until_penetration: Annotated[Finite | None, Key("penetration at which it ends", "length")] = None
    kind: ClassVar[str] = "force"

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before ``duration`` is over."""
        return None if self.until_penetration is None else Trigger("penetration", self.until_penetration)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        constant = straight("force", time, time + self.duration, self.value, self.value)
        return replace(constant, trigger=self.trigger)


@dataclass(frozen=True)
class ForceRamp(Step, Checked):
    """Force goes linearly to ``to`` at ``rate`` > 0 (force per time); penetration is free."""

    to: Annotated[Finite, Key("force it goes to", "force")]
    rate: Annotated[Positive, Key("force per time", "force time-1")]
    kind: ClassVar[str] = "force-ramp"

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return straight("force", time, time + abs(self.to - force) / self.rate, force, self.to)


@dataclass(frozen=True)
class Oscillate(Step, Checked):
    """``D = D_start + amplitude sin(w t) - drift t``, t from the start of the step."""

    amplitude: Annotated[Finite, Key("amplitude", "length")]
    angular_frequency: Annotated[Positive, Key("angular frequency", "time-1")]
    duration: Annotated[Positive, Key("how long it goes on", "time")]
    drift: Annotated[Finite, Key("speed of retraction beside it", "length time-1")] = 0.0
    kind: ClassVar[str] = "oscillate"

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        w = self.angular_frequency

        def value(at: float) -> float:
            t = at - time
            return penetration + self.amplitude * math.sin(w * t) - self.drift * t

        def rate(at: float) -> float:
            return self.amplitude * w * math.cos(w * (at - time)) - self.drift

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)

    def largest(self, segment: Segment) -> float:
        sinking = max(-self.drift, 0.0) * self.duration
        return segment.value(segment.start) + abs(self.amplitude) + sinking

    def cycles_by(self, elapsed: float) -> float:
        return self.angular_frequency * min(elapsed, self.duration) / (2.0 * math.pi)

    def time_of_cycle(self, number: float) -> float:
        return number * (2.0 * math.pi / self.angular_frequency)


@dataclass(frozen=True)
class Sweep(Step, Checked):
    """``D = D_start + amplitude sin(chirp t^2/2)``: angular frequency ``chirp t`` (paper, Fig. 6)."""

    amplitude: Annotated[Finite, Key("amplitude", "length")]
    chirp: Annotated[Positive, Key("angular frequency gained per time", "time-2")]
    duration: Annotated[Positive, Key("how long it goes on", "time")]
    kind: ClassVar[str] = "sweep"

    def segment(self, time: float, penetration: float, force: float) -> Segment:

        def value(at: float) -> float:
            return penetration + self.amplitude * math.sin(0.5 * self.chirp * (at - time) ** 2)

        def rate(at: float) -> float:
            t = at - time
            return self.amplitude * self.chirp * t * math.cos(0.5 * self.chirp * t * t)

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)

    def largest(self, segment: Segment) -> float:
        return segment.value(segment.start) + abs(self.amplitude)

    def cycles_by(self, elapsed: float) -> float:
        return self.chirp * min(elapsed, self.duration) ** 2 / (4.0 * math.pi)

    def time_of_cycle(self, number: float) -> float:
        return math.sqrt(4.0 * math.pi * number / self.chirp)


@dataclass(frozen=True)
class Table(Step, Tabulated):
    """``quantity`` by straight lines, or piecewise cubics, through ``(times, values)``: planned, or recorded.

    By straight lines every row is a kink of the load, which a solver steps onto; a record with rows by the
    hundred thousand is read as a smooth curve instead, ``interpolation = "cubic"``: the piecewise cubic of
    F.N. Fritsch and R.E. Carlson, SIAM J. Numer. Anal. 17, 238 (1980), without an extremum between the rows.
    Times count from the first row. If the first value differs from the current one, the load jumps to it.
    A table of penetrations drives the stage where the machine is a spring.
    """

    times: Annotated[tuple[Finite, ...], Key("times, rising", "time")]
    values: Annotated[tuple[Finite, ...], Key("penetrations or forces at these times")]
    file: Annotated[str, Key("CSV file of time and the quantity")] = field(default="", compare=False)
    quantity: Annotated[Literal["penetration", "force"], Key("what the table prescribes")] = "penetration"
    interpolation: Annotated[Literal["linear", "cubic"], Key("lines or smooth pieces between rows")] = (
        "linear"
    )
    kind: ClassVar[str] = "table"
    columns = ("time", "penetration", "force")

    @classmethod
    def column_names(cls, data: dict[str, Any]) -> tuple[str, str]:
        return "time", str(data.get("quantity", "penetration"))

    def rules(self) -> None:
        times, values, name = self.times, self.values, self.quantity
        if len(times) != len(values):
            raise SceneError(name, f"{len(times)} times but {len(values)} {name}s", "one for each")
        if len(times) < 2:
            raise SceneError("time", f"got {len(times)} rows", f"at least 2 rows of time, {name}")
        if not (np.diff(times) > 0.0).all():
            row, (before, after) = next(
                (row, pair) for row, pair in enumerate(pairwise(times), 2) if pair[1] <= pair[0]
            )
            problem = f"does not advance ({before:g} -> {after:g})"
            raise SceneError(f"time, row {row}", problem, "strictly rising times")

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        # Rows that round to the same time after a late start are one row, the last of them.
        rows = dict(zip((time + (t - self.times[0]) for t in self.times), self.values, strict=True))
        at, values = list(rows), list(rows.values())
        if self.interpolation == "cubic" and len(at) > 2 and math.isfinite(time):
            return Segment(self.quantity, time, at[-1], *_cubic(at, values), linear=False)

        def interval(now: float) -> int:
            return min(max(bisect_right(at, now) - 1, 0), len(at) - 2)

        def value(now: float) -> float:
            if len(at) == 1 or now >= at[-1]:
                return values[-1]
            i = interval(now)
            return values[i] + (values[i + 1] - values[i]) * ((now - at[i]) / (at[i + 1] - at[i]))

        def rate(now: float) -> float:
            if len(at) == 1:
                return 0.0
            i = interval(now)
            return (values[i + 1] - values[i]) / (at[i + 1] - at[i])

        return Segment(self.quantity, time, at[-1], value, rate, kinks=tuple(at[1:-1]))

    def largest(self, segment: Segment) -> float:
        return max(self.values)


def _cubic(at: list[float], values: list[float]) -> tuple[Callable[[float], float], Callable[[float], float]]:
    """Value and rate of the piecewise cubic without extrema between the rows."""
    from scipy.interpolate import PchipInterpolator  # heavy, and of use to smooth tables alone

    with np.errstate(over="ignore"):  # between rows that all but agree: the mean of slopes is then zero
        pieces: list[list[float]] = PchipInterpolator(at, values).c.T.tolist()  # highest power first

    def value(now: float) -> float:
        if now >= at[-1]:
            return values[-1]
        i = min(max(bisect_right(at, now) - 1, 0), len(pieces) - 1)
        (a, b, c, d), t = pieces[i], now - at[i]
        return d + t * (c + t * (b + t * a))

    def rate(now: float) -> float:
        i = min(max(bisect_right(at, now) - 1, 0), len(pieces) - 1)
        (a, b, c, _), t = pieces[i], now - at[i]
        return c + t * (2.0 * b + 3.0 * t * a)

    return value, rate


@dataclass(frozen=True)
class Approach(Step, Checked):
    """Approach at ``rate`` until ``force``, stay for ``dwell``, go back at speed ``retract``.

    Parameters
    ----------
    rate : float
        Speed of the approach.
    force : float
        Force at which it ends.
    dwell : float
        Time for which penetration (or stage) stays.
    retract : float, optional
        Speed of the retraction; default: ``rate``.
    to : float, optional
        Greatest penetration (or position of the stage) of the approach; a run that gets there without the
        force ends, and says so. Default: a bound before which the force is reached for certain, which the
        scene states where it can (:mod:`contact_scene.approach_bound`).
    away : float, optional
        Where the retraction ends, if the contact is not lost before; default: as far above the surface as
        ``to`` is below, and where adhesion holds farther, as far as the scene knows it to hold at most.
    """

    rate: Annotated[Positive, Key("speed of the approach", "length time-1")]
    force: Annotated[Finite, Key("force at which it ends", "force")]
    to: Annotated[Positive | None, Key("greatest penetration of the approach", "length")] = None
    dwell: Annotated[NotNegative, Key("how long the penetration stays", "time")] = 0.0
    retract: Annotated[Positive | None, Key("speed of the retraction", "length time-1")] = None
    away: Annotated[Finite | None, Key("where the retraction ends", "length")] = None
    kind: ClassVar[str] = "approach"

    def rules(self) -> None:
        object.__setattr__(self, "retract", self.rate if self.retract is None else self.retract)
        if self.to is not None and self.away is not None and self.away >= self.to:
            raise SceneError("away", f"got {self.away!r}", f"less than to = {self.to:g}")

    @property
    def is_bounded(self) -> bool:
        """Whether it is known how far the approach and the retraction go."""
        return self.to is not None and self.away is not None

    @property
    def trigger(self) -> Trigger:
        """What ends the approach."""
        return Trigger("force", self.force)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        key = "to" if self.to is None else "away"
        raise SceneError(key, "is missing in a loading without a scene", "a bound of the approach")


STEPS = Kinds((Ramp, Hold, Force, ForceRamp, Oscillate, Sweep, Table, Approach))
"""What a file may state under ``[[loading.steps]]``."""
