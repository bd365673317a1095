r"""Retraction of a contact whose short process zone opens steadily: one equation of motion for the radius.

Where the zone is short against the contact, the half-space outside the travelling field of the edge is
relaxed, and its energy release rate ``G(a, D)`` is the elastic one of the relaxed modulus. Within that field
the edge opens as one in an infinite body that has always moved at its present speed: it takes up the work of
adhesion at that speed times the enhancement of the steady crack (:mod:`validation.reference.steady_crack`),

    G(a, D) = w(v) f(da, v),    da = zone,  or  da = da_0 G/work at a fixed stress.

R.A. Schapery (Int. J. Fracture 11, 141, 1975) and B.N.J. Persson, E.A. Brener (Phys. Rev. E 71, 036123, 2005)
close their laws at a fixed stress in the same way. Solved for the speed, ``da/dt = -v(G(a, D))``.

**Where it holds.** What is left out is of the order of

- ``da/a`` and ``v theta/a``: zone, and travelling field of the slowest retardation time, over the radius;
- ``da |dv/dt|/v^2``: change of the speed while the edge passes its zone, about ``da/a`` where the speed
  changes over the whole retraction; it is large only where the edge sets out, over a few zones.

Both grow as the contact shrinks, and where the edge takes up much ``v theta/a`` is by far the larger: a scene
that is to follow the law ends soon after its largest tension, before the contact collapses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq

from contact_scene import Material
from validation.reference import steady_crack
from validation.reference.rated_edge import RatedEdge

_SLOWEST, _FASTEST = 1e-60, 1e60
"""Speeds between which the edge is sought, in zones at rest per shortest time: no law of a scene is wider."""


@dataclass(frozen=True)
class SteadyEdge(RatedEdge):
    """An opening edge with a short zone on a viscoelastic half-space; ``release_rate`` is the relaxed one."""

    material: Material

    def zone_at(self, release_rate: float) -> float:
        """Length of the process zone at an edge that takes up ``release_rate``."""
        adhesion = self.adhesion
        return adhesion.zone if adhesion.stress is None else adhesion.zone * release_rate / adhesion.work

    def enhancement(self, speed: float, release_rate: float) -> float:
        """``f``: what the half-space adds at a speed, where the zone is that of ``release_rate``."""
        return float(steady_crack.opening(self.material, self.zone_at(release_rate), speed))

    def taken(self, speed: float, release_rate: float) -> float:
        """``w(v) f(da, v)``: equal to ``release_rate`` where that is what drives an edge at ``speed``."""
        return self.adhesion.opening(speed) * self.enhancement(speed, release_rate)

    def speed(self, release_rate: float) -> float:
        """Speed at which the edge opens, 0 where it does not; infinite beyond the largest it can take up."""
        if release_rate <= self.adhesion.work:
            return 0.0
        unit = self.adhesion.zone / min(branch.time for branch in self.material.branches)
        low, high = math.log(_SLOWEST * unit), math.log(_FASTEST * unit)

        def excess(logarithm: float) -> float:
            return self.taken(math.exp(logarithm), release_rate) - release_rate

        if excess(low) >= 0.0:
            return 0.0
        if excess(high) <= 0.0:
            return math.inf
        return math.exp(brentq(excess, low, high, xtol=1e-13, rtol=1e-14))
