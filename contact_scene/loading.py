"""Loading history: a start state and steps, each a control law on an interval of time.

Penetration ``D`` is positive downwards, force ``F`` positive in compression. A step is turned into a
:class:`Segment` once the state it starts from is known (a ramp after a force step starts where that ended).
Kinks are declared; a solver steps onto every ``Segment.end`` and every kink exactly.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import ClassVar, Literal

from contact_scene.errors import A_COLUMN, SceneError, as_tuple, finite, not_negative, one_of, positive, shown

Control = Literal["penetration", "force"]
STARTS = ("jump-in", "relaxed")


@dataclass(frozen=True)
class Segment:
    """One step of the loading on the time axis.

    Parameters
    ----------
    control : "penetration" or "force"
        Which of the two is prescribed.
    start, end : float
        Times; ``end >= start``.
    value, rate : callable(float) -> float
        Prescribed quantity and its time derivative (from the right) at an absolute time within the interval.
    kinks : tuple of float
        Times strictly inside the interval where the rate jumps.
    linear : bool
        Whether ``value`` is linear between kinks.

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


def _straight(control: Control, start: float, end: float, first: float, last: float) -> Segment:
    rate = (last - first) / (end - start) if end > start else 0.0

    def value(time: float) -> float:
        if time >= end:
            return last
        return first + (last - first) * ((time - start) / (end - start))

    return Segment(control, start, end, value, lambda time: rate)


class Step:
    """A load step; each kind defines :meth:`segment`."""

    kind: ClassVar[str]

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The control law, starting at ``time`` from a penetration and a force."""
        raise AssertionError("defined by every kind of step")


@dataclass(frozen=True)
class Ramp(Step):
    """Penetration goes linearly to ``to`` at speed ``rate`` > 0; ends early at detachment."""

    to: float
    rate: float
    kind: ClassVar[str] = "ramp"

    def __post_init__(self) -> None:
        object.__setattr__(self, "to", finite(self.to, "to"))
        object.__setattr__(self, "rate", positive(self.rate, "rate"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        end = time + abs(self.to - penetration) / self.rate
        return _straight("penetration", time, end, penetration, self.to)


@dataclass(frozen=True)
class Hold(Step):
    """Penetration stays for ``duration`` >= 0."""

    duration: float
    kind: ClassVar[str] = "hold"

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", not_negative(self.duration, "duration"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return _straight("penetration", time, time + self.duration, penetration, penetration)


@dataclass(frozen=True)
class Force(Step):
    """Force steps to ``value`` (compressive positive) and stays for ``duration``; penetration is free."""

    value: float
    duration: float
    kind: ClassVar[str] = "force"

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", finite(self.value, "value"))
        object.__setattr__(self, "duration", not_negative(self.duration, "duration"))

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return _straight("force", time, time + self.duration, self.value, self.value)


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
        return _straight("force", time, time + abs(self.to - force) / self.rate, force, self.to)


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
        def value(at: float) -> float:
            return penetration + self.amplitude * math.sin(0.5 * self.chirp * (at - time) ** 2)

        def rate(at: float) -> float:
            t = at - time
            return self.amplitude * self.chirp * t * math.cos(0.5 * self.chirp * t * t)

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)


@dataclass(frozen=True)
class Table(Step):
    """Penetration by straight lines through ``(times, penetrations)``; times count from the first row.

    If the first penetration differs from the current one, the load jumps to it.
    """

    times: tuple[float, ...]
    penetrations: tuple[float, ...]
    file: str = field(default="", compare=False)
    kind: ClassVar[str] = "table"

    def __post_init__(self) -> None:
        given = as_tuple(self.times, "time", A_COLUMN), as_tuple(self.penetrations, "penetration", A_COLUMN)
        times = tuple(finite(t, f"time, row {row}") for row, t in enumerate(given[0], 1))
        values = tuple(finite(p, f"penetration, row {row}") for row, p in enumerate(given[1], 1))
        if len(times) != len(values):
            raise SceneError(
                "penetration", f"{len(times)} times but {len(values)} penetrations", "one for each"
            )
        if len(times) < 2:
            raise SceneError("time", f"got {len(times)} rows", "at least 2 rows of time, penetration")
        for row, (before, after) in enumerate(pairwise(times), 2):
            if after <= before:
                raise SceneError(
                    f"time, row {row}",
                    f"does not advance ({before:g} -> {after:g})",
                    "strictly rising times",
                )
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "penetrations", values)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        # Rows that round to the same time after a late start are one row, the last of them.
        rows = dict(zip((time + (t - self.times[0]) for t in self.times), self.penetrations, strict=True))
        at, values = list(rows), list(rows.values())

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

        return Segment("penetration", time, at[-1], value, rate, kinks=tuple(at[1:-1]))


STEPS: dict[str, type[Step]] = {
    step.kind: step for step in (Ramp, Hold, Force, ForceRamp, Oscillate, Sweep, Table)
}


@dataclass(frozen=True)
class Loading:
    """Start state and steps.

    Parameters
    ----------
    start : "jump-in" or "relaxed"
        Glassy or fully relaxed equilibrium at ``penetration``. Where a profile allows more than one, it is
        the one with the outermost stable edge.
    penetration : float
        Penetration of the start state.
    steps : tuple of Step
        Carried out in order; may be empty (the start state alone).
    """

    start: str
    penetration: float
    steps: tuple[Step, ...] = ()

    def __post_init__(self) -> None:
        one_of(self.start, "start", STARTS)
        object.__setattr__(self, "penetration", finite(self.penetration, "penetration"))
        object.__setattr__(self, "steps", as_tuple(self.steps, "steps", "a tuple of loading steps"))
        for index, step in enumerate(self.steps):
            if not isinstance(step, Step):
                raise SceneError(f"steps[{index}]", f"got {shown(step)}", "a loading step")

    def segments(
        self, state: Callable[[Step], tuple[float, float]] | None = None, own_time: bool = False
    ) -> Iterator[tuple[Step, Segment]]:
        """The load steps with their control laws, as far as they are known before a run.

        Parameters
        ----------
        state : callable(Step) -> (float, float), optional
            Estimated penetration and force from which a load step starts, called when it is reached. Default:
            what the loading prescribes; the quantity that is not controlled is unknown, nan, and so are the
            times that depend on it.
        own_time : bool
            Every load step begins at time 0 instead of at the end of the one before.

        Yields
        ------
        step : Step
        segment : Segment
        """
        time, penetration, force = 0.0, self.penetration, math.nan
        for step in self.steps:
            if state is not None:
                penetration, force = state(step)
            segment = step.segment(time, penetration, force)
            yield step, segment
            if not own_time:
                time = segment.end
            last = segment.value(segment.end) if math.isfinite(segment.end) else math.nan
            penetration, force = (last, math.nan) if segment.control == "penetration" else (math.nan, last)
