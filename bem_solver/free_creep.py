"""The surface outside an edge that has not receded within a step: right whatever way and time it took.

By Eq. convolution the displacement ``w`` is everywhere that of a pressure ``q = int J* dp`` under unit plane
modulus. Where there was no pressure throughout the step, outside the edge at its end, ``q`` has crept freely:
the Voigt strains have decayed, each at its own rate. What all strains would have become in that way, the
field ``sum e exp(-y)``, therefore misses ``w`` by the displacement of a pressure inside the edge alone, and
is known there, where ``w`` is prescribed: one contact problem gives the rest outside.

Inside, that pressure follows an edge that passes as its inverse root, and the stress is ``int E* d`` of it:
the more relaxed, the longer the passage is past. Ahead, the displacement at both ends of the step is known,
and moves with the edge in between: what a point bears when it is covered relaxes from that, and hardly
depends on how well its strains are known; from these alone it would be ``Einf*/E0*`` times their error.
Displacement and penetration positive downwards, radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.bent_path import BentPath
from bem_solver.between_annuli import LoadBetween
from bem_solver.creep import Chain
from bem_solver.half_space_state import HalfSpaceState, points_at
from bem_solver.kinks import EdgeKinks
from bem_solver.motion import CarriedDisplacement, Motion, SurfacePoints
from bem_solver.outer_fall import OuterFall, distances_outside
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import displacement_outside

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FreeCreep:
    """The end of a step whose edge has not receded: ``pressed``, the surface under what free creep misses."""

    chain: Chain
    motion: Motion
    pressed: ContactSurface

    @staticmethod
    def takes(problem: Problem, motion: Motion) -> bool:
        """Whether a step is one over process zones, that takes time, of an edge that has not receded."""
        over_zones = problem.over_zones(motion.edge)
        return over_zones and motion.duration > 0.0 and motion.new_edge >= motion.edge > 0.0

    @classmethod
    def within(
        cls,
        problem: Problem,
        state: HalfSpaceState,
        motion: Motion,
        points: SurfacePoints,
        kinks: EdgeKinks | None,
        between: LoadBetween | None,
    ) -> FreeCreep | None:
        """Of a step over process zones; its motion then tells what its edge carries along.

        Parameters
        ----------
        problem : Problem
        state : HalfSpaceState
            Before the step.
        motion : Motion
        points : SurfacePoints
            Collocation radii inside the new edge, readings of the kinks, nodes between.
        kinks : EdgeKinks or None
        between : LoadBetween or None

        Returns
        -------
        FreeCreep or None
            ``None`` for any other step (:meth:`takes`).
        """
        if not cls.takes(problem, motion):
            return None
        missed = motion.new_penetration - points.height - _crept(problem.chain, points, motion)
        pressed = ContactSurface.under(problem.annuli, motion.new_edge, missed, kinks, between)
        creep = cls(problem.chain, motion, pressed)
        return creep if motion.new_edge == motion.edge else creep._carrying(problem, state)

    def _carrying(self, problem: Problem, state: HalfSpaceState) -> FreeCreep:
        """The same with the displacement that its edge carries along."""
        motion, distance = self.motion, np.append(0.0, distances_outside(self.motion.edge, problem.nearest))
        path = motion.path or BentPath.straight(motion.edge, motion.new_edge)
        before = points_at(problem, state, motion.edge + distance).displacement
        after = self.displacement(points_at(problem, state, motion.new_edge + distance))
        fall, new_fall = ((w[0] - w[1:]) / np.sqrt(distance[1:]) for w in (before, after))
        shares = np.array([0.0, 0.5, 1.0])
        start, middle, end = motion.penetration_at(shares) - problem.scene.indenter.height(
            path.edge(1.0 - shares)
        )
        bend = 2.0 * (start + end) - 4.0 * middle
        carried = CarriedDisplacement(path, OuterFall.between(distance[1:], fall, new_fall), float(bend))
        return replace(self, motion=replace(motion, carried=carried))

    def displacement(self, points: SurfacePoints) -> Array:
        """``w`` (m,) at the end of the step at points outside the edge."""
        return _crept(self.chain, points, self.motion) + self.pressed.outside(points.radius)

    def tension(self, distance: Array, otherwise: Array) -> Array:
        """Normal stress inside the edge, where that has passed within the step.

        Parameters
        ----------
        distance : ndarray (q,)
            From the edge at the end.
        otherwise : ndarray (q,)
            The stress as the surface at the end of the step has it.

        Returns
        -------
        ndarray (q,)
            Nearer than half the travel of the edge that of an inverse root that has come with it, behind
            the whole of it the other, in proportion between.
        """
        motion, carried = self.motion, self.motion.carried
        travel = motion.new_edge - motion.edge
        share = np.clip(2.0 * (travel - distance) / travel, 0.0, 1.0) if travel > 0.0 else 0.0 * distance
        if carried is None or not share.any():
            return otherwise
        _, left = motion.passing(motion.new_edge - distance)
        kept = 1.0 - carried.path.abscissa(left) * carried.growth
        slowed = np.sqrt(carried.path.mean_since(left))
        gained = 1.0 - kept * slowed, 1.0 - kept / slowed
        of_inverse_root, of_root = self.chain.moduli_of_passage(left * motion.duration, gained)
        singular, whole = self.pressed.singular_tension(distance), self.pressed.tension(distance)
        passed = of_inverse_root * singular + of_root * (whole - singular)
        return otherwise + share * (passed - otherwise)

    def settled(self, points: SurfacePoints, variables: Array, load: Array) -> Array:
        """Variables of points outside the edge at the end of the step, with their displacement.

        Parameters
        ----------
        points : SurfacePoints (m)
            At the start.
        variables : ndarray (m, K)
            At the end, as they follow from a load assumed in between.
        load : ndarray (m,)
            ``v`` at the end.

        Returns
        -------
        ndarray (m, K)
            Those of a load that is bent by a parabola as much as the displacement asks for.
        """
        chain = self.chain
        missed = self.displacement(points) - displacement_outside(chain, variables, load)
        lags = chain.lag_rate * chain.spread_bent(self.motion.duration / chain.retardation)
        return variables - (missed[:, None] * (lags / chain.lag(lags))) @ chain.rotation


def _crept(chain: Chain, points: SurfacePoints, motion: Motion) -> Array:
    """``sum e`` (m,) after free creep throughout a step."""
    strains = chain.to_strains(points.variables, points.load)
    return chain.lag(chain.decay(motion.duration / chain.retardation) * strains)
