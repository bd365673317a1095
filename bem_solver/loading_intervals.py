"""The loading cut into smooth pieces: between kinks, requested times and sudden jumps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from contact_scene import Segment

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Piece:
    """A smooth stretch of loading, followed with a parameter from 0 to ``length``.

    For ordinary pieces the parameter is time; for a jump it runs from 0 to 1 while time stands still.
    ``fresh`` pieces start at a kink, so that nothing is known about rates.
    """

    control: str
    start: float
    end: float
    value: Callable[[float], float]
    jump: bool
    fresh: bool

    @property
    def length(self) -> float:
        """Extent of the parameter."""
        return 1.0 if self.jump else self.end - self.start

    def time(self, parameter: float) -> float:
        """Time at a parameter; the end exactly."""
        if self.jump or parameter >= self.length:
            return self.end
        return self.start + parameter

    def prescribed(self, parameter: float) -> float:
        """Penetration or force at a parameter."""
        return self.value(parameter if self.jump else self.time(parameter))

    @property
    def span(self) -> float:
        """By how much the prescribed quantity varies over the piece."""
        values = [self.prescribed(self.length * (k * _GOLDEN % 1.0)) for k in range(32)]
        values.append(self.prescribed(self.length))
        return max(values) - min(values)

    def bend(self, parameter: float, step: float, span: float) -> float:
        """Largest departure of the prescribed quantity from its chord over a step, in spans (0: none).

        Looked at where no oscillation has equal phases, so that whole periods are not stepped over.
        """
        if span == 0.0:
            return 0.0
        first, last = self.prescribed(parameter), self.prescribed(parameter + step)
        return (
            max(
                abs(self.prescribed(parameter + share * step) - first - share * (last - first))
                for share in (math.sqrt(2.0) - 1.0, _GOLDEN, math.e - 2.0)
            )
            / span
        )


def pieces(segment: Segment, reached: float, stops: tuple[float, ...]) -> Iterator[Piece]:
    """Pieces of one segment; ``reached`` is the controlled quantity before it, ``stops`` requested times."""
    first = segment.value(segment.start)
    if first != reached:
        yield Piece(
            segment.control,
            segment.start,
            segment.start,
            lambda share: reached + share * (first - reached),
            jump=True,
            fresh=True,
        )
    inner = {t for t in stops if segment.start < t < segment.end}
    times = sorted({segment.start, *segment.kinks, *inner, segment.end})
    for start, end in pairwise(times):
        fresh = start == segment.start or start in segment.kinks
        yield Piece(segment.control, start, end, segment.value, jump=False, fresh=fresh)
