"""What a trial step comes to: a candidate for the next state, or that there is none to be told."""

from __future__ import annotations

from dataclasses import dataclass

from bem_solver.trial import Trial


class Unresolvable(Exception):
    """The edge passes its travel limit sooner than the time axis can tell: the limit has to give way."""


@dataclass(frozen=True)
class Candidate:
    """A trial that satisfies the closure, the parameter it was reached at, and its error in tolerances.

    ``slope`` is that of the residual with the edge; zero if the search did not tell.
    """

    parameter: float
    trial: Trial
    error: float
    slope: float = 0.0
