"""What decides where the edge is: the closure with adhesion, no tension at the edge without.

The residual rises with the radius through zero at a stable edge: positive recedes, negative advances.
"""

from __future__ import annotations

from dataclasses import dataclass

from scene import Adhesion
from validation.reference.tracking.closure import closure_integral
from validation.reference.tracking.surface import Body, Surface


@dataclass(frozen=True)
class Griffith:
    """``I(a)/dg - 1``."""

    adhesion: Adhesion

    def residual(self, surface: Surface, body: Body) -> float:
        """At the surface's own edge."""
        zone = self.adhesion.zone
        edge = surface.near(surface.radius - zone, surface.radius + zone).zone()
        return closure_integral(edge, zone, body.rheology.relaxed, body.transform) / self.adhesion.work - 1.0

    def at_rest(self, surface: Surface, body: Body) -> float:
        """The same: the closure integral is continuous as the edge sets off."""
        return self.residual(surface, body)


@dataclass(frozen=True)
class NoTension:
    """``-q(a)/scale``: released where the edge would pull, covered where the indenter would overlap."""

    scale: float

    def residual(self, surface: Surface, body: Body) -> float:
        """At an edge that has just moved to where it is."""
        return -surface.edge_stress(body) / self.scale

    def at_rest(self, surface: Surface, body: Body) -> float:
        """Zero where the edge neither pulls nor overlaps: it stays."""
        pull = -surface.edge_stress(body)
        if surface.radius > 0.0 and pull > 0.0:
            return pull / self.scale
        overlap = surface.edge_overlap(body)
        return -overlap * body.rheology.glassy / self.scale if overlap > 0.0 else 0.0


Law = Griffith | NoTension
