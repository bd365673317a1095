"""Discrete problem of a scene on meshes that follow the contact edge."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, Scene, SceneError, UnsupportedScene
from fem_solver.edge import AdhesiveEdge
from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.following.components import Components
from fem_solver.following.history import FollowingHistory
from fem_solver.following.placement import Surfaces
from fem_solver.irreversible_edge import edge_law
from fem_solver.moduli import Moduli, moduli
from fem_solver.options import DEFAULT_TOLERANCE, Options

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


@dataclass(frozen=True)
class FollowingSetup:
    """As :class:`~fem_solver.setup.Setup`, on the mesh where the accepted state has it.

    Parameters
    ----------
    surfaces : Surfaces
    history : FollowingHistory
    adhesion : Adhesion
    material : Moduli
    shortest_time : float
        Shortest relaxation time; infinite for an elastic solid.
    tolerance : float
        Relative accuracy of the force in time where the options ask for none.
    compliance : float
        Of the machine; 0 where it is rigid.
    """

    surfaces: Surfaces
    history: FollowingHistory
    adhesion: Adhesion
    material: Moduli
    shortest_time: float
    tolerance: float
    compliance: float = 0.0
    resolved_from = 0.0
    jump_tolerance = _JUMP_TOLERANCE

    @property
    def plane_modulus(self) -> float:
        """``E*`` at unit shear modulus."""
        return self.material.unit_plane_modulus

    @property
    def geometry(self) -> EdgeGeometry:
        """Edge positions."""
        return self.history.placement.geometry

    @property
    def law(self) -> AdhesiveEdge:
        """Edge law; it may go anywhere."""
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
        return _TRAVEL * self.history.state.radius

    @property
    def has_history(self) -> bool:
        """Whether the solid relaxes."""
        return math.isfinite(self.shortest_time)


def set_up_following(scene: Scene, meshes: Any, options: Options) -> FollowingSetup:
    """Make the surfaces and the undeformed state.

    Parameters
    ----------
    scene : Scene
    meshes : object
        As of :class:`~fem_solver.following.placement.Surfaces`.
    options : Options

    Returns
    -------
    FollowingSetup

    Raises
    ------
    UnsupportedScene
        If the chosen form or path does not apply to the scene.
    """
    material = moduli(scene.material)
    if options.path == "quadrature":
        raise UnsupportedScene("adhesion.zone", "quadrature points need a mesh that stays", "path auto")
    if options.form != "mixed" and material.bulk is None:
        raise UnsupportedScene(
            "material.poisson", "the displacement form needs compressibility", "form mixed"
        )
    if scene.adhesion is None or not scene.is_adhesive:
        raise SceneError("adhesion", "is missing: only an adhesive edge needs a mesh that follows it", "work")
    unit = material.instantaneous_ratio, material.unit_plane_modulus
    surfaces = Surfaces(scene, meshes, *unit, options.form, options.far_field)
    modulus = material.surface
    history = FollowingHistory(surfaces, Components(modulus))
    times = modulus.times
    return FollowingSetup(
        surfaces=surfaces,
        history=history,
        adhesion=scene.adhesion,
        material=material,
        shortest_time=float(times.min()) if times.size else math.inf,
        tolerance=DEFAULT_TOLERANCE * (_DIVISIONS / meshes.divisions) ** 2,
        compliance=scene.loading.compliance,
    )
