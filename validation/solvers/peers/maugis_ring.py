"""Adhesion: its Maugis-Dugdale solution, a cohesive ring of constant stress around the contact."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from contact_scene import Scene, Sphere, Trace
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer
from validation.solvers.peers.sharp_edge import retraction, retraction_only

ROWS = 600
"""Contact radii at which the equilibrium is computed."""


class MaugisRing(Peer):
    """``resolution`` is Maugis' transition parameter: the larger, the shorter the range of attraction."""

    name = "maugis-dugdale"
    title = "Adhesion: Maugis-Dugdale"
    distribution = module = "Adhesion"
    columns = ("time", "penetration", "force", "contact_radius")

    def outside(self, scene: Scene) -> str:
        """All but a single retraction of an elastic, adhesive sphere to pull-off."""
        return retraction_only(scene)

    def transition(self, resolution: int | None) -> float:
        """The resolution."""
        return float(resolution or 5)

    def default_resolution(self, scene: Scene) -> int:
        """5: hardly longer a range than that of Johnson, Kendall and Roberts."""
        return 5

    def load(self) -> None:
        """Import the solution."""
        from Adhesion.ReferenceSolutions import MaugisDugdale  # noqa: F401

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        from Adhesion.ReferenceSolutions import MaugisDugdale

        assert isinstance(scene.indenter, Sphere)
        assert scene.adhesion is not None
        modulus, sphere, work = (
            scene.material.relaxed_plane_modulus,
            scene.indenter.radius,
            scene.adhesion.work,
        )
        unit = (np.pi * work * (4.0 * modulus / 3.0) ** 2 / sphere) ** (1.0 / 3.0)
        stress = 0.5 * self.transition(resolution) * unit
        depth_now = scene.loading.penetration
        law = sphere, modulus, work, stress
        largest = 3.0 * (np.sqrt(sphere * max(depth_now, 0.0)) + np.cbrt(work * sphere**2 / modulus))

        def excess(radius: float) -> float:
            depth = MaugisDugdale.load_and_displacement(np.array([radius]), *law)[1]
            return float(depth[0]) - depth_now

        coarse = np.linspace(1e-3 * largest, largest, 60)
        below = np.flatnonzero(MaugisDugdale.load_and_displacement(coarse, *law)[1] < depth_now)[-1]
        first = brentq(excess, coarse[below], coarse[below + 1], xtol=1e-14 * largest)
        radius = first * np.linspace(1.0, 1e-3, ROWS)
        force, depth = MaugisDugdale.load_and_displacement(radius, *law)
        return retraction(self, scene, radius, depth, force)
