"""The surface outside an edge that has not receded within a step: right whatever way and time it took.

By Eq. convolution the displacement ``w`` is everywhere that of a pressure ``q = int J* dp`` under unit plane
modulus. Where there was no pressure throughout the step, outside the edge at its end, ``q`` has crept freely:
the Voigt strains have decayed, each at its own rate. What all strains would have become in that way, the
field ``sum e exp(-y)``, therefore misses ``w`` by the displacement of a pressure inside the edge alone, and
is known there, where ``w`` is prescribed: one contact problem gives the rest outside.

Inside, that pressure follows an edge that passes as its inverse root, and the stress is ``int E* d`` of it:
the more relaxed, the longer the passage is past. Displacement and penetration positive downwards, radii from
the axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.between_annuli import LoadBetween
from bem_solver.creep import Chain
from bem_solver.half_space_state import HalfSpaceState
from bem_solver.kinks import EdgeKinks
from bem_solver.motion import Motion, SurfacePoints
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
        """Of a step over process zones.

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
            ``None`` if the edge has receded, has made contact first, or moves within a zone by few of them.
        """
        if motion.duration == 0.0 or not motion.new_edge >= motion.edge > 0.0:
            return None
        if not problem.over_zones(state.edge):
            return None
        missed = motion.new_penetration - points.height - _crept(problem.chain, points, motion)
        pressed = ContactSurface.under(problem.annuli, motion.new_edge, missed, kinks, between)
        return cls(problem.chain, motion, pressed)

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
        motion = self.motion
        travel = motion.new_edge - motion.edge
        share = np.clip(2.0 * (travel - distance) / travel, 0.0, 1.0) if travel > 0.0 else 0.0 * distance
        if not share.any():
            return otherwise
        _, left = motion.passing(motion.new_edge - distance)
        of_inverse_root, of_root = self.chain.moduli_of_passage(left * motion.duration)
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
            At the end, as they follow from a load of assumed course in between.
        load : ndarray (m,)
            ``v`` at the end.

        Returns
        -------
        ndarray (m, K)
            Those of a load whose course is bent by a parabola as much as the displacement asks for.
        """
        chain = self.chain
        missed = self.displacement(points) - displacement_outside(chain, variables, load)
        lags = chain.lag_rate * chain.spread_bent(self.motion.duration / chain.retardation)
        return variables - (missed[:, None] * (lags / chain.lag(lags))) @ chain.rotation


def _crept(chain: Chain, points: SurfacePoints, motion: Motion) -> Array:
    """``sum e`` (m,) after free creep throughout a step."""
    strains = chain.to_strains(points.variables, points.load)
    return chain.lag(chain.decay(motion.duration / chain.retardation) * strains)
