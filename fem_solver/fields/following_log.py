"""History of a run on meshes that follow the edge: the surface at every row, for fields afterwards."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fem_solver.following.history import FollowingHistory
from fem_solver.following.state import FollowingState


@dataclass
class FollowingLog:
    """Surface components of all rows, in their order; what led to them is not kept."""

    history: FollowingHistory
    states: list[FollowingState] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.states)

    def accept(self, dt: float, forces: NDArray[np.float64]) -> None:
        """One more row, which the history has accepted."""
        self.states.append(replace(self.history.state, record=None, before=()))

    def drop_last(self) -> None:
        """The last row is taken back."""
        del self.states[-1:]

    def store(self, row: int) -> None:
        """Nothing to do: all rows are stored."""

    def __contains__(self, row: int) -> bool:
        return 0 <= row < self.rows

    def __getitem__(self, row: int) -> FollowingState:
        return self.states[row]
