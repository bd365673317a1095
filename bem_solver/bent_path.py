"""Path of the edge in a step that passes over process zones, and what its square root does on the way.

What the closure sees at the end of such a step was left behind within it, at times that follow from the path,
and the condition there is one on the speed of the edge. The path is the parabola through the edge at the last
two rows and at the end of the step: with rows of equal spacing its speed there is the second-order backward
differentiation formula. That of a receding edge is the cubic through one more row, of third order; the
closure of an advancing one hardly depends on its speed, so that the unevenness of more rows would come back
magnified. Before a limit point the edge goes as the root of the time that is left, which no polynomial
follows; there the time is one of the edge, and what acts at the edge follows its place. Times count from the
end of the step backwards, because what matters happens just before it: ``g`` is the share of the step still
to come.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bem_solver.outer_fall import OuterFall

Array = NDArray[np.float64]

_LARGEST_BEND = 0.99
"""Change of the speed within a step, relative to its mean over it: below 1 the edge does not turn."""
_NEWTON_STEPS = 4
"""For the share at which a cubic path passes a radius, from that of a parabola close to it."""


@dataclass(frozen=True)
class EarlierRow:
    """A row before the last, through which paths are parabolas: its time before the last, its penetration.

    With adhesion also its ``edge`` and its ``load``, ``v`` at a distance ``ahead`` outside the edge. Where
    the edge has a curved path, ``ahead`` is zero and ``fall`` that of the load outside the last row;
    ``further`` are time before the last and edge of the row before this one, where that path is a cubic, and
    ``of_travel`` tells whether it is one of the time over the edge.
    """

    time: float
    penetration: float
    edge: float | None = None
    load: float | None = None
    ahead: float = 0.0
    fall: OuterFall | None = None
    further: tuple[float, float] | None = None
    of_travel: bool = False


def _root_of_parabola(first: float, second: float, value: Array) -> Array:
    """Root near ``value/first`` of ``first x + second x**2 = value``, or where that comes nearest."""
    root = np.sqrt(np.maximum(first**2 + 4.0 * second * value, 0.0))
    return 2.0 * value / (first + np.copysign(root, first))


def parabola_bend(earlier: tuple[float, float], value: float, duration: float, end: float) -> float:
    """``c`` of the parabola ``value + (end - value) s + c s (s - 1)`` over a share s of a step.

    Parameters
    ----------
    earlier : tuple of float
        Time from an earlier row to the start of the step, and the value at that row.
    value : float
        At the start of the step.
    duration : float
    end : float
        Value at the end of the step.

    Returns
    -------
    float
    """
    time, before = earlier
    return ((end - value) / duration - (value - before) / time) / (duration + time) * duration**2


@dataclass(frozen=True)
class BentShare:
    """``y(x) = x + bend x (1 - x) + twist x (1 - x) (reach - x)``, rising from 0 to 1 as ``x`` does.

    The cubic part is zero at both ends of the step and at the row before, ``reach`` in units of the step.
    """

    bend: float = 0.0
    twist: float = 0.0
    reach: float = 1.0

    @classmethod
    def through(cls, earlier: Sequence[tuple[float, float]]) -> BentShare:
        """The parabola or cubic through (0, 0), (1, 1) and one or two earlier (x, y), the later first."""
        (reach, y), *further = earlier
        bend = (y - reach) / (reach * (1.0 - reach))
        bend = min(max(bend, -_LARGEST_BEND), _LARGEST_BEND)
        if not further:
            return cls(bend)
        ((x, y),) = further
        twist = (y - x - bend * x * (1.0 - x)) / (x * (1.0 - x) * (reach - x))
        limit = (_LARGEST_BEND - abs(bend)) / reach
        return cls(bend, min(max(twist, -limit), limit), reach)

    def mean(self, x: Array) -> Array:
        """``y/x``."""
        bend = self.bend if self.twist == 0.0 else self.bend + self.twist * (self.reach - x)
        return 1.0 + bend * (1.0 - x)

    def slope(self, x: Array) -> Array:
        """``dy/dx``."""
        bend = self.bend + self.twist * (self.reach - x)
        return 1.0 + bend * (1.0 - 2.0 * x) - self.twist * x * (1.0 - x)

    def at(self, x: Array) -> Array:
        """``y`` at shares ``x`` of any size."""
        return x * self.mean(x)

    def inverse(self, y: Array) -> Array:
        """``x`` of shares ``y``.

        Beyond [0, 1] continued by the parabola that follows it at that end; where it does not reach ``y``,
        the share at which it comes nearest.
        """
        if self.twist == 0.0:
            return _root_of_parabola(1.0 + self.bend, -self.bend, y)
        first = 1.0 + self.bend + self.twist * self.reach
        second = -self.bend - self.twist * (1.0 + self.reach)
        at_start = first + 2.0 * second + 3.0 * self.twist
        early = 1.0 + _root_of_parabola(at_start, second + 3.0 * self.twist, y - 1.0)
        late = _root_of_parabola(first, second, y)
        x = np.minimum(np.maximum(np.where(y > 0.5, early, late), 0.0), 1.0)
        for _ in range(_NEWTON_STEPS):
            missed = x * (first + x * (second + x * self.twist)) - y
            slope = first + x * (2.0 * second + 3.0 * x * self.twist)
            x = np.minimum(np.maximum(x - missed / slope, 0.0), 1.0)
        return np.where(y <= 0.0, late, np.where(y >= 1.0, early, x))


@dataclass(frozen=True)
class BentPath:
    """Way of the edge to ``end``: the share of its ``travel`` still to come over that of the time.

    ``share`` is the former over the latter, or, ``of_travel``, the latter over the former; what acts at the
    edge goes evenly with its travel then.
    """

    end: float
    travel: float
    share: BentShare = BentShare()
    of_travel: bool = False

    @classmethod
    def straight(cls, edge: float, end: float) -> BentPath:
        """The path of constant speed."""
        return cls(end, end - edge)

    @classmethod
    def through(
        cls,
        rows: Sequence[tuple[float, float]],
        edge: float,
        duration: float,
        end: float,
        of_travel: bool = False,
    ) -> BentPath:
        """The parabola, or the cubic, through earlier rows and both ends of a step.

        Parameters
        ----------
        rows : sequence of tuple of float
            One or two earlier rows, the later first: time until the start of the step, and the edge there.
        edge, duration, end : float
            Edge at the start, length of the step, and edge at its end.
        of_travel : bool, optional
            Whether the time is the polynomial, over the edge, if that has come the same way, and no more
            slowly than a parabola can: where it hardly moved, its load has changed with the time.

        Returns
        -------
        BentPath
        """
        travel = end - edge
        shares = [(1.0 + time / duration, (end - before) / travel) for time, before in rows]
        if of_travel and all(before > now for (_, before), (_, now) in pairwise([*shares[::-1], (1.0, 1.0)])):
            share = BentShare.through([(way, time) for time, way in shares])
            if abs(share.bend) < _LARGEST_BEND:
                return cls(end, travel, share, True)
        return cls(end, travel, BentShare.through(shares))

    def edge(self, left: Array) -> Array:
        """Edge with a share of the step still to come."""
        return self.edge_on(self.abscissa(left))

    def left(self, radius: Array) -> Array:
        """Share of the step still to come when the edge passes a radius.

        Beyond the step continued by parabolas, or, of a path of the travel, 0 and 1.
        """
        passage = self.passage(radius)
        return self.share.at(np.minimum(np.maximum(passage, 0.0), 1.0)) if self.of_travel else passage

    def mean_since(self, left: Array) -> Array:
        """Mean speed from a share of the step still to come on, over the speed then."""
        abscissa = self.abscissa(left)
        ratio = self.share.mean(abscissa) / self.share.slope(abscissa)
        return 1.0 / ratio if self.of_travel else ratio

    def abscissa(self, left: Array) -> Array:
        """Share still to come of what the path is a polynomial of, and loads go with: of travel or step."""
        return self.share.inverse(left) if self.of_travel else left

    def edge_on(self, abscissa: Array) -> Array:
        """Edge with a share of its abscissa still to come."""
        return self.end - self.travel * (abscissa if self.of_travel else self.share.at(abscissa))

    def passage(self, radius: Array) -> Array:
        """Share of the abscissa still to come when the edge passes a radius, continued beyond [0, 1]."""
        to_come = (self.end - radius) / self.travel
        return to_come if self.of_travel else self.share.inverse(to_come)
