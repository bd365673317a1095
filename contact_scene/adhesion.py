"""Short-ranged adhesion: what the contact edge takes up, and over which length (paper, Eq. closure).

The closure integral ``I`` of the edge is an energy per area. An edge

- opens (recedes) where ``I`` reaches the work of adhesion ``work``, or ``w(v)`` at the speed ``v`` it has;
- closes (advances) where ``I`` falls to ``work_closing``;
- is pinned while ``I`` lies between the two.

The contact a run starts from has been made by closing; a flat face has touched as a whole.

The process zone has a fixed length, ``zone``, or a fixed cohesive ``stress`` s, as in a Dugdale interface.
Its length ``da`` is then the one over which the tension of the sharp edge has the mean ``(4/pi) s``,

    ``int_0^da sigma(a - x) dx = (4/pi) s da``.

For ``sigma = K/sqrt(2 pi x)`` that is Dugdale's zone of small extent, ``da = (pi/8) (K/s)^2``: Maugis' width
``pi E* dg/(4 s^2)`` at rest, and that times the enhancement ``K^2/(2 E0* dg)`` where the edge opens steadily
(D.S. Dugdale, J. Mech. Phys. Solids 8, 100 (1960); R.A. Schapery, Int. J. Fracture 11, 141 (1975), for a
uniform stress; D. Maugis, J. Colloid Interface Sci. 150, 243 (1992)). A mean over the zone is what a zone of
that length sees; at an edge that advances slowly the singularity itself belongs to a much thinner layer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from contact_scene.edge_rate import PowerRate, RateTable
from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import LARGEST, POSITIVE, SMALLEST, not_negative, positive, zero_or_positive


@dataclass(frozen=True)
class Adhesion:
    """Adhesion of the interface.

    The process zone is part of the model, not a numerical parameter: results converge with mesh and step
    at *fixed* zone, and its length sets the speed scale of the viscoelastic enhancement.

    Parameters
    ----------
    work : float
        Work of adhesion, 0 or positive (energy per area), at which an edge opens that is at rest.
    zone : float
        Process-zone length > 0. With ``stress`` it is the length at rest, which the scene sets.
    work_closing : float, optional
        Energy per area, not above ``work``, at which an edge closes. Default: ``work``.
    rate : PowerRate or RateTable, optional
        Work of an opening edge against its speed. Default: ``work`` at any speed.
    stress : float, optional
        Cohesive stress of a process zone whose length follows from it, instead of ``zone``.
    """

    work: float
    zone: float = 0.0
    work_closing: float | None = None
    rate: PowerRate | RateTable | None = None
    stress: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "work", zero_or_positive(self.work, "work"))
        if self.stress is None:
            object.__setattr__(self, "zone", positive(self.zone, "zone"))
        else:
            object.__setattr__(self, "stress", positive(self.stress, "stress"))
            object.__setattr__(self, "zone", not_negative(self.zone, "zone"))
        if self.work_closing is not None:
            closing = positive(self.work_closing, "work_closing")
            if closing > self.work:
                raise SceneError("work_closing", f"got {closing:g}", f"at most work = {self.work:g}")
            object.__setattr__(self, "work_closing", closing)
        if self.rate is None:
            return
        if not isinstance(self.rate, (PowerRate, RateTable)):
            raise SceneError("rate", f"got {shown(self.rate)}", "a PowerRate, a RateTable or None")
        if self.work == 0.0:
            raise SceneError("rate", "given without adhesion", "work > 0 beside it")
        if isinstance(self.rate, RateTable) and self.rate.works[0] < self.work:
            problem = f"the slowest row has the work {self.rate.works[0]:g}, less than at rest"
            raise SceneError("rate", problem, f"works of at least work = {self.work:g}")

    @property
    def closing(self) -> float:
        """Energy per area at which an edge closes."""
        return self.work if self.work_closing is None else self.work_closing

    def opening(self, speed: float) -> float:
        """Energy per area at which an edge opens at ``speed`` >= 0."""
        return self.work if self.rate is None else self.rate.work(self.work, speed)

    @property
    def reversible(self) -> bool:
        """Whether an edge takes up the same in both directions and at any speed."""
        return self.rate is None and self.closing == self.work

    def zone_for(self, intensity_squared: float) -> float:
        """Length of a zone of fixed stress at an edge of stress intensity ``K``: ``(pi/8) (K/s)^2``."""
        if self.stress is None:
            return self.zone
        return math.pi * intensity_squared / (8.0 * self.stress**2)

    @property
    def closing_zone(self) -> float:
        """Length at rest of the zone of a closing edge: at fixed stress it goes with the energy."""
        return self.zone if self.stress is None or self.reversible else self.zone * (self.closing / self.work)

    def at_rest_on(self, plane_modulus: float) -> Adhesion:
        """The same with the zone it has at rest on an elastic body, ``pi E* work/(4 s^2)``."""
        if self.stress is None:
            return self
        zone = self.zone_for(2.0 * plane_modulus * self.work)
        if self.work > 0.0 and not SMALLEST <= zone <= LARGEST:
            raise SceneError("stress", f"the process zone would be {zone:.4g}", POSITIVE)
        return replace(self, zone=zone)
