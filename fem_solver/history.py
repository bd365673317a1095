"""What the loop expects of a history, wherever it lives, and how a run can end early."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from contact_scene import OutcomeKind
from fem_solver.condensed import Response

Array = NDArray[np.float64]


class History(Protocol):
    """What the two kinds of history offer."""

    def respond(self, dt: float) -> Response:
        """Response of the surface at the end of a step."""
        ...

    def commit(self, dt: float, response: Response, forces: Array) -> None:
        """Accept a step."""
        ...

    @property
    def dissipated(self) -> float:
        """Energy dissipated in the branches so far."""
        ...

    @property
    def displacement(self) -> Array:
        """Surface displacement."""
        ...

    @property
    def stored_energy(self) -> float:
        """Energy of all springs."""
        ...

    @property
    def state(self) -> Any:
        """All internal variables."""
        ...


class Ended(Exception):
    """The run is over before its loading is."""

    def __init__(self, kind: OutcomeKind, reason: str) -> None:
        super().__init__(reason)
        self.kind, self.reason = kind, reason
