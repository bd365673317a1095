"""Loading history: a start state and steps, each a control law on an interval of time.

Kinks are declared; a solver steps onto every ``Segment.end`` and every kink exactly. Where the machine is a
spring, steps that drive the indenter drive the stage instead (:mod:`contact_scene.machine`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated

from contact_scene.checked import Checked, Finite, Key, Words
from contact_scene.load_steps import STEPS, Approach, Hold, Ramp
from contact_scene.machine import Machine
from contact_scene.segment import Control, Segment, Step


@dataclass(frozen=True)
class Loading(Checked):
    """Start state, steps, and the machine they drive.

    Parameters
    ----------
    start : "jump-in", "relaxed" or "snap-in"
        Glassy or fully relaxed equilibrium at ``penetration``; or contact made at constant stage, the glassy
        equilibrium with the stage at ``penetration`` (on a rigid machine that is "jump-in"). Where a profile
        allows more than one, it is the one with the outermost stable edge.
    penetration : float
        Penetration of the start state; of a "snap-in", position of the stage.
    steps : tuple of Step
        Carried out in order; may be empty (the start state alone). An :class:`Approach` stands for several,
        which the scene puts in where one of them has no bound.
    machine : Machine, optional
        What holds the indenter; default: rigid. With a spring the steps that prescribe a penetration
        prescribe the position of the stage, which is that of the start state at first.
    """

    start: Annotated[str, Words(("jump-in", "relaxed", "snap-in")), Key("state a run starts from")]
    penetration: Annotated[Finite, Key("penetration of that state", "length")]
    steps: Annotated[tuple[Annotated[Step, STEPS], ...], Key("load steps, in order")] = ()
    machine: Annotated[Machine | None, Key("spring that holds the indenter")] = None

    def rules(self) -> None:
        if not any(isinstance(step, Approach) and not step.is_bounded for step in self.steps):
            steps = tuple(part for step in self.steps for part in expanded(step))
            object.__setattr__(self, "steps", steps)

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

    def segment(self, step: Step, time: float, penetration: float, force: float) -> Segment:
        """The control law of a step that starts from a state, on this machine."""
        if self.compliance == 0.0:
            return step.segment(time, penetration, force)
        return self._of_stage(step.segment(time, penetration + self.compliance * force, force))

    def _of_stage(self, segment: Segment) -> Segment:
        if segment.control == "force":
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
        driven = self.penetration if known else math.nan  # indenter, or stage
        for step in self.steps:
            if state is not None:
                penetration, force = state(step)
                segment = self.segment(step, time, penetration, force)
            elif self.compliance == 0.0:
                segment = step.segment(time, driven, force)
            else:
                segment = self._of_stage(step.segment(time, driven, force))
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


def expanded(step: Step) -> tuple[Step, ...]:
    """The steps an approach with its bounds stands for; any other step is itself."""
    if not isinstance(step, Approach) or step.to is None or step.away is None:
        return (step,)
    assert step.retract is not None  # it follows from `rate`
    press = Ramp(step.to, step.rate, until_force=step.force)
    pull = Ramp(step.away, step.retract)
    return (press, Hold(step.dwell), pull) if step.dwell > 0.0 else (press, pull)
