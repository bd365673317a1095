"""Motion of edge and penetration over one step, and what the square root outside the edge does on the way.

Where a step passes over process zones, the closure at its end is a condition on the speed of the edge there.
The path is the parabola through the edge at the last two rows and at the end of the step, a second-order
backward differentiation formula. Before a limit point the edge goes as the root of the time that is left:
there time is a parabola of the edge. All count from the end of the step backwards.

The load falls with the distance outside the edge as ``v(a) - v(a + x) = B(x) sqrt(x)``, and the edge carries
that along. Points outside feel ``int (exp(-(t_end - t)/theta) - even) dS(|r - a(t)|, t)`` along the path, by
parts; what remains is smooth in the root of the abscissa since the passage of the edge.
Displacement, load and penetration are positive downwards; radii from the axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

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
        position *= (len(self.distance) - 1) / math.log(self.distance[-1] / self.distance[0])
        first = np.minimum(position.astype(np.intp), table.shape[1] - 1)
        part = np.minimum(position - first, 1.0)
        # clipped: all indices are in range, and to check them takes three times as long
        strength, slope, *change = table.take(first, axis=1, mode="clip")
        strength += slope * part
        if change:
            strength += (change[0] + change[1] * part) * share
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


@dataclass(frozen=True)
class EarlierRow:
    """A row before the last, through which paths are parabolas: its time before the last, its penetration.

    With adhesion also its ``edge`` and its ``load``, ``v`` at a distance ``ahead`` outside the edge. Where
    the edge has a curved path, ``ahead`` is zero and ``fall`` that of the load outside the last row;
    ``runs_away`` tells whether that is one before a limit point.
    """

    time: float
    penetration: float
    edge: float | None = None
    load: float | None = None
    ahead: float = 0.0
    fall: OuterFall | None = None
    runs_away: bool = False


def _bent(x: Array, bend: float) -> Array:
    """``x + bend x (1 - x)``."""
    return x * (1.0 + bend * (1.0 - x))


def _unbent(y: Array, bend: float) -> Array:
    """``x`` of those, continued beyond [0, 1]."""
    root = np.sqrt(np.maximum((1.0 + bend) ** 2 - 4.0 * bend * y, 0.0))
    return 2.0 * y / (1.0 + bend + root)


def parabola_bend(earlier: tuple[float, float], value: float, duration: float, end: float) -> float:
    """``c`` of the parabola ``value + (end - value) s + c s (s - 1)`` over a share s of a step."""
    time, before = earlier
    return ((end - value) / duration - (value - before) / time) / (duration + time) * duration**2


@dataclass(frozen=True)
class BentPath:
    """Way of the edge to ``end``, over an abscissa x that goes from 1 to 0 in a step.

    With x still to come, ``x + bend x (1 - x)`` of its ``travel`` is, with the bend ``of_way``, and of the
    time, with that ``of_time``; one of them is zero. The earlier row lies by ``before`` beyond the start.
    """

    end: float
    travel: float
    of_way: float = 0.0
    of_time: float = 0.0
    before: float = 0.0

    @classmethod
    def straight(cls, edge: float, end: float) -> BentPath:
        """The path of constant speed."""
        return cls(end, end - edge)

    @classmethod
    def through(
        cls, earlier: tuple[float, float], edge: float, duration: float, end: float, runs_away: bool = False
    ) -> BentPath:
        """Through an earlier row (time before the last, edge) and both ends of a step."""
        time, place = earlier
        x, y, travel = 1.0 + time / duration, (end - place) / (end - edge), end - edge
        if runs_away and y > 1.0 and abs(bend := (x - y) / (y * (1.0 - y))) < _LARGEST_BEND:
            return cls(end, travel, of_time=bend, before=y - 1.0)
        bend = (y - x) / (x * (1.0 - x))
        return cls(end, travel, min(max(bend, -_LARGEST_BEND), _LARGEST_BEND), before=x - 1.0)

    def edge_on(self, abscissa: Array) -> Array:
        """Edge with so much of the abscissa still to come."""
        return self.end - self.travel * _bent(abscissa, self.of_way)

    def passage(self, radius: Array) -> Array:
        """Abscissa still to come when the edge passes a radius, continued beyond [0, 1]."""
        return _unbent((self.end - radius) / self.travel, self.of_way)

    def abscissa(self, left: Array) -> Array:
        """Abscissa still to come with a share of the step."""
        return _unbent(left, self.of_time)

    def time_left(self, abscissa: Array) -> Array:
        """Share of the step still to come with so much of the abscissa."""
        return _bent(abscissa, self.of_time)

    def pace(self, abscissa: Array) -> Array:
        """Rate of the time over the abscissa."""
        return 1.0 + self.of_time * (1.0 - 2.0 * abscissa)

    def edge(self, left: Array) -> Array:
        """Edge with a share of the step still to come."""
        return self.edge_on(self.abscissa(left))

    def left(self, radius: Array) -> Array:
        """Share of the step still to come when the edge passes a radius between its ends."""
        return self.time_left(np.minimum(np.maximum(self.passage(radius), 0.0), 1.0))

    def mean_since(self, left: Array) -> Array:
        """Mean speed from a share of the step still to come on, over the speed then."""
        x = self.abscissa(left)
        mean = (1.0 + self.of_way * (1.0 - x)) / (1.0 + self.of_time * (1.0 - x))
        return mean * self.pace(x) / (1.0 + self.of_way * (1.0 - 2.0 * x))


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

    def of(self, fall: Fall) -> Array:
        """The integral (m, K) of a fall."""
        at_ends = fall(*self._ends)
        left_of_begin = np.exp(self.y * (self.end - self.begin)) - self.even
        change = (1.0 - self.even) * at_ends[:, 1:] - left_of_begin * at_ends[:, :1]
        for some, lagging in self._laggings:
            change[:, some] -= lagging.lagging(fall)
        return change

    @cached_property
    def _ends_on(self) -> tuple[Array, Array]:
        """Abscissa to come at begin and end, each (m, 1)."""
        return self.path.abscissa(self.begin), self.path.abscissa(self.end)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Distance from the edge and abscissa gone by, at begin and end, each (m, 2)."""
        ends = np.concatenate(self._ends_on, axis=1)
        return np.abs(self.radius - self.path.edge_on(ends)), 1.0 - ends

    @cached_property
    def _laggings(self) -> list[tuple[NDArray[np.bool_], Lagging]]:
        """Of branches (K,) in which something is left of the begin, and of those that have forgotten it."""
        remembered = self.y * float((self.begin - self.end).max(initial=0.0)) <= _FORGOTTEN
        recent = np.minimum(self.begin, self.end + _FORGOTTEN / self.y[~remembered])
        parts = ((remembered, self.begin), (~remembered, recent))
        return [(some, Lagging.along(self, self.y[some], begin)) for some, begin in parts if some.any()]


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
    def along(cls, change: RecentChange, y: Array, begin: Array) -> Lagging:
        """From a share still to come to the end of a change."""
        path, (_, last) = change.path, change._ends_on
        first = path.abscissa(begin)
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
        left, z = path.time_left(abscissa), z * path.pace(abscissa)
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

    def stresses(self, chain: Chain, duration: float, radius: Array, end: Array) -> Array:
        """Scaled Maxwell stresses it leaves in points outside, beyond those of an even change."""
        share, y = (1.0 - end)[:, None], duration / chain.relaxation
        even = chain.spread(share * y)
        recent = RecentChange(self.path, radius[:, None], y, np.ones_like(share), end[:, None], even)
        bent = self.bend * share**2 * chain.spread_bent(share * y)
        return chain.stress_rate * (bent - recent.of(self.fall))


@dataclass(frozen=True)
class Motion:
    """One step: duration, edge and penetration at both ends, and the strength of the edge's square root.

    ``singular`` is the coefficient in ``v = ... - singular sqrt(r - a)``, taken at the start of the step.
    ``path`` is that of an edge whose speed is not constant, and ``fall`` then takes the place of the square
    root, or both None; ``load_rise`` and ``load_bend`` are R and c in the load at the edge of a path, or
    ahead of others, after a share s of its abscissa: ``... + R s + c s (s - 1)``. ``earlier`` is a row (time
    before the start, penetration) through which the penetration is a parabola, where it is prescribed its
    value within the step (time negative), or None where it is linear. ``carried`` is the displacement ahead
    of an edge that advances over process zones, where it is known. ``innermost`` (1 point) is the state of a
    point inside the edge throughout the step, without adhesion only: an adhesive edge that moves leaves
    behind the load that its singularity put there.
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

    @cached_property
    def way(self) -> BentPath:
        """The path of an edge that moves."""
        return self.path or BentPath.straight(self.edge, self.new_edge)

    def passing(self, radius: Array) -> tuple[Array, Array]:
        """Shares of the step before and after the edge passes radii between its ends."""
        after = self.way.left(radius)
        return 1.0 - after, after

    def recent(self, chain: Chain, radius: Array, begin: Array, end: Array) -> RecentChange:
        """What the fall along the path leaves in points outside, whatever that is."""
        y = self.duration / chain.retardation
        even = chain.spread((begin - end)[:, None] * y)
        return RecentChange(self.way, radius[:, None], y, begin[:, None], end[:, None], even)

    def lags_of_fall(self, chain: Chain, recent: RecentChange) -> Array:
        """Scaled lags (m, K) of ``v`` along the path, the load at the edge less its fall."""

        def lacking(distance: Array, come: Array) -> Array:
            fall = self.singular * np.sqrt(distance) if self.fall is None else self.fall(distance, come)
            return fall - come * (self.load_rise - self.load_bend * (1.0 - come))

        return -chain.lag_rate * recent.of(lacking)

    def lags_of_bend(self, chain: Chain) -> Array:
        """Scaled lags (K,) of the load near an edge at rest, beyond an even change."""
        return chain.lag_rate * self.load_bend * chain.spread_bent(self.duration / chain.retardation)

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
        parts = self.radius, self.height, self.variables, self.load, self.displacement
        return SurfacePoints(*(part[chosen] for part in parts))

    def __len__(self) -> int:
        return len(self.radius)
