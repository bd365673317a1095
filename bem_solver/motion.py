"""Motion of edge and penetration over one step, and what the square root outside the edge does on the way.

Where a step passes over process zones, what the closure sees at its end was left behind within it, at times
that follow from the path, and the condition there is one on the speed of the edge. The path is the parabola
through the edge at the last two rows and at the end of the step: with rows of equal spacing its speed there
is the second-order backward differentiation formula. That of a receding edge is the cubic through one more
row. Before a limit point the edge goes as the root of the time that is left, which no polynomial follows;
there the time is one of the edge, and what acts at the edge follows its place. Times count from the end of
the step backwards: ``g`` is the share of the step still to come.

The load falls with the distance outside the edge as ``v(a) - v(a + x) = B(x) sqrt(x)``, and the edge carries
that along. Points outside feel ``int (exp(-(t_end - t)/theta) - even) dS(|r - a(t)|, t)`` along the path, by
parts; what remains is smooth in the root of the abscissa (step or travel) from the passage of the edge.
Displacement, load and penetration are positive downwards; radii from the axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import SMALLEST, Chain
from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]

_FARTHEST = 1e4
"""Distance, in contact radii, at which the load has ended."""
_PER_DECADE = 128
"""Readings per decade of distance: straight lines miss B by 4e-5 of its bend over the logarithm of that. What
the table misses, unevenly from step to step, is an uneven speed of a fast edge, whose closure hardly depends
on it, and short steps are no more even."""


def distances_outside(edge: float, nearest: float) -> Array:
    """Distances (n,) outside a contact of some radius > 0 at which B is tabulated."""
    far = _FARTHEST * edge
    count = int(_PER_DECADE * np.log10(far / nearest))
    return nearest * (far / nearest) ** (np.arange(count) / count)


@dataclass(frozen=True)
class OuterFall:
    """B at both ends of a step, ``start`` and ``end`` (n,), at ``distance`` (n,) in equal ratios.

    In between it is linear in time; with the fall of the start alone the residual of a long step of an
    advancing edge has a second, false root.
    """

    distance: Array
    start: Array
    end: Array

    @classmethod
    def outside(cls, surface: ContactSurface, nearest: float) -> OuterFall:
        """The fall outside a contact of some radius > 0, the same at both ends."""
        distance = distances_outside(surface.edge, nearest)
        strength = _strength(surface, distance)
        return cls(distance, strength, strength)

    def towards(self, surface: ContactSurface) -> OuterFall:
        """The same start, and the fall outside another contact at the end."""
        return replace(self, end=_strength(surface, self.distance))

    @cached_property
    def _per_ratio(self) -> float:
        """Readings per unit of the logarithm of the distance."""
        return (len(self.distance) - 1) / math.log(self.distance[-1] / self.distance[0])

    @cached_property
    def _table(self) -> Array:
        """B at the start and to the next reading (2, n - 1); if it changes within the step, by how much."""
        rows = [self.start] if self.end is self.start else [self.start, self.end - self.start]
        return np.array([part for row in rows for part in (row[:-1], row[1:] - row[:-1])])

    def __call__(self, distance: Array, share: Array) -> Array:
        """``v(a) - v(a + x)`` at distances >= 0, after shares of the step; arguments broadcast."""
        table = self._table
        position = np.maximum(distance, self.distance[0])
        position /= self.distance[0]
        np.log(position, out=position)
        position *= self._per_ratio
        first = position.astype(np.intp)
        np.minimum(first, table.shape[1] - 1, out=first)
        position -= first
        part = np.minimum(position, 1.0, out=position)
        # clipped: all indices are in range, and to check them takes three times as long
        strength, slope, *change = table.take(first, axis=1, mode="clip")
        slope *= part
        strength += slope
        if change:
            gained, its_slope = change
            its_slope *= part
            gained += its_slope
            gained *= share
            strength += gained
        strength *= np.sqrt(distance)
        return strength


def _strength(surface: ContactSurface, distance: Array) -> Array:
    radius = np.empty(len(distance) + 1)
    radius[0] = surface.edge
    np.add(distance, surface.edge, out=radius[1:])
    load = surface.outside(radius)
    return (load[0] - load[1:]) / np.sqrt(distance)


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
    """``c`` of the parabola ``value + (end - value) s + c s (s - 1)`` over a share s of a step."""
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
        """``x`` of shares ``y``."""
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
        """The parabola, or the cubic, through earlier rows and both ends of a step."""
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
        """Share of the step still to come when the edge passes a radius."""
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


Fall = Callable[[Array, Array], Array]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
"""Quadrature over a step, exact to 1e-6 for one as long as nothing is forgotten in it."""
_FORGOTTEN = 36.0
"""Time, in retardation times, after which nothing is left of a lag: ``exp(-36)`` is rounding."""


@dataclass(frozen=True)
class RecentChange:
    """Between two shares of a step still to come, at radii that the edge does not pass between them.

    ``radius``, ``begin`` and ``end`` are (m, 1), ``y`` (K,) is the step in retardation times, and ``even``
    what is left of an even change, which does not count.
    """

    path: BentPath
    radius: Array
    y: Array
    begin: Array
    end: Array
    even: Array | float = 0.0

    @classmethod
    def along(
        cls, path: BentPath, radius: Array, y: Array, begin: Array, end: Array, even: Array | float = 0.0
    ) -> RecentChange:
        """Of a path."""
        return cls(path, radius[:, None], y, begin[:, None], end[:, None], even)

    def of(self, fall: Fall) -> Array:
        """The integral (m, K) of a fall."""
        y, (distance, come) = self.y, self._ends
        at_ends = fall(distance, come)
        left_of_begin = self._left_of_begin - self.even
        change = (1.0 - self.even) * at_ends[:, 1:] - left_of_begin * at_ends[:, :1]
        remembered = self._remembered
        if remembered.all():
            return change - self._whole.lagging(fall)
        if remembered.any():
            change[:, remembered] -= Lagging.along(self, y[remembered], self._first).lagging(fall)
        forgets = ~remembered
        if forgets.any():
            since = self.path.abscissa(np.minimum(self.begin, self.end + _FORGOTTEN / y[forgets]))
            change[:, forgets] -= Lagging.along(self, y[forgets], since).lagging(fall)
        return change

    @cached_property
    def _first(self) -> Array:
        """Abscissa to come at the begin (m, 1)."""
        return self.path.abscissa(self.begin)

    @cached_property
    def last(self) -> Array:
        """Abscissa to come at the end (m, 1)."""
        return self.path.abscissa(self.end)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Distance from the edge and abscissa gone by, at begin and end, each (m, 2)."""
        ends = np.concatenate((self._first, self.last), axis=1)
        return np.abs(self.radius - self.path.edge_on(ends)), 1.0 - ends

    @cached_property
    def _left_of_begin(self) -> Array:
        return np.exp(self.y * (self.end - self.begin))

    @cached_property
    def _remembered(self) -> NDArray[np.bool_]:
        """Branches (K,) in which something is left of the begin."""
        return self.y * float((self.begin - self.end).max(initial=0.0)) <= _FORGOTTEN

    @cached_property
    def _whole(self) -> Lagging:
        return Lagging.along(self, self.y, self._first)


@dataclass(frozen=True)
class Lagging:
    """``int S(|r - a(t)|, t) d exp(-(t_end - t)/theta)`` between two shares of the abscissa to come.

    Read at ``distance`` from the edge and abscissa ``come``, each (m, k, points); k is 1, or K where the
    branches do not all begin at once: to read the fall is what costs.
    """

    distance: Array
    come: Array
    z: Array
    memory: Array
    scale: Array

    @classmethod
    def along(cls, change: RecentChange, y: Array, first: Array) -> Lagging:
        """From a share of the abscissa to the end of a change."""
        path, last = change.path, change.last
        passage = path.passage(change.radius)
        before = passage >= 0.5 * (first + last)  # the passage lies before, not after
        away = np.where(before, -1.0, 1.0)
        nearest = np.where(before, np.minimum(first, passage), np.maximum(last, passage))
        near = np.sqrt(away * (nearest - passage))
        # from the nearest share, not from the passage: an edge that hardly moves passes 1e16 steps away
        ways = np.maximum(away * (np.where(before, last, first) - nearest), 0.0)
        reach = ways / np.maximum(near + np.sqrt(near**2 + ways), SMALLEST)
        beyond = reach[..., None] * (0.5 * (_NODES + 1.0))
        z = near[..., None] + beyond
        abscissa = nearest[..., None] + away[..., None] * beyond * (near[..., None] + z)
        distance = np.abs(change.radius[..., None] - path.edge_on(abscissa))
        left = abscissa
        if path.of_travel:
            left = path.share.at(abscissa)
            z = z * path.share.slope(abscissa)
        memory = np.exp(y[:, None] * (change.end[..., None] - left))  # (m, K, points)
        return cls(distance, 1.0 - abscissa, z, memory, y * reach)

    def lagging(self, fall: Fall) -> Array:
        """The integral (m, K) of a fall."""
        values = fall(self.distance, self.come) * self.z
        return self.scale * ((values * self.memory) @ _WEIGHTS)


_ROUNDING = 1e-14
"""Bend of the path of the penetration, relative to it, that is rounding: that of a ramp."""


@dataclass(frozen=True)
class CarriedDisplacement:
    """Displacement ahead of an advancing edge: at the edge less a fall that moves with it.

    ``bend`` is ``c`` in the displacement at the edge after a share s of the step: ``... + c s (s - 1)``.
    """

    path: BentPath
    fall: OuterFall
    bend: float

    @property
    def growth(self) -> float:
        """Part of its strength at the edge that the fall has gained over the step, from -1 to 1."""
        start, end = float(self.fall.start[0]), float(self.fall.end[0])
        return min(max(1.0 - start / end, -1.0), 1.0) if end != 0.0 else 0.0

    def stresses(self, chain: Chain, duration: float, radius: Array, end: Array) -> Array:
        """Scaled Maxwell stresses it leaves in points outside, beyond those of an even change."""
        share, y = (1.0 - end)[:, None], duration / chain.relaxation
        even = chain.spread(share * y)
        change = RecentChange.along(self.path, radius, y, np.ones_like(end), end, even).of(self.fall)
        return chain.stress_rate * (self.bend * share**2 * chain.spread_bent(share * y) - change)


@dataclass(frozen=True)
class Motion:
    """One step: duration, edge and penetration at both ends, and the strength of the edge's square root.

    ``singular`` is the coefficient in ``v = ... - singular sqrt(r - a)``, taken at the start of the step.
    ``path`` is that of an edge whose speed is not constant, and ``fall`` then takes the place of the square
    root, or both None; ``load_rise`` and ``load_bend`` are R and c in the load at the edge of a path, or
    ahead of others, after a share s of the step, or of the travel: ``... + R s + c s (s - 1)``.
    ``earlier`` a row (time before the start, penetration) through which the penetration is a parabola, where
    it is prescribed its value within the step (time negative), or None where it is linear.
    ``carried`` is the displacement ahead of an edge that advances over process zones, where it is known.
    ``innermost`` (1 point) the state of a point inside the edge throughout the step. It is given
    without adhesion only: an adhesive edge that moves leaves behind the load that its singularity put there.
    """

    duration: float
    edge: float
    new_edge: float
    penetration: float
    new_penetration: float
    singular: float = 0.0
    innermost: SurfacePoints | None = None
    path: BentPath | None = None
    fall: OuterFall | None = None
    earlier: tuple[float, float] | None = None
    load_rise: float = 0.0
    load_bend: float = 0.0
    carried: CarriedDisplacement | None = None

    @cached_property
    def bend(self) -> float:
        """``c`` in the penetration ``D + (D' - D) s + c s (s - 1)`` after a share s of the step."""
        if self.earlier is None or self.duration == 0.0:
            return 0.0
        bend = parabola_bend(self.earlier, self.penetration, self.duration, self.new_penetration)
        rounding = _ROUNDING * max(abs(self.penetration), abs(self.new_penetration))
        return bend if abs(bend) > rounding else 0.0

    def passing(self, radius: Array) -> tuple[Array, Array]:
        """Shares of the step before and after the edge passes radii between its ends, neither rounded."""
        if self.path is None:
            before = (radius - self.edge) / (self.new_edge - self.edge)
            before = np.minimum(np.maximum(before, 0.0), 1.0)
            return before, 1.0 - before
        after = np.minimum(np.maximum(self.path.left(radius), 0.0), 1.0)
        return 1.0 - after, after

    def recent(self, chain: Chain, radius: Array, begin: Array, end: Array) -> RecentChange:
        """What the fall along the path leaves in points outside, whatever that is."""
        assert self.path is not None
        y = self.duration / chain.retardation
        even = chain.spread((begin - end)[:, None] * y)
        return RecentChange.along(self.path, radius, y, begin, end, even)

    def lags_of_fall(self, chain: Chain, recent: RecentChange) -> Array:
        """Scaled lags (m, K) of ``v`` along the path, the load at the edge less its fall."""
        path, fall = self.path, self.fall
        assert path is not None
        assert fall is not None

        def lacking(distance: Array, come: Array) -> Array:
            return fall(distance, come) - come * (self.load_rise - self.load_bend * (1.0 - come))

        if path.of_travel:
            return -chain.lag_rate * recent.of(lacking)
        share = (recent.begin - recent.end)[:, 0]
        return self.lags_of_bend(chain, share) - chain.lag_rate * recent.of(fall)

    def lags_of_bend(self, chain: Chain, share: Array) -> Array | float:
        """Scaled lags of the load near the edge, beyond an even change, over a share (m,) of the step."""
        if self.load_bend == 0.0:
            return 0.0
        y = share[:, None] * self.duration / chain.retardation
        return chain.lag_rate * self.load_bend * share[:, None] ** 2 * chain.spread_bent(y)

    def penetration_at(self, share: Array) -> Array:
        """Penetration after a share of the step."""
        linear = self.penetration + share * (self.new_penetration - self.penetration)
        return linear if self.earlier is None else linear - self.bend * share * (1.0 - share)


@dataclass(frozen=True)
class Passage:
    """When the edge passes points at radii (m,) between its ends: the same in all motions of one edge."""

    chain: Chain
    radius: Array
    motion: Motion

    @cached_property
    def shares(self) -> tuple[Array, Array]:
        """Shares of the step before and after the passage, (m,) each."""
        return self.motion.passing(self.radius)

    @cached_property
    def recent(self) -> RecentChange:
        """What the fall along the path of an advancing edge leaves in the points until it passes them."""
        _, after = self.shares
        return self.motion.recent(self.chain, self.radius, np.ones_like(after), after)


@dataclass(frozen=True)
class SurfacePoints:
    """Radii (m,), indenter heights there, and their state at the start of the step.

    ``variables`` (m, K) are scaled Maxwell stresses, ``load`` the displacement ``v`` at unit modulus and
    ``displacement`` ``w``, each (m,).
    """

    radius: Array
    height: Array
    variables: Array
    load: Array
    displacement: Array

    def __getitem__(self, chosen: NDArray[np.bool_] | slice) -> SurfacePoints:
        if not isinstance(chosen, slice) and chosen.all():
            return self
        return SurfacePoints(
            self.radius[chosen],
            self.height[chosen],
            self.variables[chosen],
            self.load[chosen],
            self.displacement[chosen],
        )

    def __len__(self) -> int:
        return len(self.radius)
