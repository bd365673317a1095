"""The loading cut into smooth pieces: between kinks, requested times and sudden jumps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from scene import Segment


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
