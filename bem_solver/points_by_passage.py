"""Surface points over one step, sorted by how the edge passes them.

Which recursion of ``surface_points`` a point follows depends on the radii of the edge at both ends of the
step alone. Trials of one edge therefore share what is sorted here, whatever penetration, load at the edge or
fall outside it they try.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.motion import Motion, Passage, SurfacePoints
from bem_solver.surface_points import along_path, covered, free, pressed, released

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def advanced(chain: Chain, points: SurfacePoints, motion: Motion, new_load: Array | None) -> Array:
    """Variables of any points at the end of the step.

    Parameters
    ----------
    chain : Chain
    points : SurfacePoints (m)
    motion : Motion
    new_load : ndarray (m,) or None
        ``v`` at the end, used outside the new edge only; ``None`` when all points are inside it.

    Returns
    -------
    ndarray (m, K)
    """
    by_passage = PointsByPassage(chain, points, motion)
    variables = by_passage.inside(motion)
    if new_load is not None:
        by_passage.fill_outside(variables, new_load)
    return variables


@dataclass(frozen=True)
class PointsByPassage:
    """Surface points (m), sorted by a motion of the edge."""

    chain: Chain
    points: SurfacePoints
    motion: Motion

    def inside(self, motion: Motion) -> Array:
        """Variables at the end of a motion of the same edge; those of points outside it are not filled.

        Parameters
        ----------
        motion : Motion
            May differ in penetration, load at the edge, fall outside it and displacement carried along.

        Returns
        -------
        ndarray (m, K)
        """
        variables = np.empty_like(self.points.variables)
        if not self._inside_after.any():
            return variables
        if self._stay.any():
            variables[self._stay] = self._pressed(motion)
        if self._covered.any():
            variables[self._covered] = covered(self.chain, self._covered_points, motion, self._passage)
        return variables

    def fill_outside(self, variables: Array, new_load: Array) -> None:
        """Fill in those of points outside the edge at the end of its motion.

        Parameters
        ----------
        variables : ndarray (m, K)
        new_load : ndarray (m,)
            ``v`` at the end.
        """
        chain, motion, after = self.chain, self.motion, self._inside_after
        leave, out = self._inside_before & ~self._stay, ~self._inside_before & ~after
        begin = np.ones(len(self.points))
        if leave.any():
            points = self.points[leave]
            passage = Passage(chain, points.radius, motion)
            variables[leave] = released(chain, points, motion, new_load[leave], passage)
            _, begin[leave] = passage.shares
        if out.any():
            variables[out] = free(chain, self.points[out], motion, new_load[out])
        if motion.path is not None:
            variables[~after] += along_path(chain, self.points[~after], motion, begin[~after])

    @cached_property
    def _inside_before(self) -> Mask:
        if self.motion.edge <= 0.0:
            return np.zeros(len(self.points), bool)
        return self.points.radius <= self.motion.edge

    @cached_property
    def _inside_after(self) -> Mask:
        return self.points.radius <= self.motion.new_edge

    @cached_property
    def _stay(self) -> Mask:
        """Which are inside all the time."""
        return self._inside_before & self._inside_after

    @cached_property
    def _covered(self) -> Mask:
        return self._inside_after & ~self._stay

    @cached_property
    def _covered_points(self) -> SurfacePoints:
        return self.points[self._covered]

    @cached_property
    def _passage(self) -> Passage:
        """Of the edge past the covered points."""
        return Passage(self.chain, self._covered_points.radius, self.motion)

    @cached_property
    def _staying_points(self) -> SurfacePoints:
        return self.points[self._stay]

    @cached_property
    def _pressed_to(self) -> dict[float, Array]:
        return {}

    def _pressed(self, motion: Motion) -> Array:
        """Variables of points inside all the time, which depend on the penetration alone."""
        depth, points = motion.new_penetration, self._staying_points
        if depth not in self._pressed_to:
            rise = depth - points.height - points.displacement
            variables = pressed(self.chain, points.variables, rise, motion.duration, motion.bend)
            self._pressed_to[depth] = variables
        return self._pressed_to[depth]
