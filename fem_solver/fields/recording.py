"""A run with the surface at all of its rows, from which fields in the body are computed afterwards."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from contact_scene import Trace
from fem_solver.recorder import SurfaceState
from fem_solver.setup import Setup
from fem_solver.state import ComponentState, SurfaceHistory


@dataclass(frozen=True)
class SurfaceStep:
    """Length of a step, and the surface at its begin and end, on the mesh of the step."""

    dt: float
    begin: ComponentState
    end: ComponentState

    @classmethod
    def last_of(cls, history: SurfaceHistory, dt: float) -> SurfaceStep:
        """The step that a history has accepted last; what led to it is not kept."""
        return cls(dt, *(replace(at, record=None, before=()) for at in (history.begin, history.state)))


@dataclass(frozen=True)
class Recording:
    """Content of a recorded run.

    Parameters
    ----------
    setup : Setup
    trace : Trace
    rows : dict of float to int
        Row of the trace at each requested time; where the load jumps, the one before.
    surfaces : list of SurfaceState
        By row; empty if nothing was to be recorded.
    steps : list of SurfaceStep
        That end at each row; empty if nothing was to be recorded.
    """

    setup: Setup
    trace: Trace
    rows: dict[float, int] = field(default_factory=dict)
    surfaces: list[SurfaceState] = field(default_factory=list)
    steps: list[SurfaceStep] = field(default_factory=list)
