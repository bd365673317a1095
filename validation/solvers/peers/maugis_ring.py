"""Adhesion: its Maugis-Dugdale solution, a cohesive ring of constant stress around the contact."""

from __future__ import annotations

import numpy as np

from contact_scene import Scene, Trace
from validation.solvers.peers.elastic_retraction import ElasticRetraction, radii, retraction, stated
from validation.solvers.run_options import RunOptions

ROWS = 600
"""Contact radii at which the equilibrium is computed."""


class MaugisRing(ElasticRetraction):
    """``resolution`` is Maugis' transition parameter: the larger, the shorter the range of attraction."""

    name = "maugis-dugdale"
    title = "Adhesion: Maugis-Dugdale"
    solution = "MaugisDugdale"

    def transition(self, resolution: int | None) -> float:
        """The resolution."""
        return float(resolution or 5)

    def default_resolution(self, scene: Scene) -> int:
        """5: hardly longer a range than that of Johnson, Kendall and Roberts."""
        return 5

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        from scipy.optimize import brentq

        sphere, modulus, work = stated(scene)
        equilibrium = self.formulas().load_and_displacement
        unit = (np.pi * work * (4.0 * modulus / 3.0) ** 2 / sphere) ** (1.0 / 3.0)
        law = sphere, modulus, work, 0.5 * self.transition(resolution) * unit
        depth_now = scene.loading.penetration
        largest = 3.0 * (np.sqrt(sphere * max(depth_now, 0.0)) + np.cbrt(work * sphere**2 / modulus))

        def excess(radius: float) -> float:
            return float(equilibrium(np.array([radius]), *law)[1][0]) - depth_now

        coarse = np.linspace(1e-3 * largest, largest, 60)
        below = np.flatnonzero(equilibrium(coarse, *law)[1] < depth_now)[-1]
        radius = radii(brentq(excess, coarse[below], coarse[below + 1], xtol=1e-14 * largest), ROWS)
        force, depth = equilibrium(radius, *law)
        return retraction(self, scene, radius, depth, force)
