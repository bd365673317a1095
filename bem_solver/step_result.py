"""What a trial step on graded annuli comes to: a candidate for the next state, or why there is none."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto

from bem_solver.trial import TrialContact


class StepFailure(Enum):
    """Why a trial step has no candidate."""

    BEYOND_TRAVEL_LIMIT = auto()
    """Even at the load of the start, the edge goes beyond its travel limit."""
    UNRESOLVED = auto()
    """The edge passes its travel limit after a time below the rounding of the parameter."""
    UNSTABLE = auto()
    """The edge at the travel limit is in equilibrium, but not a stable one."""


@dataclass(frozen=True)
class FailedStep:
    """A trial step without candidate; ``travel`` is how far the edge would have moved.

    ``way`` is the distance of the edge from where it will run away, as far as the trials tell.
    """

    failure: StepFailure
    receding: bool
    way: float = math.inf
    travel: float = 0.0


@dataclass(frozen=True)
class Candidate:
    """A trial that satisfies the closure, the parameter it was reached at, and its error in tolerances.

    ``slope`` is the derivative of the residual with the edge; zero if unknown. ``speed_jumps``: that of the
    edge does there, as where a pinned one sets out.
    """

    parameter: float
    trial: TrialContact
    error: float
    slope: float = 0.0
    speed_jumps: bool = False
