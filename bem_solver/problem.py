"""What stays the same over a run: scene, material, discretisation, and the lengths that bound its steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from bem_solver.annuli import Annuli
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from contact_scene import Adhesion, Counters, Scene

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

    ``zone`` (at fixed stress its length at rest) and ``work`` are zero without adhesion; ``length`` is the
    length on which the edge is resolved in the largest contact; ``layer`` the thickness of the thinnest
    boundary layer behind the edge that annuli resolve, zero without.
    """

    scene: Scene
    annuli: Annuli
    chain: Chain
    zone: float
    work: float
    length: float
    counters: Counters
    rule: ClosureRule
    layer: float = 0.0

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
        """Length on which the motion of an edge at radius ``edge`` is resolved.

        The zone, over which the history sees the edge come and go; a quarter of the radius without adhesion,
        and in an elastic contact, whose states are equilibria by themselves.
        """
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

    def relaxes_within(self, duration: float) -> bool:
        """Whether a step is long against a branch: points it covers then feel the whole fall of the load."""
        return bool(duration > self.chain.retardation.min(initial=math.inf))

    def over_zones(self, edge: float) -> bool:
        """Whether a step may pass over process zones."""
        return self.curves and self.zone < LONG_ZONE * edge

    @cached_property
    def curves(self) -> bool:
        """Whether the path of the edge is a parabola: with adhesion, where the surface has a history."""
        return self.work > 0.0 and self.viscoelastic
