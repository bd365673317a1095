"""Short-ranged adhesion: what the contact edge takes up, and over which length (paper, Eq. closure).

The closure integral ``I`` of the edge is an energy per area. An edge

- opens (recedes) where ``I`` reaches the work of adhesion ``work``, or ``w(v)`` at the speed ``v`` it has;
- closes (advances) where ``I`` falls to ``work_closing``;
- is pinned while ``I`` lies between the two.

The contact a run starts from has been made by closing; a flat face has touched as a whole. The speed ``v`` is
that at which the edge recedes; an edge that closes knows no speed.

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
from bisect import bisect_right
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from contact_scene.checked import Checked, Key, NotNegative, Positive, Tabulated, ZeroOrPositive
from contact_scene.errors import SceneError
from contact_scene.value_checks import LARGEST, SMALLEST, Range, positive


@dataclass(frozen=True)
class PowerRate(Checked):
    """``w(v) = work (1 + (v/speed)^exponent)``.

    A.N. Gent, J. Schultz, J. Adhesion 3, 281 (1972); D. Maugis, M. Barquins, J. Phys. D 11, 1989 (1978).

    Examples
    --------
    >>> cc.Adhesion(work=0.05, zone=1e-6, rate=cc.PowerRate(speed=1e-3, exponent=0.6)).rate
    PowerRate(speed=0.001, exponent=0.6)
    """

    speed: Annotated[
        Positive, Key("speed of the edge at which the work is twice that at rest", "length time-1")
    ]
    exponent: Annotated[float, Range("0.05 <= exponent <= 5", 0.05, 5.0), Key("exponent of the speed", "1")]

    def work(self, at_rest: float, speed: float) -> float:
        """Energy per area at which an edge opens at ``speed`` >= 0; infinite at infinite speed."""
        return at_rest * (1.0 + (speed / self.speed) ** self.exponent)


@dataclass(frozen=True)
class RateTable(Tabulated):
    """Works measured at speeds: straight from rest to the first row, in log-log between rows, then constant.

    ``speeds`` rise, ``works`` do not fall: an edge that takes less the faster it opens has no steady speed.

    Examples
    --------
    >>> cc.RateTable(speeds=(1e-6, 1e-3), works=(0.05, 0.5)).works
    (0.05, 0.5)
    """

    speeds: Annotated[tuple[Positive, ...], Key("speeds of the edge", "length time-1")]
    works: Annotated[tuple[Positive, ...], Key("works of adhesion at these speeds", "force length-1")]
    file: Annotated[str, Key("CSV file of speed, work")] = field(default="", compare=False)
    columns = ("speed", "work")
    least_rows = 1
    never_falls = "works that do not fall as the speed rises"

    def work(self, at_rest: float, speed: float) -> float:
        """Energy per area at which an edge opens at ``speed`` >= 0."""
        if speed >= self.speeds[-1]:
            return self.works[-1]
        if speed <= self.speeds[0]:
            return at_rest + (self.works[0] - at_rest) * speed / self.speeds[0]
        row = bisect_right(self.speeds, speed)
        slow, fast = self.speeds[row - 1], self.speeds[row]
        share = math.log(speed / slow) / math.log(fast / slow)
        return self.works[row - 1] * (self.works[row] / self.works[row - 1]) ** share


@dataclass(frozen=True)
class Adhesion(Checked):
    """Adhesion of the interface.

    The process zone is part of the model, not a numerical parameter: results converge with mesh and step
    at *fixed* zone, and its length sets the speed scale of the viscoelastic enhancement. With a cohesive
    ``stress`` it follows from that; ``zone`` is then the length at rest, which the scene sets.

    Examples
    --------
    >>> pinned = cc.Adhesion(work=0.05, zone=1e-6, work_closing=0.02)
    >>> pinned.work_closing
    0.02
    """

    work: Annotated[ZeroOrPositive, Key("work of adhesion at rest, of an opening edge", "force length-1")]
    zone: Annotated[NotNegative, Key("length of the process zone", "length")] = 0.0
    work_closing: Annotated[Positive | None, Key("the same of one that closes", "force length-1")] = None
    rate: Annotated[PowerRate | RateTable | None, Key("work of an opening edge against its speed")] = None
    stress: Annotated[Positive | None, Key("cohesive stress, instead of zone", "force length-2")] = None

    def rules(self) -> None:
        if self.stress is None:
            positive(self.zone, "zone")
        if self.work_closing is not None and self.work_closing > self.work:
            raise SceneError("work_closing", f"got {self.work_closing:g}", f"at most work = {self.work:g}")
        if self.rate is not None and self.work == 0.0:
            raise SceneError("rate", "given without adhesion", "work > 0 beside it")
        if isinstance(self.rate, RateTable) and self.rate.works[0] < self.work:
            problem = f"the slowest row has the work {self.rate.works[0]:g}, less than at rest"
            raise SceneError("rate", problem, f"works of at least work = {self.work:g}")

    @classmethod
    def table_rules(cls, table: dict[str, Any]) -> None:
        if "stress" in table and "zone" in table:
            raise SceneError("stress", "given beside zone", "either zone or stress")
        if "stress" not in table and "zone" not in table and "work" in table:
            raise SceneError("zone", "is missing", "a zone > 0, or a stress > 0 instead")

    def stated(self) -> dict[str, Any]:
        stated = super().stated()
        if self.stress is not None:
            del stated["zone"]
        return stated

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
            raise SceneError("stress", f"the process zone would be {zone:.4g}", positive.words)
        return replace(self, zone=zone)
