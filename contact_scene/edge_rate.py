"""Work of adhesion of an opening edge as a function of its speed.

``speed`` is the speed at which the contact edge recedes, a length per time; an edge at rest opens at the
``work`` of the adhesion, which both laws start from. An edge that closes knows no speed: it closes at
``work_closing``.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, field
from itertools import pairwise

from contact_scene.errors import SceneError
from contact_scene.value_checks import a_string, as_tuple, number, positive

RATE_COLUMNS = ("speed", "work")
"""Columns of a file of such a table."""
_ROWS = "rows of two finite numbers: speed, work"


@dataclass(frozen=True)
class PowerRate:
    """``w(v) = work (1 + (v/speed)^exponent)``.

    A.N. Gent, J. Schultz, J. Adhesion 3, 281 (1972); D. Maugis, M. Barquins, J. Phys. D 11, 1989 (1978).
    """

    speed: float
    exponent: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", positive(self.speed, "speed"))
        exponent = number(self.exponent, "exponent", "0.05 <= exponent <= 5", low=0.05, high=5.0)
        object.__setattr__(self, "exponent", exponent)

    def work(self, at_rest: float, speed: float) -> float:
        """Energy per area at which an edge opens at ``speed`` >= 0; infinite at infinite speed."""
        return at_rest * (1.0 + (speed / self.speed) ** self.exponent)


@dataclass(frozen=True)
class RateTable:
    """Works measured at speeds: straight from rest to the first row, in log-log between rows, then constant.

    ``speeds`` rise, ``works`` do not fall: an edge that takes less the faster it opens has no steady speed.
    """

    speeds: tuple[float, ...]
    works: tuple[float, ...]
    file: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        a_string(self.file, "file")
        speeds = tuple(positive(v, "speeds") for v in as_tuple(self.speeds, "speeds", _ROWS))
        works = tuple(positive(w, "works") for w in as_tuple(self.works, "works", _ROWS))
        if not speeds or len(speeds) != len(works):
            raise SceneError(
                "works", f"{len(works)} values for {len(speeds)} speeds", "as many, at least one row"
            )
        for name, values, strictly in (("speed", speeds, True), ("work", works, False)):
            for index, (one, two) in enumerate(pairwise(values), 2):
                if two < one or (strictly and two == one):
                    rule = "speeds that rise" if strictly else "works that do not fall as the speed rises"
                    raise SceneError(name, f"row {index} has {two:g} after {one:g}", rule)
        object.__setattr__(self, "speeds", speeds)
        object.__setattr__(self, "works", works)

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
