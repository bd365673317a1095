"""A scene, discretised: its surfaces, the accepted state on them, and what limits the steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from contact_scene.run_control import MAX_STEPS, moments, whole_number
from contact_scene.value_checks import number
from fem_solver.components import Components
from fem_solver.edge import AdhesiveEdge, edge_law
from fem_solver.edge_path import EdgeGeometry
from fem_solver.moduli import moduli
from fem_solver.placement import Placement, Surfaces
from fem_solver.state import ComponentState, interface_energy, transferred, undeformed

Array = NDArray[np.float64]

_TOLERANCE, _PRESSED_TOLERANCE = 0.1, 0.016
"""Relative accuracy of the force in time, with adhesion and without, times the square of the elements per
process zone, or per twentieth of the largest contact radius: steps and mesh are refined together."""
_TRAVEL, _PRESSED_TRAVEL = 0.03, 0.25
"""Edge travel allowed per step, relative to the contact radius, with adhesion and without: on that scale the
field away from the edge changes, and with it what drives the edge."""
_LEAST_RADIUS = 0.1
"""Radius, relative to the largest, below which errors and travel of an edge without adhesion are relative to
this: contact begins in a point."""


@dataclass(frozen=True)
class Options:
    """Numerical choices; the mesh carries the spatial ones.

    Parameters
    ----------
    tolerance : float, optional
        Relative accuracy of the force in time, between 0 and 1; by default 1e-3 at ten elements a process
        zone, or four a twentieth of the contact without adhesion, and with the square of their size.
    stop_times : tuple of float
        Times stepped onto exactly.
    profile_times : tuple of float
        Times, stepped onto exactly, at which surface profiles are returned.
    max_steps : int
        Trial steps, accepted and rejected together, after which the run ends.
    far_field : bool
        Prescribe the displacement of the total force on the far boundary; otherwise hold it.
    record_times : tuple of float
        Times, stepped onto exactly, whose rows fields in the body will be asked for.
    record : bool
        Record the surface at all rows, which those times alone do as well.

    Raises
    ------
    SceneError
        If an option is out of its range.
    """

    tolerance: float | None = None
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    far_field: bool = True
    record_times: tuple[float, ...] = ()
    record: bool = False

    def __post_init__(self) -> None:
        checked = {
            "stop_times": moments(self.stop_times, "stop_times"),
            "profile_times": moments(self.profile_times, "profile_times"),
            "record_times": moments(self.record_times, "record_times"),
            "max_steps": whole_number(self.max_steps, "max_steps", 1),
        }
        if self.tolerance is not None:
            allowed = "a number between 0 and 1"
            number(self.tolerance, "tolerance", allowed, low=0.0, high=1.0, open=True)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def records(self) -> bool:
        """Whether the surface is recorded."""
        return self.record or bool(self.record_times)

    @property
    def requested_times(self) -> frozenset[float]:
        """All times that are stepped onto."""
        return frozenset((*self.stop_times, *self.profile_times, *self.record_times))


class Setup:
    """Surfaces of a scene and the accepted state on them.

    The step to ``state`` started from ``begin``, on the mesh of the step; ``tolerance`` is the relative
    accuracy of the force in time.
    """

    def __init__(self, scene: Scene, meshes: Any, options: Options) -> None:
        self.options, self.relaxed_modulus = options, scene.material.relaxed_plane_modulus
        self.adhesion = scene.adhesion if scene.is_adhesive else None
        self.compliance, self.body = scene.loading.compliance, scene.body
        self.plane_tip = scene.bare_plane_tip
        self.material = moduli(scene.material)
        self.solid = Components(self.material.surface)
        self.surfaces = Surfaces(scene, meshes, self.material, options.far_field, looked_into=options.records)
        times, usual = self.solid.modulus.times, _TOLERANCE if self.adhesion else _PRESSED_TOLERANCE
        self.shortest_time, self.has_history = float(times.min(initial=math.inf)), times.size > 0
        self.tolerance = options.tolerance or usual / meshes.divisions**2
        self.state = undeformed(self.surfaces.around(self.surfaces.largest), len(times))
        self._moved = self.state, self.state

    @property
    def placement(self) -> Placement:
        """The surface at the place of the accepted state."""
        return self.surfaces.at(self.state.place)

    def around(self, radius: float) -> Placement:
        """The surface around a radius, on the same mesh while the closure sees a corner within an element."""
        here, within = self.placement, self.geometry.position(radius)
        stays = self.state.sees_corner(radius) and here.lowest <= within <= self.geometry.last
        return here if stays else self.surfaces.around(radius)

    @property
    def geometry(self) -> EdgeGeometry:
        """Edge positions there."""
        return self.placement.geometry

    @property
    def law(self) -> AdhesiveEdge:
        """Edge law; it may go anywhere."""
        return edge_law(self.geometry, self.adhesion, self.plane_tip)

    def travel(self, radius: float) -> float:
        """Edge travel allowed per step, from a radius."""
        share = _TRAVEL if self.adhesion is not None else _PRESSED_TRAVEL
        return share * self.radius_scale(radius)

    def radius_scale(self, radius: float) -> float:
        """Radius to which errors of a radius are relative."""
        return radius if self.adhesion is not None else max(radius, _LEAST_RADIUS * self.surfaces.largest)

    @cached_property
    def least_depth(self) -> float:
        """Penetration to which errors of one are relative at least: where contact of the least radius ends,
        without adhesion."""
        return 0.0 if self.adhesion else self.placement.depth(_LEAST_RADIUS * self.surfaces.largest)

    @cached_property
    def least_force(self) -> float:
        """Force to which errors of a force are relative at least without adhesion: that of a relaxed flat
        punch, where contact of the least radius ends."""
        return 2.0 * self.relaxed_modulus * _LEAST_RADIUS * self.surfaces.largest * self.least_depth

    def at(self, placement: Placement) -> ComponentState:
        """The accepted state with the mesh at another place."""
        accepted, moved = self._moved
        if accepted is not self.state or moved.place != placement.place:
            moved = transferred(self.state, self.placement, placement, self.solid)
            self._moved = self.state, moved
        return moved

    @property
    def stored_energy(self) -> float:
        """Energy of the springs."""
        state = self.state
        held = float(np.sum(self.solid.stored(state.components, state.branches)))
        finer = float(np.sum(state.unresolved) + np.sum(state.uneven))
        return held + finer + state.borders.stored(self.solid)

    @property
    def interface_energy(self) -> float:
        """Energy of the partly released node beyond that of its mean."""
        return interface_energy(self.state, self.placement, self.solid)
