"""The prescribed quantity of a step: the surface at its end, and what goes with the edge on the way.

What the edge covers and leaves depends on the load at the edge, or just ahead of one that hardly moves, and
on how that falls outside it, during the step. Both are known at its start; at its end they are
those of the surface that is sought. Penetration and surface displacement positive downwards, force and
pressure positive in compression; radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.bent_path import EarlierRow, parabola_bend
from bem_solver.between_annuli import LoadBetween
from bem_solver.free_creep import FreeCreep
from bem_solver.half_space_state import HalfSpaceState
from bem_solver.kinks import EdgeKinks
from bem_solver.motion import Motion, SurfacePoints
from bem_solver.points_by_passage import PointsByPassage
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import load_inside

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LoadControl:
    """``control`` has ``value`` at the end of the step.

    ``points`` are the collocation radii inside the new edge, and behind them the readings of ``kinks`` and
    the nodes ``between``; ``earlier`` is a row before the last, where the edge or its load has a curved path.
    """

    problem: Problem
    state: HalfSpaceState
    points: SurfacePoints
    kinks: EdgeKinks | None
    control: str
    value: float
    earlier: EarlierRow | None = None
    between: LoadBetween | None = None
    _creep: dict[float, FreeCreep | None] = field(default_factory=dict)
    _by_passage: dict[float, PointsByPassage] = field(default_factory=dict)

    def satisfied(self, motion: Motion) -> tuple[Motion, ContactSurface]:
        """Motion with the penetration and the end that belong to the control, and its surface."""
        motion, surface = self._controlled(motion)
        if FreeCreep.takes(self.problem, motion):
            return self._ending(motion, surface), surface
        if motion.fall is None and (self.earlier is None or self.earlier.edge is None):
            return motion, surface
        motion = self._ending(motion, surface)
        if motion.new_edge <= motion.edge:
            return motion, surface
        return self._controlled(motion) if motion.fall is None else self._settled(motion, surface)

    def creep(self, motion: Motion) -> FreeCreep | None:
        """What free creep tells of a motion; within a step their penetration alone differs."""
        depth = motion.new_penetration
        if depth not in self._creep:
            self._creep[depth] = FreeCreep.within(
                self.problem, self.state, motion, self.points, self.kinks, self.between
            )
        return self._creep[depth]

    def _settled(self, motion: Motion, surface: ContactSurface) -> tuple[Motion, ContactSurface]:
        """Motion and surface of an advancing edge.

        The end of the load at the edge is that of the surface before, once improved.
        """
        one, second = self._controlled(motion)
        two, third = self._controlled(self._ending(one, second))
        return self._ending(two, third), third

    def _ending(self, motion: Motion, surface: ContactSurface) -> Motion:
        """The motion whose end is that of a surface."""
        fall = None if motion.fall is None else motion.fall.towards(surface)
        rise, bend = self._load_rise_and_bend(motion, surface)
        return replace(motion, fall=fall, load_rise=rise, load_bend=bend)

    def _load_rise_and_bend(self, motion: Motion, surface: ContactSurface) -> tuple[float, float]:
        """Rise and bend of the load through the earlier row: at the edge of its path, or ahead of others."""
        earlier, path = self.earlier, motion.path
        if earlier is None or earlier.load is None or (path is not None and earlier.fall is None):
            return 0.0, 0.0
        start, end = (of.load_ahead(earlier.ahead) for of in (self.state.surface, surface))
        if path is not None and path.of_travel and earlier.edge is not None:
            ago = (motion.edge - earlier.edge) / path.travel
            return end - start, parabola_bend((ago, earlier.load), start, 1.0, end)
        return end - start, parabola_bend((earlier.time, earlier.load), start, motion.duration, end)

    def _controlled(self, motion: Motion) -> tuple[Motion, ContactSurface]:
        """Motion with the penetration, and surface, that the control asks for."""
        self.problem.counters.linear_solves += 1
        if self.control == "penetration":
            if motion.new_penetration != self.value:
                motion = replace(motion, new_penetration=self.value)
            return motion, self._surface(motion)
        # everything is affine in the new penetration
        start = self.state.penetration
        highest = float(self.points.height.max(initial=0.0))  # a shorter step would be lost in its force
        step = max(abs(start), 1e-3 * motion.new_edge, 1e-6 * highest)
        first = replace(motion, new_penetration=start)
        one, two = self._surface(first), self._surface(replace(first, new_penetration=start + step))
        lacking, gained = self.value - one.force, two.force - one.force
        if self.control == "stage":  # D + F/k
            compliance = self.problem.scene.loading.compliance
            lacking = self.value - (first.new_penetration + compliance * one.force)
            gained = step + compliance * gained
        share = lacking / gained
        return replace(first, new_penetration=start + share * step), one.towards(two, share)

    def _surface(self, motion: Motion) -> ContactSurface:
        """The surface after a motion whose penetration is known."""
        creep = self.creep(motion)
        load = self._required_load(motion if creep is None else creep.motion)
        return ContactSurface.under(self.problem.annuli, motion.new_edge, load, self.kinks, self.between)

    def _required_load(self, motion: Motion) -> Array:
        """``v`` at radii inside the new edge."""
        problem, wanted = self.problem, motion.new_penetration - self.points.height
        if not problem.viscoelastic:
            return problem.chain.relaxed * wanted
        problem.counters.history_updates += 1
        if motion.new_edge not in self._by_passage:
            self._by_passage[motion.new_edge] = PointsByPassage(problem.chain, self.points, motion)
        return load_inside(problem.chain, self._by_passage[motion.new_edge].inside(motion), wanted)
