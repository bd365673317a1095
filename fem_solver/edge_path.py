"""Positions of the contact edge, the radii that belong to them, and its path over one step.

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


class EdgeGeometry:
    """Radii that belong to edge positions, and the shift by one process zone.

    ``effective`` are the contact radii of the sets ``0..m``, ``ends`` those between which each node stands,
    ``zone`` is the length of the process zone, at fixed stress that at rest, ``None`` without adhesion,
    ``shortest`` that of a closing edge. The mesh is made for contact edges up to ``reach``, from which they
    keep a ``margin``: the zone, to which the closure looks.
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
        self.effective, self.ends = effective, np.append(0.0, effective)
        span = reach - (zone or 0.0 if margin is None else margin)
        beyond = min(int(np.searchsorted(radii, span, side="right")), len(radii) - 1)
        self.last = min(beyond if math.isclose(radii[beyond], span) else beyond - 1, len(radii) - 2)
        self.shift = None if zone is None else ZoneShift(radii, zone)
        spacings = np.diff(radii[: self.last + 1])
        self.spacing = float(np.median(spacings)) if spacings.size else math.inf

    def radius(self, s: float) -> float:
        """Contact radius at the edge position ``s``; 0 at ``s = -1`` (no contact)."""
        m = math.floor(s)
        inner = self.effective[m] if m >= 0 else 0.0
        part = s - m
        return float(inner + part * (self.effective[m + 1] - inner)) if part > 0.0 else float(inner)

    def position(self, radius: float) -> float:
        """Edge position of a contact radius; -1 at 0."""
        if radius < self.effective[0]:
            return float(radius / self.effective[0]) - 1.0
        return float(np.interp(radius, self.effective, np.arange(len(self.effective))))


_CLOSE = math.cbrt(np.finfo(float).eps)
"""Share of a step by which Newton's method moves at last, which leaves its square."""
Row = tuple[float, float]
"""Time from an earlier row to the begin of the step, and the contact radius at that row."""


@dataclass(frozen=True)
class EdgePolynomial:
    """A cubic in time through the last three rows and the trial row; of lower order where rows are missing.

    ``a = start + travel p(theta)`` with the share ``theta`` of the step and ``p = theta + bend theta (theta -
    1) + twist theta (theta - 1) (theta + earlier)``: Newton's form, with the length ``earlier`` of the step
    before relative to this one. It is bent and twisted no further than it is monotonic. The speed at the end
    of the step is that of the backward differentiation formula of the same order.
    """

    start: float
    travel: float
    bend: float = 0.0
    twist: float = 0.0
    earlier: float = 1.0

    @classmethod
    def through(cls, start: float, end: float, dt: float, before: tuple[Row, ...]) -> EdgePolynomial:
        """The path from ``start`` to ``end``."""
        travel = end - start
        if not before or travel == 0.0:
            return cls(start, travel)
        length, radius = before[0]
        slope = (start - radius) / length
        curvature = (travel / dt - slope) / (dt + length)
        bend = min(max(curvature * dt**2 / travel, -1.0), 1.0)
        if len(before) < 2:
            return cls(start, travel, bend)
        age, oldest = before[1]
        curvature_before = (slope - (radius - oldest) / (age - length)) / age
        third = (curvature - curvature_before) / (dt + age)
        earlier = length / dt
        # Bernstein coefficients of the slope are positive: 1 - bend - earlier twist, 1 - twist and
        # 1 + bend + (1 + earlier) twist
        least, most = -(1.0 + bend) / (1.0 + earlier), min((1.0 - bend) / earlier, 1.0)
        twist = min(max(third * dt**3 / travel, least), most)
        return cls(start, travel, bend, twist, earlier)

    @property
    def opens(self) -> bool:
        """Whether the edge recedes, or rests."""
        return self.travel <= 0.0

    def passed(self, radii: Array) -> Array:
        """Share of the step at which the edge is at each radius: 0 or 1 if it is there before or later."""
        if self.travel == 0.0:
            return np.where(radii <= self.start, 1.0, 0.0)
        way = (radii - self.start) / self.travel
        share = np.where(way >= 1.0, 1.0, 0.0)  # to the last bit
        between = (way > 0.0) & (way < 1.0)
        if between.any():
            share[between] = self._crossed(way[between])
        return share

    def _crossed(self, way: Array) -> Array:
        """Roots of the cubic, from those of the parabola: Newton's method within brackets that shrink."""
        slope, low, high = 1.0 - self.bend, np.zeros(way.size), np.ones(way.size)
        root = slope + np.sqrt(np.maximum(slope**2 + 4.0 * self.bend * way, 0.0))
        share = np.minimum(2.0 * way / root, 1.0)
        # p in powers of the share
        cubic, square = self.twist, self.bend + self.twist * (self.earlier - 1.0)
        line, moved = 1.0 - self.bend - self.twist * self.earlier, math.inf if self.twist else 0.0
        while moved > _CLOSE:
            excess = share * (line + share * (square + share * cubic)) - way
            rate = line + share * (2.0 * square + share * (3.0 * cubic))
            low, high = np.where(excess <= 0.0, share, low), np.where(excess >= 0.0, share, high)
            ahead = share - excess / np.maximum(rate, _CLOSE)
            ahead = np.where((ahead >= low) & (ahead <= high), ahead, 0.5 * (low + high))
            moved, share = np.abs(ahead - share).max(), ahead
        return share


def extrapolated(radius: float, dt: float, before: tuple[Row, ...]) -> float:
    """Radius after a further time, on the parabola through the last three rows; a line through two."""
    if not before:
        return radius
    length, last = before[0]
    slope, curvature = (radius - last) / length, 0.0
    if len(before) > 1:
        age, oldest = before[1]
        curvature = (slope - (last - oldest) / (age - length)) / age
    return radius + dt * (slope + (dt + length) * curvature)
