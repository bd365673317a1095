"""Adhesion: its closed forms of Johnson, Kendall and Roberts, an edge without a zone."""

from __future__ import annotations

import math

import numpy as np

from contact_scene import Scene, Sphere, Trace
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer, elastic_ramps, trace_of


class SharpEdge(Peer):
    """``resolution`` rows along the retraction."""

    name = "adhesion-jkr"
    title = "Adhesion: JKR, closed form"
    distribution = module = "Adhesion"
    columns = ("time", "penetration", "force", "contact_radius")

    def outside(self, scene: Scene) -> str:
        """All but a single retraction of an elastic, adhesive sphere to pull-off."""
        return retraction_only(scene)

    def transition(self, resolution: int | None) -> float:
        """Without a zone."""
        return math.inf

    def default_resolution(self, scene: Scene) -> int:
        """400."""
        return 400

    def load(self) -> None:
        """Import the closed forms."""
        from Adhesion.ReferenceSolutions import JKR  # noqa: F401

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        from Adhesion.ReferenceSolutions import JKR

        assert isinstance(scene.indenter, Sphere)
        assert scene.adhesion is not None
        stated = {
            "radius": scene.indenter.radius,
            "contact_modulus": scene.material.relaxed_plane_modulus,
            "work_of_adhesion": scene.adhesion.work,
        }
        first = float(JKR.contact_radius(penetration=scene.loading.penetration, **stated))
        rows = resolution or self.default_resolution(scene)
        radius = first * np.linspace(1.0, 1e-3, rows)
        return retraction(
            self,
            scene,
            radius,
            np.array([JKR.penetration(contact_radius=a, **stated) for a in radius]),
            np.array([JKR.force(contact_radius=a, **stated) for a in radius]),
        )


def retraction_only(scene: Scene) -> str:
    """What is beyond one retraction of an elastic, adhesive sphere, in words."""
    if not scene.is_adhesive:
        return "contact without adhesion"
    found = elastic_ramps(scene)
    if found:
        return found
    steps = scene.loading.steps
    downwards = len(steps) == 1 and getattr(steps[0], "to", 0.0) < scene.loading.penetration
    return "" if downwards else "more than one retraction"


def retraction(peer: Peer, scene: Scene, radius: np.ndarray, depth: np.ndarray, force: np.ndarray) -> Trace:
    """The retraction along an equilibrium curve, up to where the penetration cannot fall further.

    Parameters
    ----------
    peer : Peer
    scene : Scene
    radius, depth, force : ndarray, shape (n,)
        Equilibria, contact radii falling.

    Returns
    -------
    Trace
    """
    end = int(np.argmin(depth)) + 1
    time = (depth[0] - depth[:end]) / float(getattr(scene.loading.steps[0], "rate", 1.0))
    return trace_of(peer, time, depth[:end], force[:end], radius[:end], lost=True)
