"""Adhesion: its closed forms for one retraction of an elastic, adhesive sphere, by falling contact radius."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from contact_scene import Scene, Sphere, Trace
from contact_scene.trace import Array
from validation.solvers.peers.peer import Peer, elastic_ramps, trace_of

LEAST_SHARE = 1e-3
"""Smallest contact radius over the first one: far below those at which contact can be lost."""


class ElasticRetraction(Peer):
    """A closed form that gives force and penetration at a contact radius.

    Attributes
    ----------
    solution : str
        Its module in ``Adhesion.ReferenceSolutions``.
    """

    distribution = module = "Adhesion"
    solution: ClassVar[str]

    def outside(self, scene: Scene) -> str:
        """All but a single retraction of an elastic, adhesive sphere to pull-off."""
        if not scene.is_adhesive:
            return "contact without adhesion"
        found = elastic_ramps(scene)
        if found:
            return found
        steps = scene.loading.steps
        downwards = len(steps) == 1 and getattr(steps[0], "to", 0.0) < scene.loading.penetration
        return "" if downwards else "more than one retraction"

    def load(self) -> None:
        """Import the closed form."""
        self.formulas()

    def formulas(self) -> Any:
        """The module of the closed form."""
        from Adhesion.ReferenceSolutions import JKR, MaugisDugdale

        return {"JKR": JKR, "MaugisDugdale": MaugisDugdale}[self.solution]


def stated(scene: Scene) -> tuple[float, float, float]:
    """Radius of the sphere, plane-strain modulus and work of adhesion of such a scene."""
    assert isinstance(scene.indenter, Sphere)
    assert scene.adhesion is not None
    return scene.indenter.radius, scene.material.relaxed_plane_modulus, scene.adhesion.work


def radii(first: float, rows: int) -> Array:
    """Contact radii from the first one down, of shape (rows,)."""
    return first * np.linspace(1.0, LEAST_SHARE, rows)


def retraction(peer: Peer, scene: Scene, radius: Array, depth: Array, force: Array) -> Trace:
    """The retraction along an equilibrium curve, up to where the penetration cannot fall further.

    Parameters
    ----------
    peer : Peer
    scene : Scene
    radius, depth, force : ndarray, shape (n,)
        Equilibria in units of the scene, contact radii falling.

    Returns
    -------
    Trace
    """
    end = int(np.argmin(depth)) + 1
    time = (depth[0] - depth[:end]) / float(getattr(scene.loading.steps[0], "rate", 1.0))
    return trace_of(peer, time, depth[:end], force[:end], radius[:end], lost=True)
