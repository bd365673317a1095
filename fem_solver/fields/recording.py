"""A run with what is needed to compute fields in the body afterwards."""

from __future__ import annotations

from dataclasses import dataclass, field

from contact_scene import Trace
from fem_solver.condensed import CondensedState
from fem_solver.fields.history import HistoryLog
from fem_solver.following.setup import FollowingSetup
from fem_solver.following.state import FollowingState
from fem_solver.quadrature_state import QuadratureState
from fem_solver.recorder import SurfaceState
from fem_solver.setup import Setup


@dataclass(frozen=True)
class Recording:
    """Content of a recorded run.

    Parameters
    ----------
    setup : Setup or FollowingSetup
    trace : Trace
    states : dict of float to CondensedState, QuadratureState or FollowingState
        State of the history at each recorded time.
    rows : dict of float to int
        Row of the trace at each recorded time; where the load jumps, the one before.
    surfaces : list of SurfaceState
        By row; empty if nothing was to be recorded.
    log : SurfaceLog, VolumeLog, FollowingLog or None
        The history as far as it was recorded; ``None`` if nothing was to be recorded.
    """

    setup: Setup | FollowingSetup
    trace: Trace
    states: dict[float, CondensedState | QuadratureState | FollowingState] = field(default_factory=dict)
    rows: dict[float, int] = field(default_factory=dict)
    surfaces: list[SurfaceState] = field(default_factory=list)
    log: HistoryLog | None = None
