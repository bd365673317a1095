"""Motion of edge and penetration over one step, and the surface points that it takes along.

Displacement, load and penetration are positive downwards; radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.bent_path import BentPath, parabola_bend
from bem_solver.creep import Chain
from bem_solver.outer_fall import OuterFall
from bem_solver.recent_change import RecentChange

Array = NDArray[np.float64]

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
        """Scaled Maxwell stresses it leaves in points outside, beyond those of an even change.

        Parameters
        ----------
        chain : Chain
        duration : float
            Of the step.
        radius : ndarray (m,)
        end : ndarray (m,)
            Share of the step still to come, up to which they are outside.

        Returns
        -------
        ndarray (m, K)
        """
        share, y = (1.0 - end)[:, None], duration / chain.relaxation
        recent = RecentChange.along(self.path, radius, y, np.ones_like(end), end)
        change = recent.of(self.fall, chain.spread(share * y))
        return chain.stress_rate * (self.bend * share**2 * chain.spread_bent(share * y) - change)


@dataclass(frozen=True)
class RecentLags:
    """Share (m,) of a step that is looked at, what is left of an even change (m, K), and of any fall."""

    share: Array
    even: Array
    change: RecentChange


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

    def recent(self, chain: Chain, radius: Array, begin: Array, end: Array) -> RecentLags:
        """What the fall along the path leaves in points outside, whatever that is.

        Parameters
        ----------
        chain : Chain
        radius : ndarray (m,)
        begin, end : ndarray (m,)
            Shares of the step still to come.

        Returns
        -------
        RecentLags
        """
        if self.path is None:
            raise ValueError("the edge has no path")
        y = self.duration / chain.retardation
        even = chain.spread((begin - end)[:, None] * y)
        return RecentLags(begin - end, even, RecentChange.along(self.path, radius, y, begin, end))

    def lags_of_fall(self, chain: Chain, recent: RecentLags) -> Array:
        """Scaled lags (m, K) of ``v`` along the path, the load at the edge less its fall.

        Beyond those of an even change.
        """
        path, fall = self.path, self.fall
        if path is None or fall is None:
            raise ValueError("the edge has no path")

        def lacking(distance: Array, come: Array) -> Array:
            return fall(distance, come) - come * (self.load_rise - self.load_bend * (1.0 - come))

        if path.of_travel:
            return -chain.lag_rate * recent.change.of(lacking, recent.even)
        change = -recent.change.of(fall, recent.even)
        return chain.lag_rate * change + self.lags_of_bend(chain, recent.share)

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
    def recent(self) -> RecentLags:
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
