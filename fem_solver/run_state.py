"""What a run holds between two steps: the last step, a candidate for the next one."""

from __future__ import annotations

from dataclasses import dataclass

from fem_solver.condensed import CondensedState
from fem_solver.contact_solver import ContactCandidate
from fem_solver.following.state import FollowingState
from fem_solver.quadrature_state import QuadratureState
from fem_solver.recorder import RowBefore


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
