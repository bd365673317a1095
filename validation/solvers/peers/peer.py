"""What all adapters of other people's codes have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np

from contact_scene import Counters, Outcome, OutcomeKind, Ramp, Scene, Sphere, Trace, UnsupportedScene
from contact_scene.trace import Array
from validation.solvers.base import Solver

EXTRA = "pip install 'crosscontact[peers]'"


class Peer(Solver):
    """A code of somebody else, called as its users call it: ``distribution`` is the package as it is
    installed, ``module`` as it is imported."""

    distribution: ClassVar[str]
    module: ClassVar[str]
    columns: ClassVar[tuple[str, ...]] = ("time", "penetration", "force", "contact_radius")
    tolerance = 2e-2
    curve_tolerance = 2e-2
    curve_style: ClassVar[Mapping[str, Any]] = {
        "color": "#009e73",
        "linestyle": (0, (4, 1, 1, 1)),
        "linewidth": 1.4,
    }

    @property
    def version(self) -> str:
        """Version of the package; empty where it is not installed."""
        from importlib import metadata

        try:
            return metadata.version(self.distribution)
        except metadata.PackageNotFoundError:
            return ""

    def refusal(self, scene: Scene) -> UnsupportedScene | None:
        """A package that is missing, or a scene that it does not cover."""
        if find_spec(self.module) is None:
            return UnsupportedScene("solver", f'"{self.name}" needs the package {self.distribution}', EXTRA)
        outside = self.outside(scene)
        return UnsupportedScene("solver", f'"{self.name}" does not cover {outside}') if outside else None

    @abstractmethod
    def outside(self, scene: Scene) -> str:
        """What in a scene the code does not cover; empty if it covers all."""


def beyond_a_sphere(scene: Scene) -> str:
    """What is beyond a sphere on a half-space with one work of adhesion and plain load steps, in words."""
    adhesion = scene.adhesion
    if not isinstance(scene.indenter, Sphere):
        return f"the shape {scene.indenter.shape}"
    if scene.body is not None:
        return "a layer"
    if scene.material.bulk is not None:
        return "a bulk modulus that relaxes apart from shear"
    if adhesion is not None and (adhesion.rate is not None or adhesion.work_closing is not None):
        return "a work of adhesion that is another on closing or at other speeds"
    if scene.loading.compliance > 0.0:
        return "a spring in the machine"
    return "a load step that ends at a level" if scene.loading.has_triggers else ""


def elastic_ramps(scene: Scene) -> str:
    """What is beyond an elastic sphere under penetration ramps, in words."""
    if not scene.material.is_elastic:
        return "relaxation"
    if not all(isinstance(step, Ramp) for step in scene.loading.steps) or not scene.loading.steps:
        return "steps other than ramps of the penetration"
    return beyond_a_sphere(scene)


def ramp_times(scene: Scene, rows: int) -> tuple[Array, Array]:
    """Times and penetrations along the ramps of a scene, ``rows`` a ramp; each of shape (n,).

    Evenly spaced in the root of the penetration, as the contact radius of a sphere is.
    """
    time, depth = [np.zeros(1)], [np.array([scene.loading.penetration])]
    for _, segment in scene.loading.segments():
        first, last = segment.value(segment.start), segment.value(segment.end)
        begin, end = (float(np.sign(value) * np.sqrt(abs(value))) for value in (first, last))
        roots = np.linspace(begin, end, rows + 1)[1:]
        depth.append(roots * np.abs(roots))
        time.append(segment.start + (depth[-1] - first) / (last - first) * (segment.end - segment.start))
    return np.concatenate(time), np.concatenate(depth)


def trace_of(
    solver: Solver, time: Array, depth: Array, force: Array, radius: Array, lost: bool = False
) -> Trace:
    """A trace of a code that gives no energies: the work by trapezoids, nothing stored, nothing lost.

    The columns, each of shape (n,), are in units of the scene; ``lost``: contact is lost at the last row.
    """
    kind = OutcomeKind.DETACHED if lost else OutcomeKind.COMPLETED
    reason = "the contact area fell to zero" if lost else "all loading steps carried out"
    work = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(depth))))
    outcome = Outcome(kind, reason, float(time[-1]))
    nothing = np.zeros_like(time)
    counters = Counters(steps=len(time) - 1)
    return Trace(solver.name, time, depth, force, radius, nothing, work, nothing, outcome, counters)
