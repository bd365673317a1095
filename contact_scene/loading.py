"""Loading history: a start state and load steps, each a control law on an interval of time.

Penetration ``D`` is positive downwards, force ``F`` positive in compression. A step becomes a
:class:`Segment` once the state it starts from is known (a ramp after a force step starts where that ended):
a straight line, an oscillation or pieces between the rows of a table. Kinks are declared; a solver steps onto
every ``Segment.end`` and every kink exactly. A test approaches until a force is reached, not to a depth:
where the level of a trigger is reached, a solver finds in its own way; here is which quantity it is, and from
which side it is approached. Where the machine is a spring, steps that drive the indenter drive the stage
instead (:mod:`contact_scene.machine`).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from contact_scene.checked import Checked, Finite, Key, NotNegative, Positive, Tabulated
from contact_scene.errors import SceneError
from contact_scene.machine import Machine
from contact_scene.trace import Outcome, OutcomeKind

Start = Literal["jump-in", "relaxed", "snap-in"]
Control = Literal["penetration", "force", "stage"]
Quantity = Literal["force", "radius", "penetration"]
Function = Callable[[float], float]

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

    ``value`` and its ``rate`` (from the right) are those of the prescribed quantity at absolute times, from
    ``start`` to ``end >= start``; the rate jumps at the ``kinks`` strictly inside, and is constant between
    them if ``linear``. ``compliance`` is that of the machine where the stage is prescribed, otherwise 0.
    ``trigger`` ends the step before its ``end``.

    Where ``value(start)`` differs from the state reached before, the load jumps, and the half-space answers
    with its glassy modulus.
    """

    control: Control
    start: float
    end: float
    value: Function
    rate: Function
    kinks: tuple[float, ...] = ()
    linear: bool = True
    compliance: float = 0.0
    trigger: Trigger | None = None

    def present(self, penetration: float, force: float) -> float:
        """The prescribed quantity in a state of that penetration and force."""
        if self.control == "force":
            return force
        return penetration + self.compliance * force if self.control == "stage" else penetration


class Step:
    """A load step; each kind says by ``segment`` how its control law goes on from a time and a state."""

    kind: ClassVar[str]
    tag = "kind"

    @property
    def trigger(self) -> Trigger | None:
        """What ends the step before its end: the level that is given as ``until_...``."""
        for quantity in ("force", "radius", "penetration"):
            level = getattr(self, f"until_{quantity}", None)
            if level is not None:
                return Trigger(quantity, level)
        return None

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        """The control law of this step, which starts at ``time`` from a penetration and a force."""
        raise AssertionError("defined by every kind of step")

    def largest(self, segment: Segment) -> float:
        """At least the largest value that its control law prescribes."""
        return max(segment.value(segment.start), segment.value(segment.end))

    @property
    def longest_rest(self) -> float:
        """Longest time for which the load rests, or takes from one turn to the next; 0 of what goes on."""
        return 0.0

    def cycles_by(self, elapsed: float) -> float:
        """Cycles done when a time has passed since its start, the last not whole; 0 of what is no cycle."""
        return 0.0

    def cycle_times(self, elapsed: float) -> tuple[float, ...]:
        """Times from its start at which it has done 0, 1, 2, ... whole cycles, until a time has passed."""
        return ()


# Straight lines, and pieces between rows, in time


def pieces(
    control: Control,
    at: Sequence[float],
    values: Sequence[float],
    trigger: Trigger | None = None,
    smooth: bool = False,
) -> Segment:
    """A control law by straight lines, or smooth cubics, between values at rising times."""
    if smooth:
        from scipy.interpolate import PchipInterpolator  # heavy, and of use to smooth tables alone

        with np.errstate(over="ignore"):  # between rows that all but agree: the mean of slopes is then zero
            polynomials = PchipInterpolator(at, values).c.T.tolist()  # highest powers first
    else:
        rows = pairwise(zip(at, values, strict=True))
        polynomials = [[(y - x) / (end - start) if end > start else 0.0, x] for (start, x), (end, y) in rows]

    def piece(now: float) -> tuple[list[float], float]:
        i = min(max(bisect_right(at, now) - 1, 0), len(polynomials) - 1)
        return polynomials[i], now - at[i]

    def value(now: float) -> float:
        if not polynomials or now >= at[-1]:
            return values[-1]
        total, (coefficients, t) = 0.0, piece(now)
        for one in coefficients:
            total = total * t + one
        return total

    def rate(now: float) -> float:
        if not polynomials:
            return 0.0
        total, (coefficients, t) = 0.0, piece(now)
        for power, one in zip(range(len(coefficients) - 1, 0, -1), coefficients, strict=False):
            total = total * t + power * one
        return total

    return Segment(
        control, at[0], at[-1], value, rate, () if smooth else tuple(at[1:-1]), not smooth, trigger=trigger
    )


@dataclass(frozen=True)
class Ramp(Step, Checked):
    """Penetration goes linearly to ``to`` at speed ``rate`` > 0; ends early at detachment.

    With ``until_force`` or ``until_radius`` the step ends where the force, or the contact radius, reaches
    that level; a run that gets to ``to`` without it ends there, and says so.

    Examples
    --------
    >>> cc.Ramp(to=-5e-5, rate=1e-6, until_radius=1e-5).trigger
    Trigger(quantity='radius', level=1e-05)
    """

    to: Annotated[Finite, Key("penetration it goes to", "length")]
    rate: Annotated[Positive, Key("speed", "length time-1")]
    until_force: Annotated[Finite | None, Key("force at which it ends", "force")] = None
    until_radius: Annotated[Positive | None, Key("contact radius at which it ends", "length")] = None
    kind: ClassVar[str] = "ramp"

    def rules(self) -> None:
        if self.until_force is not None and self.until_radius is not None:
            raise SceneError("until_radius", "given beside until_force", "one of the two")

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        end = time + abs(self.to - penetration) / self.rate
        return pieces("penetration", (time, end), (penetration, self.to), self.trigger)


@dataclass(frozen=True)
class Hold(Step, Checked):
    """Penetration stays for ``duration`` >= 0, or until the force has come to ``until_force`` before.

    Examples
    --------
    >>> cc.Hold(duration=10.0)
    Hold(duration=10.0, until_force=None)
    """

    duration: Annotated[NotNegative, Key("how long the penetration stays", "time")]
    until_force: Annotated[Finite | None, Key("force at which it ends", "force")] = None
    kind: ClassVar[str] = "hold"

    @property
    def longest_rest(self) -> float:
        return self.duration

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return pieces("penetration", (time, time + self.duration), 2 * (penetration,), self.trigger)


@dataclass(frozen=True)
class Force(Step, Checked):
    """Force steps to ``value`` (compressive positive) and stays for ``duration``; penetration is free.

    With ``until_penetration`` it stays until the indenter has come to that penetration before. The step to
    ``value`` comes first, whole: a penetration that it passes ends the load step right after it.

    Examples
    --------
    >>> cc.Force(value=-2e-3, duration=60.0)
    Force(value=-0.002, duration=60.0, until_penetration=None)
    """

    value: Annotated[Finite, Key("force", "force")]
    duration: Annotated[NotNegative, Key("how long the force stays", "time")]
    until_penetration: Annotated[Finite | None, Key("penetration at which it ends", "length")] = None
    kind: ClassVar[str] = "force"

    @property
    def longest_rest(self) -> float:
        return self.duration

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return pieces("force", (time, time + self.duration), 2 * (self.value,), self.trigger)


@dataclass(frozen=True)
class ForceRamp(Step, Checked):
    """Force goes linearly to ``to`` at ``rate`` > 0 (force per time); penetration is free.

    Examples
    --------
    >>> cc.ForceRamp(to=-2e-3, rate=1e-4)
    ForceRamp(to=-0.002, rate=0.0001)
    """

    to: Annotated[Finite, Key("force it goes to", "force")]
    rate: Annotated[Positive, Key("force per time", "force time-1")]
    kind: ClassVar[str] = "force-ramp"

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        return pieces("force", (time, time + abs(self.to - force) / self.rate), (force, self.to))


# Oscillations about a drift


class Cyclic(Step):
    """``D = D_start + amplitude sin(w t + chirp t^2/2) - drift t``, t from the start of the step.

    A cycle is ``2 pi`` of the phase.
    """

    amplitude: float
    duration: float

    @property
    def law(self) -> tuple[float, float, float]:
        """``w``, chirp and drift, of which a kind of step names those that it has."""
        w, chirp, drift = (getattr(self, name, 0.0) for name in ("angular_frequency", "chirp", "drift"))
        return w, chirp, drift

    def phase(self, elapsed: float) -> float:
        """Phase after a time."""
        w, chirp, _ = self.law
        return w * elapsed + 0.5 * chirp * elapsed**2

    def time_of(self, phase: float) -> float:
        """Time after which a phase is reached."""
        w, chirp, _ = self.law
        return 2.0 * phase / (w + math.sqrt(w**2 + 2.0 * chirp * phase)) if phase > 0.0 else 0.0

    @property
    def longest_rest(self) -> float:
        first, second = self.time_of(0.5 * math.pi), self.time_of(1.5 * math.pi)
        return max(first, second - first)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        w, chirp, drift = self.law

        def value(at: float) -> float:
            t = at - time
            return penetration + self.amplitude * math.sin(self.phase(t)) - drift * t

        def rate(at: float) -> float:
            t = at - time
            return self.amplitude * (w + chirp * t) * math.cos(self.phase(t)) - drift

        return Segment("penetration", time, time + self.duration, value, rate, linear=False)

    def largest(self, segment: Segment) -> float:
        return segment.value(segment.start) + abs(self.amplitude) + max(-self.law[2], 0.0) * self.duration

    def cycles_by(self, elapsed: float) -> float:
        return self.phase(min(elapsed, self.duration)) / (2.0 * math.pi)

    def cycle_times(self, elapsed: float) -> tuple[float, ...]:
        done = self.cycles_by(elapsed)
        whole = math.floor(done * (1.0 + 1e-12)) if done > 0.0 else -1
        return tuple(self.time_of(2.0 * math.pi * number) for number in range(whole + 1))


@dataclass(frozen=True)
class Oscillate(Cyclic, Checked):
    """``D = D_start + amplitude sin(w t) - drift t``, t from the start of the step.

    Examples
    --------
    >>> swing = cc.Oscillate(amplitude=1e-6, angular_frequency=6.0, duration=10.0)
    >>> f"{swing.cycles_by(10.0):.2f}"
    '9.55'
    """

    amplitude: Annotated[Finite, Key("amplitude", "length")]
    angular_frequency: Annotated[Positive, Key("angular frequency", "time-1")]
    duration: Annotated[Positive, Key("how long it goes on", "time")]
    drift: Annotated[Finite, Key("speed of retraction beside it", "length time-1")] = 0.0
    kind: ClassVar[str] = "oscillate"


@dataclass(frozen=True)
class Sweep(Cyclic, Checked):
    """``D = D_start + amplitude sin(chirp t^2/2)``: angular frequency ``chirp t`` (paper, Fig. 6).

    Examples
    --------
    >>> f"{cc.Sweep(amplitude=1e-6, chirp=0.1, duration=100.0).cycles_by(100.0):.1f}"
    '79.6'
    """

    amplitude: Annotated[Finite, Key("amplitude", "length")]
    chirp: Annotated[Positive, Key("angular frequency gained per time", "time-2")]
    duration: Annotated[Positive, Key("how long it goes on", "time")]
    kind: ClassVar[str] = "sweep"


# Tables


@dataclass(frozen=True)
class Table(Step, Tabulated):
    """``quantity`` by straight lines, or piecewise cubics, through ``(times, values)``: planned, or recorded.

    By straight lines every row is a kink of the load, which a solver steps onto; a record with rows by the
    hundred thousand is read as a smooth curve instead, ``interpolation = "cubic"``: the piecewise cubic of
    F.N. Fritsch and R.E. Carlson, SIAM J. Numer. Anal. 17, 238 (1980), without an extremum between the rows.
    Times count from the first row. If the first value differs from the current one, the load jumps to it.
    A table of penetrations drives the stage where the machine is a spring.

    Examples
    --------
    >>> cc.Table(times=(0.0, 1.0, 3.0), values=(0.0, 1e-6, -1e-5)).quantity
    'penetration'
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

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        # Rows that round to the same time after a late start are one row, the last of them.
        rows = dict(zip((time + (t - self.times[0]) for t in self.times), self.values, strict=True))
        smooth = self.interpolation == "cubic" and len(rows) > 2 and math.isfinite(time)
        return pieces(self.quantity, list(rows), list(rows.values()), smooth=smooth)

    def largest(self, segment: Segment) -> float:
        return max(self.values)


# The usual test in one entry


@dataclass(frozen=True)
class Approach(Step, Checked):
    """Approach at ``rate`` until ``force``, stay for ``dwell``, go back at speed ``retract``.

    A run that gets to ``to`` without the force ends, and says so. Bounds that are not given the scene states
    where it can (:mod:`contact_scene.approach_bound`): ``to`` before which the force is reached for certain;
    ``away`` as far above the surface as ``to`` is below, or farther, where adhesion holds so far.

    Examples
    --------
    >>> test = cc.Approach(rate=1e-6, force=1e-3, dwell=10.0)
    >>> test.dwell
    10.0
    """

    rate: Annotated[Positive, Key("speed of the approach", "length time-1")]
    force: Annotated[Finite, Key("force at which it ends", "force")]
    to: Annotated[Positive | None, Key("greatest penetration (or position of the stage)", "length")] = None
    dwell: Annotated[NotNegative, Key("time for which penetration (or stage) stays", "time")] = 0.0
    retract: Annotated[Positive | None, Key("speed of the retraction, else rate", "length time-1")] = None
    away: Annotated[Finite | None, Key("where the retraction ends with contact", "length")] = None
    kind: ClassVar[str] = "approach"

    def rules(self) -> None:
        object.__setattr__(self, "retract", self.rate if self.retract is None else self.retract)
        if self.to is not None and self.away is not None and self.away >= self.to:
            raise SceneError("away", f"got {self.away!r}", f"less than to = {self.to:g}")

    @property
    def trigger(self) -> Trigger:
        """What ends the approach."""
        return Trigger("force", self.force)

    def parts(self) -> tuple[Step, ...] | None:
        """The steps it stands for; ``None`` where it is not known how far it goes."""
        if self.to is None or self.away is None:
            return None
        assert self.retract is not None  # it follows from `rate`
        press, pull = Ramp(self.to, self.rate, until_force=self.force), Ramp(self.away, self.retract)
        return (press, Hold(self.dwell), pull) if self.dwell > 0.0 else (press, pull)

    def segment(self, time: float, penetration: float, force: float) -> Segment:
        key = "to" if self.to is None else "away"
        raise SceneError(key, "is missing in a loading without a scene", "a bound of the approach")


STEPS = (Ramp, Hold, Force, ForceRamp, Oscillate, Sweep, Table, Approach)
"""What a file may state under ``[[loading.steps]]``."""


@dataclass(frozen=True)
class Loading(Checked):
    """Start state, steps, and the machine they drive.

    A run starts from the glassy ("jump-in") or the fully relaxed equilibrium at ``penetration``; or from
    contact made at constant stage ("snap-in"), the glassy equilibrium with the stage at ``penetration``,
    which on a rigid machine is "jump-in". Where a profile allows more than one, it is the one with the
    outermost stable edge. With a spring, steps that prescribe a penetration prescribe the position of the
    stage, which is that of the start state at first. An :class:`Approach` stands for several steps.

    Examples
    --------
    >>> steps = cc.Ramp(1e-5, 1e-6), cc.Hold(10.0), cc.Ramp(-5e-5, 1e-6)
    >>> cc.Loading("jump-in", 0.0, steps, cc.Machine(stiffness=0.1)).start
    'jump-in'
    """

    start: Annotated[str, Start, Key("state a run starts from")]
    penetration: Annotated[Finite, Key("penetration (of a snap-in: stage) of that state", "length")]
    steps: Annotated[tuple[Annotated[Step, STEPS], ...], Key("load steps, in order")] = ()
    machine: Annotated[Machine | None, Key("spring that holds the indenter")] = None

    def rules(self) -> None:
        parts = [step.parts() if isinstance(step, Approach) else (step,) for step in self.steps]
        if None not in parts:
            object.__setattr__(self, "steps", tuple(step for part in parts for step in part or ()))

    @property
    def compliance(self) -> float:
        """Of the machine; 0 where it is rigid."""
        return 0.0 if self.machine is None else self.machine.compliance

    @property
    def start_control(self) -> Control:
        """What ``penetration`` prescribes of the start state: the indenter, or the stage of a spring."""
        return "stage" if self.start == "snap-in" and self.compliance > 0.0 else "penetration"

    @property
    def without_start(self) -> str:
        """What a run says that finds no state to start from."""
        missing = f"no stable contact at {self.start_control} {self.penetration:.6g}"
        where = "; an indenter from above touches the surface at penetration 0: start there"
        return missing + where if self.penetration < 0.0 else missing

    @property
    def has_triggers(self) -> bool:
        """Whether a level ends one of the steps."""
        return any(step.trigger is not None for step in self.steps)

    def segment(
        self, step: Step, time: float, penetration: float, force: float, driven: float | None = None
    ) -> Segment:
        """The control law of a step that starts from a state; ``driven``: where indenter or stage stands."""
        if driven is None:
            driven = penetration + self.compliance * force if self.compliance > 0.0 else penetration
        segment = step.segment(time, driven, force)
        if self.compliance == 0.0 or segment.control == "force":
            return segment
        return replace(segment, control="stage", compliance=self.compliance)

    def segments(
        self, state: Callable[[Step], tuple[float, float]] | None = None, own_time: bool = False
    ) -> Iterator[tuple[Step, Segment]]:
        """The load steps with their control laws, as far as they are known before a run.

        ``state`` is asked for an estimated penetration and force from which a load step starts, when it is
        reached. Without it they are what the loading prescribes; what is neither prescribed nor a level that
        ends a step is unknown, nan, and so are the times that depend on it. With ``own_time`` every load step
        begins at time 0 instead of at the end of the one before.
        """
        time, force = 0.0, math.nan
        known = self.compliance == 0.0 or self.start_control == "stage"
        driven = self.penetration if known else math.nan
        for step in self.steps:
            begin = (math.nan, force, driven) if state is None else state(step)
            segment = self.segment(step, time, *begin)
            yield step, segment
            trigger = segment.trigger
            if not own_time:
                time = segment.end if trigger is None else math.nan
            last = segment.value(segment.end) if math.isfinite(segment.end) else math.nan
            if trigger is not None and segment.rate(segment.start) != 0.0:
                last = math.nan
            driven, force = (math.nan, last) if segment.control == "force" else (last, math.nan)
            if trigger is not None and trigger.quantity == "force":
                force = trigger.level
            elif trigger is not None and trigger.quantity == "penetration" and self.compliance == 0.0:
                driven = trigger.level
