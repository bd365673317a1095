"""The edge condition: the closure integral with adhesion, no tension at the edge without.

The residual rises with the radius through zero at a stable edge. An edge at rest may satisfy the condition
with an interval of values; it moves when one of its two driving forces, inward or outward, is positive.

``velocity`` is the rate of the radius at the end of a step: negative where the edge opens, infinite where it
moves at fixed time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact_scene import Adhesion
from validation.reference.path.rheology import Body
from validation.reference.tracking.closure import closure_integral
from validation.reference.tracking.cohesive_zone import zone_at
from validation.reference.tracking.surface import Surface

SHORTEST_ZONE = 1e-3
"""Shortest zone of fixed stress that is followed, in zones at rest: the edge pulls a thirtieth as much."""


@dataclass(frozen=True)
class Griffith:
    """``I(a)/w - 1`` (paper, Eq. closure); ``w`` is what the edge takes up in its direction, at its speed."""

    adhesion: Adhesion
    tolerance: ClassVar[float] = 1e-10  # residual at an accepted edge

    @property
    def zone_length(self) -> float:
        """Length of the process zone, at fixed stress that at rest: what the edge is resolved on."""
        return self.adhesion.zone

    @property
    def smallest_radius(self) -> float:
        """Smallest contact radius the condition is defined for: one zone, which then reaches the axis.

        At fixed stress a contact ends before if its zone is longer than at rest.
        """
        return self.adhesion.zone

    @property
    def reach(self) -> float:
        """Distance from the edge beyond which no field enters the condition."""
        return self.adhesion.zone if self.adhesion.stress is None else math.inf

    @property
    def rated(self) -> bool:
        """Whether an opening edge takes up what its speed tells."""
        return self.adhesion.rate is not None

    def zone_at(self, surface: Surface, body: Body) -> float:
        """Length of the process zone; at fixed stress at most the contact radius."""
        adhesion = self.adhesion
        if adhesion.stress is None:
            return adhesion.zone
        least = min(SHORTEST_ZONE * adhesion.zone, 0.5 * surface.radius)
        return zone_at(surface.edge_fields(), adhesion.stress, body.rheology.relaxed, body.transform, least)

    def closure(self, surface: Surface, body: Body) -> float:
        """The closure integral at an edge that has just moved to its present radius."""
        zone = self.zone_at(surface, body)
        within = surface.nodes_between(surface.radius - zone, surface.radius + zone)
        edge = surface.part(*within).edge_fields()
        return closure_integral(edge, zone, body.rheology.relaxed, body.transform)

    def residual(self, surface: Surface, body: Body, velocity: float = 0.0) -> float:
        """Residual at an edge that has just moved to its present radius; at rest that of opening.

        Parameters
        ----------
        surface : Surface
        body : Body
        velocity : float
            Rate of the radius.

        Returns
        -------
        float
            Dimensionless.
        """
        adhesion = self.adhesion
        taken = adhesion.closing if velocity > 0.0 else adhesion.opening(-velocity)
        return self.closure(surface, body) / taken - 1.0

    def driving_forces(self, surface: Surface, body: Body, at_once: bool = False) -> tuple[float, float]:
        """Inward and outward: what the integral exceeds opening by, and falls short of closing.

        It is continuous as the edge departs.

        Parameters
        ----------
        surface : Surface
        body : Body
        at_once : bool
            At fixed time, where the edge has no finite speed.

        Returns
        -------
        tuple of float
            Dimensionless; positive where the edge moves.
        """
        value = self.closure(surface, body)
        taken = self.adhesion.opening(math.inf) if at_once else self.adhesion.work
        return value / taken - 1.0, 1.0 - value / self.adhesion.closing


@dataclass(frozen=True)
class NoTension:
    """``-q(a)``: released where the edge would pull, covered where the indenter would overlap.

    Relative to the stress of the glass under ``|D| + |G(a)|``, whose difference it is: rounding is then as
    small a part of it in a contact that begins or ends as in the largest.
    """

    tolerance: ClassVar[float] = 1e-13
    zone_length: ClassVar[float] = 0.0
    reach: ClassVar[float] = 0.0
    smallest_radius: ClassVar[float] = 0.0
    rated: ClassVar[bool] = False

    @staticmethod
    def _relative(strain: float, surface: Surface, body: Body) -> float:
        """A strain of the glass at the edge over ``|D| + |G(a)|``."""
        scale = abs(surface.penetration) + abs(float(body.transform(surface.inside[-1:])[0]))
        return strain / scale if scale > 0.0 else 0.0

    def residual(self, surface: Surface, body: Body, velocity: float = 0.0) -> float:
        """Residual at an edge that has just moved to its present radius, at any velocity.

        Parameters
        ----------
        surface, body, velocity
            As of :meth:`Griffith.residual`.

        Returns
        -------
        float
            Dimensionless.
        """
        return self._relative(-surface.edge_stress(body) / body.rheology.glassy, surface, body)

    def driving_forces(self, surface: Surface, body: Body, at_once: bool = False) -> tuple[float, float]:
        """Tension at the edge, and overlap next to it; both negative while the edge is at rest.

        Parameters
        ----------
        surface, body, at_once
            As of :meth:`Griffith.driving_forces`.

        Returns
        -------
        tuple of float
            Dimensionless.
        """
        inward = self.residual(surface, body) if surface.radius > 0.0 else -1.0
        return inward, self._relative(surface.edge_overlap(body), surface, body)


EdgeCondition = Griffith | NoTension
