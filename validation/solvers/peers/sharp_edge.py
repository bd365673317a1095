"""Adhesion: its closed forms of Johnson, Kendall and Roberts, an edge without a zone."""

from __future__ import annotations

import math

import numpy as np

from contact_scene import Scene, Trace
from validation.solvers.peers.elastic_retraction import ElasticRetraction, radii, retraction, stated
from validation.solvers.run_options import RunOptions


class SharpEdge(ElasticRetraction):
    """``resolution`` rows along the retraction."""

    name = "adhesion-jkr"
    title = "Adhesion: JKR, closed form"
    solution = "JKR"

    def transition(self, resolution: int | None) -> float:
        """Without a zone."""
        return math.inf

    def default_resolution(self, scene: Scene) -> int:
        """400."""
        return 400

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        jkr = self.formulas()
        given = dict(zip(("radius", "contact_modulus", "work_of_adhesion"), stated(scene), strict=True))
        first = float(jkr.contact_radius(penetration=scene.loading.penetration, **given))
        radius = radii(first, resolution or self.default_resolution(scene))
        depth = np.array([jkr.penetration(contact_radius=a, **given) for a in radius])
        force = np.array([jkr.force(contact_radius=a, **given) for a in radius])
        return retraction(self, scene, radius, depth, force)
