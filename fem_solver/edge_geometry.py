"""Radii that belong to edge positions, and where an edge starts a step.

An edge position counts nodes: ``s = m`` is contact of the nodes ``0..m`` (see ``contact_problem``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from fem_solver.closure import ZoneShift

Array = NDArray[np.float64]

NO_CONTACT = -1.0
"""Edge position at which no node is in contact."""
SURFACE_MARGIN = 1.2
"""Radius up to which surface nodes enter the compliance, relative to the largest contact radius."""
_MARGIN_OF_STRESS = 2.05
"""The same for a zone of fixed stress: it may be as long as its contact, and the closure looks as far."""
_LEAST_SPEED = 0.01
"""Speed at the end of a step, relative to its mean, that the formula is not allowed to fall below."""


def surface_margin(stress: float | None) -> float:
    """Margin of the surface nodes for a process zone of this cohesive stress, or of a given length."""
    return SURFACE_MARGIN if stress is None else _MARGIN_OF_STRESS


class EdgeMotion(Enum):
    """Result of a search: the edge rests within the range searched, or leaves it inwards or outwards."""

    RESTING = "resting"
    RECEDING = "receding"
    ADVANCING = "advancing"


@dataclass(frozen=True)
class EdgePosition:
    """Result of a search: edge position ``s`` in equilibrium, otherwise the end of the range searched."""

    motion: EdgeMotion
    s: float


@dataclass(frozen=True)
class EdgeOrigin:
    """Where the edge starts a step, and how it came there.

    Parameters
    ----------
    edge, radius : float
        Edge position in nodes, and the contact radius.
    rate, duration : float
        Mean rate of the radius over the step before, and the length of that; ``duration`` 0 after a kink.
    """

    edge: float
    radius: float
    rate: float = 0.0
    duration: float = 0.0

    def opening_speed(self, radius: float, dt: float) -> float:
        """Speed at which the edge recedes at the end of a step to ``radius``; infinite in no time."""
        if dt <= 0.0:
            return math.inf
        mean = (self.radius - radius) / dt
        if self.duration <= 0.0:
            return mean
        slope = mean + (mean + self.rate) * dt / (dt + self.duration)
        return max(slope, _LEAST_SPEED * mean)


class EdgeGeometry:
    """Radii that belong to edge positions, and the shift by one process zone.

    Parameters
    ----------
    radii : ndarray, shape (n,)
        Surface nodes, vertices and mid-side nodes in turn, from the axis.
    effective : ndarray, shape (n,)
        Contact radius of the sets ``0..m``.
    zone : float or None
        Process-zone length, at fixed stress that at rest; ``None`` without adhesion.
    reach : float
        Radius up to which the mesh is made for a contact edge.
    stress : float, optional
        Cohesive stress of a process zone whose length follows from it.
    shortest : float, optional
        Shortest length of the zone at rest, that of a closing edge; default ``zone``.
    margin : float, optional
        Distance that an edge keeps from ``reach``; default ``zone``, to which the closure looks.
    """

    def __init__(
        self,
        radii: Array,
        effective: Array,
        zone: float | None,
        reach: float,
        *,
        stress: float | None = None,
        shortest: float | None = None,
        margin: float | None = None,
    ) -> None:
        self.radii, self.zone, self.stress = radii, zone, stress
        self.shortest = zone if shortest is None else shortest
        self.effective = effective
        span = reach - (zone or 0.0 if margin is None else margin)
        self.last = min(int(np.searchsorted(radii, span * (1.0 + 1e-9))) - 1, len(radii) - 2)
        self.shift = None if zone is None else ZoneShift(radii, zone)
        spacings = np.diff(radii[: self.last + 1])
        self.spacing = float(np.median(spacings)) if spacings.size else math.inf

    def radius(self, s: float) -> float:
        """Contact radius at the edge position ``s``; 0 at ``s = -1`` (no contact)."""
        m = int(np.floor(s))
        inner = self.effective[m] if m >= 0 else 0.0
        part = s - m
        return float(inner + part * (self.effective[m + 1] - inner)) if part > 0.0 else float(inner)

    def position(self, radius: float) -> float:
        """Edge position of a contact radius; -1 at 0."""
        if radius < self.effective[0]:
            return float(radius / self.effective[0]) - 1.0
        return float(np.interp(radius, self.effective, np.arange(len(self.effective))))
