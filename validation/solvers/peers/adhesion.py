"""Adhesion: its closed forms for one retraction of an elastic, adhesive sphere, by falling contact radius."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from contact_scene import Scene, Sphere, Trace
from contact_scene.trace import Array
from validation.solvers.base import RunOptions
from validation.solvers.peers.peer import Peer, elastic_ramps, trace_of

LEAST_SHARE = 1e-3
"""Smallest contact radius over the first one: far below those at which contact can be lost."""
ROWS = 600
"""Contact radii at which the equilibrium with a cohesive ring is computed."""


class ElasticRetraction(Peer):
    """A closed form that gives penetration and force at a contact radius; ``solution`` is its module."""

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
        self.formulas()

    def formulas(self) -> Any:
        """The module of the closed form."""
        from Adhesion.ReferenceSolutions import JKR, MaugisDugdale

        return {"JKR": JKR, "MaugisDugdale": MaugisDugdale}[self.solution]

    @abstractmethod
    def equilibria(self, scene: Scene, resolution: int | None) -> tuple[Array, Array, Array]:
        """Contact radii from that of the start down, penetrations and forces; each of shape (n,)."""

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        """The retraction along the equilibria, up to where the penetration cannot fall further."""
        radius, depth, force = self.equilibria(scene, resolution)
        end = int(np.argmin(depth)) + 1
        time = (depth[0] - depth[:end]) / float(getattr(scene.loading.steps[0], "rate", 1.0))
        return trace_of(self, time, depth[:end], force[:end], radius[:end], lost=True)


def stated(scene: Scene) -> tuple[float, float, float]:
    """Radius of the sphere, plane-strain modulus and work of adhesion of such a scene."""
    assert isinstance(scene.indenter, Sphere)
    assert scene.adhesion is not None
    return scene.indenter.radius, scene.material.relaxed_plane_modulus, scene.adhesion.work


class SharpEdge(ElasticRetraction):
    """Johnson, Kendall and Roberts, an edge without a zone: ``resolution`` rows along the retraction."""

    name = "adhesion-jkr"
    title = "Adhesion: JKR, closed form"
    solution = "JKR"

    def transition(self, resolution: int | None) -> float:
        return math.inf

    def default_resolution(self, scene: Scene) -> int:
        return 400

    def equilibria(self, scene: Scene, resolution: int | None) -> tuple[Array, Array, Array]:
        jkr = self.formulas()
        given = dict(zip(("radius", "contact_modulus", "work_of_adhesion"), stated(scene), strict=True))
        first = float(jkr.contact_radius(penetration=scene.loading.penetration, **given))
        radius = first * np.linspace(1.0, LEAST_SHARE, resolution or self.default_resolution(scene))
        depth = np.array([jkr.penetration(contact_radius=a, **given) for a in radius])
        return radius, depth, np.array([jkr.force(contact_radius=a, **given) for a in radius])


class MaugisRing(ElasticRetraction):
    """Maugis and Dugdale, a cohesive ring of constant stress around the contact.

    ``resolution`` is Maugis' transition parameter: the larger, the shorter the range of attraction; at the
    default, 5, it is hardly longer than that of Johnson, Kendall and Roberts.
    """

    name = "maugis-dugdale"
    title = "Adhesion: Maugis-Dugdale"
    solution = "MaugisDugdale"

    def transition(self, resolution: int | None) -> float:
        return float(resolution or 5)

    def default_resolution(self, scene: Scene) -> int:
        return 5

    def equilibria(self, scene: Scene, resolution: int | None) -> tuple[Array, Array, Array]:
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
        first = brentq(excess, coarse[below], coarse[below + 1], xtol=1e-14 * largest)
        radius = first * np.linspace(1.0, LEAST_SHARE, ROWS)
        force, depth = equilibrium(radius, *law)
        return radius, depth, force
