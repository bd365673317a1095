"""What decides where the edge is: the closure with adhesion, no tension at the edge without.

The residual rises with the radius through zero at a stable edge. An edge that does not move may be content
with more than one value; it sets off when one of its tendencies, inward or outward, turns positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from contact_scene import Adhesion
from validation.reference.tracking.closure import closure_integral
from validation.reference.tracking.surface import Body, Surface

SHORTEST = 1.02  # process zones: at one, the closure reaches the axis
REST = 2.0  # process zones: an edge that runs free is not looked for in a shorter contact


@dataclass(frozen=True)
class Griffith:
    """``I(a)/dg - 1`` (paper, Eq. closure)."""

    adhesion: Adhesion
    closed: ClassVar[float] = 1e-10  # residual at an accepted edge

    @property
    def reach(self) -> float:
        """How far from the edge the law looks."""
        return self.adhesion.zone

    @property
    def lowest(self) -> float:
        """Smallest contact radius the law is defined for."""
        return SHORTEST * self.adhesion.zone

    @property
    def rest(self) -> float:
        """Smallest contact radius in which a running edge may come to rest."""
        return REST * self.adhesion.zone

    def residual(self, surface: Surface, body: Body) -> float:
        """At an edge that has just moved to where it is."""
        zone = self.adhesion.zone
        edge = surface.near(surface.radius - zone, surface.radius + zone).zone()
        return closure_integral(edge, zone, body.rheology.relaxed, body.transform) / self.adhesion.work - 1.0

    def tendencies(self, surface: Surface, body: Body) -> tuple[float, float]:
        """Opposite to each other: the closure integral is continuous as the edge sets off."""
        value = self.residual(surface, body)
        return value, -value


@dataclass(frozen=True)
class NoTension:
    """``-q(a)/scale``: released where the edge would pull, covered where the indenter would overlap."""

    scale: float
    closed: ClassVar[float] = 1e-13  # a shrinking contact ends in a point, where the residual is flat
    reach: ClassVar[float] = 0.0
    lowest: ClassVar[float] = 0.0
    rest: ClassVar[float] = 0.0

    def residual(self, surface: Surface, body: Body) -> float:
        """At an edge that has just moved to where it is."""
        return -surface.edge_stress(body) / self.scale

    def tendencies(self, surface: Surface, body: Body) -> tuple[float, float]:
        """Pull at the edge, and overlap next to it; both negative while the edge dwells."""
        inward = -surface.edge_stress(body) / self.scale if surface.radius > 0.0 else -1.0
        return inward, surface.edge_overlap(body) * body.rheology.glassy / self.scale


Law = Griffith | NoTension
