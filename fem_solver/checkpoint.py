"""What a run has become between two steps, taken out of it and put back.

Half-space, factors and edge law follow from scene, mesh and options: they are made anew, in the same order,
which gives the same bits. Kept are the history's variables, the rows, and where the step control stands.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from fem_solver.condensed import CondensedHistory
from fem_solver.quadrature import QuadratureHistory
from fem_solver.step_control import Clock

if TYPE_CHECKING:
    from fem_solver.recorder import Recorder
    from fem_solver.stepping import Run

History = CondensedHistory | QuadratureHistory

_MOVING = ("counters", "time", "place", "_range")
_ASKED = ("work_of_adhesion", "kept")  # of the recorder: not its own doing
_CONDENSED = ("state", "dissipated", "updates")
_QUADRATURE = ("shear", "volume", "far", "unknowns", "dissipated", "updates")


@dataclass
class Place:
    """Where a run stands in its loading.

    ``origin`` is time, penetration and force where the loading step began, ``start`` the last declared time
    that was reached (``None``: the step's own jump is still to come), ``stride`` the step to go on with from
    there, ``clock`` the way to the next declared time.
    """

    step: int = 0
    origin: tuple[float, float, float] | None = None
    start: float | None = None
    stride: float | None = None
    clock: Clock | None = None

    def enter(self, time: float, penetration: float, force: float) -> tuple[float, float, float]:
        """Begin a loading step here, unless it has been begun before."""
        if self.origin is None:
            self.origin = (time, penetration, force)
        return self.origin

    def reach(self, time: float, stride: float | None) -> None:
        """A declared time is reached."""
        self.start, self.stride, self.clock = time, stride, None

    def leave(self) -> None:
        """The loading step is done."""
        self.step, self.origin = self.step + 1, None
        self.start = self.stride = self.clock = None


@dataclass(frozen=True)
class State:
    """All that changes in a run: of the loop, its judge, the recorder and the history.

    ``solves`` are the back-substitutions by ratio of moduli, in the order in which these were factorised.
    """

    moving: dict[str, Any]
    slopes: dict[str, float]
    recorded: dict[str, Any]
    history: dict[str, Any]
    solves: dict[float, int]


def taken(run: Run, history: History) -> State:
    """The state of a run; it shares what will change."""
    return State(
        {name: getattr(run, name) for name in _MOVING},
        run.judge.slopes,
        {name: getattr(run.recorder, name) for name in _recorded(run.recorder)},
        {name: getattr(history, name) for name in _variables(history)},
        history.solves if isinstance(history, QuadratureHistory) else {},
    )


def put_back(state: State, run: Run, history: History) -> None:
    """Make a fresh run stand where the kept one stood."""
    for target, values in ((run, state.moving), (run.recorder, state.recorded), (history, state.history)):
        for name, value in values.items():
            setattr(target, name, value)
    run.judge.slopes = state.slopes
    if isinstance(history, QuadratureHistory):
        history.factorise_again(state.solves)


def _recorded(recorder: Recorder) -> list[str]:
    return [entry.name for entry in fields(recorder) if entry.name not in _ASKED]


def _variables(history: History) -> tuple[str, ...]:
    return _CONDENSED if isinstance(history, CondensedHistory) else _QUADRATURE
