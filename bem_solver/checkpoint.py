"""What a run has become between two trial steps, taken out of it and put back.

Whatever follows from scene and options (annuli, factors, the chain) is made anew and not kept. A run that
goes on from its state does what it would have done: the same floating-point operations in the same order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from contact_scene import Counters, RunMonitor

if TYPE_CHECKING:
    from bem_solver.recorder import Recorder
    from bem_solver.stepping import Stepper

_MADE_ANEW = ("problem", "recorder", "progress", "watch")
_RECORDED = ("rows", "kinks", "events", "profiles")


@dataclass
class Place:
    """Where a run stands in its loading.

    ``origin`` is time, penetration and force where the loading step began, from which its segment follows;
    ``parameter`` counts within the piece (see ``Piece``) and ``rejected`` are the trials in vain from there;
    ``taken`` counts the steps of a piece that has a fixed number of them.
    """

    step: int = 0
    origin: tuple[float, float, float] | None = None
    piece: int = 0
    begun: bool = False
    parameter: float = 0.0
    rejected: list[tuple[float, float]] = field(default_factory=list)
    taken: int = 0

    @property
    def fresh(self) -> bool:
        """Whether no loading step has been begun."""
        return self.step == 0 and self.origin is None

    def enter(self, time: float, penetration: float, force: float) -> tuple[float, float, float]:
        """Begin a loading step here, unless it has been begun before."""
        if self.origin is None:
            self.origin = (time, penetration, force)
        return self.origin

    def reach(self, parameter: float, rejected: list[tuple[float, float]]) -> None:
        """Stand at a parameter of the piece."""
        self.parameter, self.rejected = parameter, rejected

    def next_piece(self) -> None:
        """The piece is done."""
        self.piece, self.begun, self.taken = self.piece + 1, False, 0
        self.reach(0.0, [])

    def next_step(self) -> None:
        """The loading step is done."""
        self.step, self.origin, self.piece = self.step + 1, None, 0


@dataclass(frozen=True)
class State:
    """All that changes in a run: ``moving`` by name, what has been recorded, the work done."""

    moving: dict[str, Any]
    recorded: dict[str, Any]
    counters: Counters


def taken(moving: dict[str, Any], recorder: Recorder, counters: Counters) -> State:
    """The state of a run whose changing parts are given."""
    return State(moving, {name: getattr(recorder, name) for name in _RECORDED}, counters)


def put_back(state: State, recorder: Recorder, counters: Counters) -> dict[str, Any]:
    """Fill recorder and counters, which others hold on to; returns the moving parts."""
    for name, value in state.recorded.items():
        setattr(recorder, name, value)
    for entry in fields(counters):
        setattr(counters, entry.name, getattr(state.counters, entry.name))
    return state.moving


def of_stepper(stepper: Stepper) -> State:
    """The state of a run on graded annuli."""
    names = [entry.name for entry in fields(stepper) if entry.name not in _MADE_ANEW]
    return taken({name: getattr(stepper, name) for name in names}, stepper.recorder, stepper.problem.counters)


def goes_on(watch: RunMonitor | None, state: Callable[[], State]) -> bool:
    """Whether nobody outside wants the run to end."""
    return watch is None or watch.continue_run(state)
