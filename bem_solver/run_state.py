"""What a run on graded annuli consists of between two trial steps.

Whatever follows from scene and options (annuli, factors, material chain) is made anew and not part of it: a
run continued from its state performs the same floating-point operations in the same order.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from bem_solver.energy import Energies
from bem_solver.recorder import TraceRecorder
from bem_solver.step_control import AcceptedSteps
from bem_solver.trial import HalfSpaceState


@dataclass(frozen=True)
class StepSettings:
    """What bounds the steps of a run.

    Attributes
    ----------
    tolerance : float
        Step tolerance (``Options.tolerance``).
    divisions : int
        Travel limit of the edge in one step: the length it is resolved on, divided by this.
    scale : float
        Order of magnitude of the largest contact radius.
    """

    tolerance: float
    divisions: int
    scale: float


@dataclass
class GradedState:
    """Serialisable state of a run on graded annuli.

    Attributes
    ----------
    contact, energies
        Committed state of the surface and its energies.
    record
        Rows, events and profiles so far.
    largest_force, largest_edge
        Largest force in magnitude and largest contact radius so far.
    begun
        Whether the present loading interval has begun.
    parameter
        How far it has been followed.
    rejected
        TrialContact steps rejected from there: their length and how far they would have moved the edge.
    accepted
        Accepted states, from which rates are extrapolated.
    step
        Step to try next, before it is limited.
    travel_share
        Share of the travel limit of the edge that is in force.
    slope
        Derivative of the residual with the edge in the last accepted step; 0 if unknown.
    """

    contact: HalfSpaceState
    energies: Energies
    record: TraceRecorder
    largest_force: float
    largest_edge: float
    begun: bool = False
    parameter: float = 0.0
    rejected: list[tuple[float, float]] = field(default_factory=list)
    accepted: AcceptedSteps = field(default_factory=AcceptedSteps)
    step: float = 0.0
    travel_share: float = 1.0
    slope: float = 0.0

    def interval_done(self) -> None:
        """Ready for the next loading interval."""
        self.begun, self.parameter, self.rejected = False, 0.0, []
