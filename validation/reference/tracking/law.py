"""The edge condition: the closure integral with adhesion, no tension at the edge without.

The residual rises with the radius through zero at a stable edge. An edge at rest may satisfy the condition
with an interval of values; it moves when one of its two driving forces, inward or outward, is positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from contact_scene import Adhesion
from validation.reference.tracking.closure import closure_integral
from validation.reference.tracking.surface import Body, Surface


@dataclass(frozen=True)
class Griffith:
    """``I(a)/dg - 1`` (paper, Eq. closure)."""

    adhesion: Adhesion
    tolerance: ClassVar[float] = 1e-10  # residual at an accepted edge

    @property
    def zone_length(self) -> float:
        """Distance from the edge within which the condition looks at the fields."""
        return self.adhesion.zone

    @property
    def smallest_radius(self) -> float:
        """Smallest contact radius the condition is defined for: one zone, which then reaches the axis."""
        return self.adhesion.zone

    def residual(self, surface: Surface, body: Body) -> float:
        """Residual at an edge that has just moved to its present radius."""
        zone = self.adhesion.zone
        edge = surface.near(surface.radius - zone, surface.radius + zone).edge_fields()
        return closure_integral(edge, zone, body.rheology.relaxed, body.transform) / self.adhesion.work - 1.0

    def driving_forces(self, surface: Surface, body: Body) -> tuple[float, float]:
        """Inward and outward; opposite to each other, for the integral is continuous as the edge departs."""
        value = self.residual(surface, body)
        return value, -value


@dataclass(frozen=True)
class NoTension:
    """``-q(a)/scale``: released where the edge would pull, covered where the indenter would overlap."""

    scale: float
    tolerance: ClassVar[float] = 1e-13  # a shrinking contact ends in a point, where the residual is flat
    zone_length: ClassVar[float] = 0.0
    smallest_radius: ClassVar[float] = 0.0

    def residual(self, surface: Surface, body: Body) -> float:
        """Residual at an edge that has just moved to its present radius."""
        return -surface.edge_stress(body) / self.scale

    def driving_forces(self, surface: Surface, body: Body) -> tuple[float, float]:
        """Tension at the edge, and overlap next to it; both negative while the edge is at rest."""
        inward = -surface.edge_stress(body) / self.scale if surface.radius > 0.0 else -1.0
        return inward, surface.edge_overlap(body) * body.rheology.glassy / self.scale


EdgeCondition = Griffith | NoTension
