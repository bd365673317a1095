"""State of a run between two trial steps."""

from __future__ import annotations

from dataclasses import dataclass, field

from contact_scene import Counters, Event, SurfaceProfile
from validation.reference.tracking.recorder import RecordedRows
from validation.reference.tracking.step_history import StepHistory
from validation.reference.tracking.surface import Surface


@dataclass
class FrontState:
    """State of a run; all else follows from scene and options. Only committed steps change it.

    Attributes
    ----------
    surface : Surface
        Fields of the half-space.
    time, force : float
        Of the last committed step.
    largest_radius, largest_force, largest_depth : float
        Largest values so far, or expected from the loading: scales of the allowed deviations.
    travel : float
        Distance that the edge may travel in the next step.
    proposal : float or None
        Duration proposed for the next step; ``None`` right after a kink.
    last_displacement : float
        Last displacement of the edge that exceeds noise.
    displaced_to : float
        Radius after that displacement.
    direction : float
        Sign of the displacement in the last step, 0 if it was at rest or moved at fixed time.
    turn : float or None
        Radius at which the edge last turned, if it has moved since without a rest.
    zones_from_turn : int
        Number of zones that it has come from there, as far as steps end at whole ones.
    steepness : float
        Slope of the residual over the radius at the last step, 0 if unknown.
    steepening : float
        Rate of that slope, 0 if unknown.
    unstable : float
        Direction in which the edge runs from the limit point that it has reached; otherwise 0.
    rejected_before : int
        Rejected steps up to the last committed one.
    extrema : list of float
        Times of extrema of the force within steps.
    """

    surface: Surface
    force: float
    largest_radius: float
    largest_force: float
    largest_depth: float
    travel: float
    displaced_to: float
    time: float = 0.0
    proposal: float | None = None
    last_displacement: float = 0.0
    direction: float = 0.0
    turn: float | None = None
    zones_from_turn: int = 0
    unstable: float = 0.0
    steepness: float = 0.0
    steepening: float = 0.0
    rejected_before: int = 0
    history: StepHistory = field(default_factory=StepHistory)
    counters: Counters = field(default_factory=Counters)
    events: list[Event] = field(default_factory=list)
    extrema: list[float] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    recorded: RecordedRows = field(default_factory=RecordedRows)
