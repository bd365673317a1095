"""What stays the same over a run: scene, material, discretisation, closure, and lengths that bound its steps.

Closure at the contact edge (paper, Eq. closure): ``I = (1/(2 da)) int_0^da sigma(a - s) g(a + da - s) ds =
dgamma``: the tension at distance s inside the edge meets the gap at distance da - s outside it. With ``s =
da sin^2(psi)`` the square-root ends become smooth. I > dgamma recedes, I < dgamma advances; the stable edge
is where I rises through dgamma with a. A compressive edge (kappa > 0) also has sigma g > 0, with both signs
wrong: it counts negative.

The velocity of the edge at the end of a step is the slope there of the parabola through the edge at both
ends and at the start of the step before, if there was one without a kink between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.body import Compliance
from bem_solver.creep import Chain
from bem_solver.options import DEFAULT_RESOLUTION
from contact_scene import Adhesion, Counters, Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ClosureRule:
    """Quadrature over the process zone: ``distance`` (q,) inside the edge in zones, and ``weight`` (q,)."""

    distance: Array
    weight: Array

    @classmethod
    def resolving(cls, divisions: int) -> ClosureRule:
        """A rule for a history held at ``divisions`` per zone."""
        nodes, weights = np.polynomial.legendre.leggauss(2 * divisions + 8)
        psi = 0.25 * np.pi * (nodes + 1.0)
        return cls(np.sin(psi) ** 2, 0.25 * np.pi * weights * np.sin(2.0 * psi))


_LONG_TRAVEL = 0.1
"""Part of the contact radius of which a step over zones takes the same fraction, at most: what acts at the
edge then changes little within it, and the loading mostly asks for shorter ones."""
_ZONES_RECEDING, _ZONES_ADVANCING = 2.0, 4.0
"""Process zones of which it takes the same fraction, at least, where its path is a parabola: half a zone
at the coarsest resolution, from where on errors fall with its square, and twice as much for an advancing
edge, whose closure hardly depends on its speed."""
_AHEAD = 0.25
"""Distance of the point whose load stands for that outside an edge that hardly moves, in process zones: the
layer at the edge itself changes at once where the edge turns. From a twentieth to the whole zone all is
alike."""
_NEAREST = 1e-3
"""Distance outside the edge, in process zones, nearer than which the load falls as its square root does."""
_SHARE_OF_LAYER = 0.5
"""Upper bound on it as a part of the layer in which the stress behind a slowly advancing edge relaxes, where
that is resolved: over its thickness the strength of the root changes."""
LONG_ZONE = 0.02
"""Process zone over contact radius below which a step may pass over process zones, and the field inside the
contact varies over its radius rather than over zones."""


@dataclass(frozen=True)
class Problem:
    """What stays the same over a run.

    ``length`` is that on which the edge is resolved in the largest contact, ``tolerance`` that of a step,
    ``divisions`` the number of steps in which the edge may travel the length it is resolved on, ``scale`` the
    order of magnitude of the largest contact radius, and ``layer`` the thickness of the thinnest boundary
    layer behind the edge that annuli resolve, zero without.
    """

    scene: Scene
    annuli: Annuli
    chain: Chain
    length: float
    counters: Counters
    rule: ClosureRule
    tolerance: float = 1.0
    divisions: int = DEFAULT_RESOLUTION
    scale: float = 1.0
    layer: float = 0.0

    @cached_property
    def zone(self) -> float:
        """Process zone, at fixed stress its length at rest; zero without adhesion."""
        return self.scene.adhesion.zone if self.scene.adhesion and self.scene.is_adhesive else 0.0

    @cached_property
    def work(self) -> float:
        """Work of adhesion; zero without."""
        return self.scene.adhesion.work if self.scene.adhesion and self.scene.is_adhesive else 0.0

    @cached_property
    def body(self) -> Compliance:
        """The body of the scene."""
        return Compliance.of(self.scene)

    @cached_property
    def viscoelastic(self) -> bool:
        """Whether the material has branches, so that the surface has a history."""
        return len(self.chain) > 0

    @property
    def irreversible(self) -> Adhesion | None:
        """The adhesion, if what the edge takes up depends on its direction or speed."""
        adhesion = self.scene.adhesion
        return adhesion if self.work > 0.0 and adhesion is not None and not adhesion.reversible else None

    @property
    def rated(self) -> bool:
        """Whether what the edge takes up follows its speed: its radius is then an integral over time."""
        return self.irreversible is not None and self.irreversible.rate is not None

    def length_at(self, edge: float) -> float:
        """Length on which the motion of an edge at radius ``edge`` is resolved."""
        return self.zone if self.work > 0.0 and self.viscoelastic else 0.25 * edge

    def longest_travel(self, edge: float, advancing: bool) -> float:
        """Length of which the edge at radius ``edge`` may pass a fraction in one step."""
        if not self.curves:
            return self.length_at(edge)
        zones = (_ZONES_ADVANCING if advancing else _ZONES_RECEDING) * self.zone
        return max(zones, _LONG_TRAVEL * edge) if self.over_zones(edge) else zones

    @property
    def ahead(self) -> float:
        """Distance outside the edge at which the load there is read."""
        return _AHEAD * self.zone

    @property
    def nearest(self) -> float:
        """Distance outside the edge from which on the strength of its square root is tabulated."""
        nearest = _NEAREST * self.zone
        return min(nearest, _SHARE_OF_LAYER * self.layer) if self.layer > 0.0 else nearest

    def over_zones(self, edge: float) -> bool:
        """Whether a step may pass over process zones."""
        return self.curves and self.zone < LONG_ZONE * edge

    @cached_property
    def curves(self) -> bool:
        """Whether the path of the edge is a parabola: with adhesion, where the surface has a history."""
        return self.work > 0.0 and self.viscoelastic


_LEAST_SLOPE = 0.01
"""Speed at the end of a step, relative to its mean, below which the parabola would turn the edge around."""


def end_velocity(edge: float, now: float, duration: float, before: tuple[float, float] | None) -> float:
    """Rate of the radius at the end of a step; ``before`` are duration and first edge of the one before."""
    if now == edge:
        return 0.0
    if duration <= 0.0:
        return math.copysign(math.inf, now - edge)
    mean = (now - edge) / duration
    if before is None or before[0] <= 0.0:
        return mean
    time, place = before
    earlier = (edge - place) / time
    slope = mean + (mean - earlier) * duration / (duration + time)
    return math.copysign(max(slope * math.copysign(1.0, mean), _LEAST_SLOPE * abs(mean)), mean)


def energy_taken(adhesion: Adhesion, velocity: float) -> float:
    """Energy per area that the edge takes up; at rest that at which it opens."""
    return adhesion.closing if velocity > 0.0 else adhesion.opening(-velocity)


def closure_of_departure(adhesion: Adhesion, closure: float, at_once: bool) -> float | None:
    """Closure at which an edge at rest sets off, the way it is driven; ``None`` if it rests.

    ``closure`` is the integral with the edge where it is; ``at_once`` at fixed time, where the edge has no
    finite speed.
    """
    if closure < adhesion.closing:
        return adhesion.closing
    opening = adhesion.opening(math.inf) if at_once else adhesion.work
    return opening if closure > opening else None
