"""What a run holds between two steps: its serialisable state, the last step, a candidate for the next one."""

from __future__ import annotations

from dataclasses import dataclass

from fem_solver.condensed import CondensedState
from fem_solver.contact_solver import ContactCandidate
from fem_solver.following.state import FollowingState
from fem_solver.quadrature_state import QuadratureSnapshot, QuadratureState
from fem_solver.recorder import RecorderContent, RowBefore
from fem_solver.step_control import DyadicInterval


@dataclass(frozen=True)
class StepBefore:
    """What it needs to take the last step back, which lies in the present interval and brought no event.

    Parameters
    ----------
    time : float
        At its begin.
    position : int
        There, within the interval.
    slopes : dict of str to float
        Of the step before it.
    row : RowBefore
    history : CondensedState, QuadratureState or FollowingState
    """

    time: float
    position: int
    slopes: dict[str, float]
    row: RowBefore
    history: CondensedState | QuadratureState | FollowingState


@dataclass(frozen=True)
class NodeReleaseState:
    """Serialisable state of a run, beside its place in the loading and its counters.

    Half-space, factors and edge law follow from scene, mesh and options: computed again in the same order,
    they have the same bits.

    Parameters
    ----------
    time : float
        Of the last accepted state.
    interval : DyadicInterval or None
        Interval between two stops that the run is in.
    step : float or None
        Step with which to begin the next interval; ``None``: the usual first step.
    slopes : dict of str to float
        Of the last accepted step (see ``step_control``).
    recorded : RecorderContent
    history : CondensedState, QuadratureSnapshot or FollowingState
    before : StepBefore or None
    """

    time: float
    interval: DyadicInterval | None
    step: float | None
    slopes: dict[str, float]
    recorded: RecorderContent
    history: CondensedState | QuadratureSnapshot | FollowingState
    before: StepBefore | None


@dataclass(frozen=True)
class StepCandidate:
    """Result of a trial step; ``error`` is relative to the allowed one, infinite without equilibrium."""

    contact: ContactCandidate
    slopes: dict[str, float]
    error: float


@dataclass(frozen=True)
class TensionPeak:
    """Rates at which the tension rises to the last row and falls behind it, and what rows may miss of it."""

    rise: float
    fall: float
    allowed: float
