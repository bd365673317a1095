"""Discrete problem of a scene on meshes that follow the contact edge."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, Layer, Scene, UnsupportedScene
from fem_solver.components import Components
from fem_solver.edge import AdhesiveEdge, PressedEdge, edge_law
from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.moduli import Moduli, moduli
from fem_solver.options import DEFAULT_TOLERANCE, Options
from fem_solver.placement import Surfaces
from fem_solver.state import SurfaceHistory

Array = NDArray[np.float64]

_TRAVEL = 0.03
"""Edge travel allowed per step, relative to the contact radius: on that scale the field away from the edge
changes, and with it what drives the edge."""
_JUMP_TOLERANCE = 0.1
"""Deviation from a linear response over a part of a load jump, per tolerance of the steps: a jump passes over
many zones, and its work is that of its chords, whose errors all have one sign."""
_DIVISIONS = 10.0
"""Elements per process zone to which the usual tolerance of the steps belongs; it goes with their square, so
that steps and mesh are refined together."""
_PRESSED_DIVISIONS = 4.0
"""The same without adhesion, per twentieth of the largest contact radius."""
_PRESSED_TRAVEL = 0.02, 0.25
"""Edge travel allowed per step without adhesion, relative to the largest contact radius, and the present."""
_LEAST_RADIUS = 0.1
"""Radius, relative to the largest, below which errors of the radius are relative to this."""


@dataclass(frozen=True)
class Setup:
    """Surfaces, the state on them, and what limits the steps.

    Parameters
    ----------
    surfaces : Surfaces
    history : SurfaceHistory
    adhesion : Adhesion, optional
    material : Moduli
    shortest_time : float
        Shortest relaxation time; infinite for an elastic solid.
    tolerance : float
        Relative accuracy of the force in time where the options ask for none.
    compliance : float
        Of the machine; 0 where it is rigid.
    plane_tip : float
        Radius of a plane tip without adhesion; 0 of others.
    body : Layer, optional
        What it is, unless a half-space.
    """

    surfaces: Surfaces
    history: SurfaceHistory
    adhesion: Adhesion | None
    material: Moduli
    shortest_time: float
    tolerance: float
    compliance: float = 0.0
    plane_tip: float = 0.0
    body: Layer | None = None
    jump_tolerance = _JUMP_TOLERANCE

    @property
    def geometry(self) -> EdgeGeometry:
        """Edge positions."""
        return self.history.placement.geometry

    @property
    def law(self) -> AdhesiveEdge:
        """Edge law; it may go anywhere."""
        if self.adhesion is None:
            return PressedEdge(self.geometry, self.plane_tip)
        return edge_law(self.geometry, self.adhesion)

    @property
    def radii(self) -> Array:
        """Radii of the surface nodes; shape (n,)."""
        return self.history.placement.radii

    @property
    def height(self) -> Array:
        """Height of the indenter at the nodes; shape (n,)."""
        return self.history.placement.height

    @property
    def stretch(self) -> float:
        """Contact radius of an edge in the fine strip over the radius of its node."""
        return self.history.placement.stretch

    @property
    def travel(self) -> float:
        """Edge travel allowed per step."""
        radius = self.history.state.radius
        if self.adhesion is None:
            return max(_PRESSED_TRAVEL[0] * self.surfaces.largest, _PRESSED_TRAVEL[1] * radius)
        return _TRAVEL * radius

    def radius_scale(self, radius: float) -> float:
        """Radius to which errors of a radius are relative; without adhesion contact begins in a point."""
        return radius if self.adhesion is not None else max(radius, _LEAST_RADIUS * self.surfaces.largest)

    @property
    def has_history(self) -> bool:
        """Whether the solid relaxes."""
        return math.isfinite(self.shortest_time)


def set_up(scene: Scene, meshes: Any, options: Options) -> Setup:
    """Make the surfaces and the undeformed state."""
    material = moduli(scene.material)
    if options.form != "mixed" and material.bulk is None:
        raise UnsupportedScene(
            "material.poisson", "the displacement form needs compressibility", "form mixed"
        )
    unit = material.instantaneous_ratio, material.unit_plane_modulus
    surfaces = Surfaces(scene, meshes, *unit, options.form, options.far_field)
    modulus = material.surface
    history = SurfaceHistory(surfaces, Components(modulus))
    times, usual = modulus.times, _DIVISIONS if scene.is_adhesive else _PRESSED_DIVISIONS
    return Setup(
        surfaces=surfaces,
        history=history,
        adhesion=scene.adhesion if scene.is_adhesive else None,
        material=material,
        shortest_time=float(times.min()) if times.size else math.inf,
        tolerance=DEFAULT_TOLERANCE * (usual / meshes.divisions) ** 2,
        compliance=scene.loading.compliance,
        plane_tip=scene.bare_plane_tip,
        body=scene.body,
    )
