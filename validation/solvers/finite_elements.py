"""Finite elements as a solver of the registry, on meshes fitted to the scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Literal

from contact_scene import Scene, SceneError, Trace
from contact_scene.run_control import installed_memory
from meshes import EdgeMeshes, HalfSpaceMesh
from validation.solvers.base import SKIPPED_WORK, ComparisonRun, Solver
from validation.solvers.contact_range import largest_contact_radius
from validation.solvers.fitted_meshes import (
    ADHESIONLESS_DIVISIONS,
    DIVISIONS,
    GRADING,
    divisions_of_zone,
    edge_mesh_parameters,
    edge_meshes,
    finest_resolution,
    mesh_for,
    mesh_parameters,
    peels,
    resolved_length,
)
from validation.solvers.run_options import RunOptions

FOLLOWED_BEYOND = 48.0
"""Largest contact radius, in process zones, beyond which the mesh follows the edge: of the order at which
a mesh that is fine along the whole path takes as long, not measured closer."""
BYTES_FOLLOWING, BYTES_CONDENSED, BYTES_OF_VOLUME = (2e7, 1.75e7), (6e7, 6e5, 200.0), (6e7, 1.3e6, 700.0)
"""Memory before the first step, measured: coefficients of the powers of the number of elements along the
contact (in a process zone, where the mesh follows the edge), by where the history is carried."""
ADVISED_SHARE = 0.9
"""Memory of a resolution that is advised, over what is installed: the mesh may be a little larger than its
forecast."""
ZONES_AT_RIM = 4.0
"""Process zones that the mesh resolves where the edge rests on the rim of a punch: two to either side."""
FEW_HALVINGS = 8.0
"""Halvings of the contact radius down to the process zone above which the rest of the mesh counts."""


@dataclass(frozen=True)
class FiniteElements(Solver):
    """Finite elements with node release.

    Parameters
    ----------
    grading, domain_ratio : float, optional
        Growth of the element size with the distance from the edge, and domain radius over the largest contact
        radius; by default the mesh's own.
    path : "auto", "condensed" or "quadrature"
        Where the history is carried: on the surface or at quadrature points.
    far_field : bool
        Prescribe the displacement of the total force on the far boundary, or hold it.
    step_resolution : int, optional
        Divisions per process zone that the time steps resolve, where they differ from those of the mesh.
    cached_mesh : bool
        Take the mesh from the cache; otherwise build it anew, so that meshing is part of the run time.
    followed_beyond : float
        Largest contact radius, in process zones, beyond which the mesh follows the edge.
    followed_grading : float, optional
        ``grading`` of meshes that follow the edge, if it is another.
    """

    grading: float | None = None
    domain_ratio: float | None = None
    path: Literal["auto", "condensed", "quadrature"] = "auto"
    far_field: bool = True
    step_resolution: int | None = None
    cached_mesh: bool = True
    followed_beyond: float = FOLLOWED_BEYOND
    followed_grading: float | None = None

    name = "fem"
    title = "finite elements"
    description = (
        "Axisymmetric elements of the body, on a mesh fitted to the scene; the contact edge moves by "
        "releasing the forces of nodes."
    )
    order = 2.0
    tolerance = 2e-2
    curve_tolerance = 1e-2
    quantity_tolerances: ClassVar[Mapping[str, float]] = {
        "pull_off_penetration": 0.02,
        "pull_off_radius": 0.02,
        "pull_off_time": 0.02,
        "detachment_radius": 0.02,
        "detachment_force": 0.02,
        "branch_dissipation": 0.08,
        "zone_excess": 0.08,
    }
    coarse_tolerance = 2e-2
    least_resolution = 1
    skipped_work: ClassVar[Mapping[str, str]] = {
        **SKIPPED_WORK,
        "volume_solves": "no solution in the volume within the time loop",
    }
    curve_style: ClassVar[Mapping[str, Any]] = {
        "color": "#d55e00",
        "linestyle": (0, (4, 2)),
        "linewidth": 1.4,
    }
    marker = "s"
    css_variable = "fem"

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        from fem_solver import Options, solve

        own = Options(
            self.step_divisions(scene, resolution),
            path=self.path,
            far_field=self.far_field,
            **options.of_solver,
        )
        return solve(scene, self.mesh(scene, resolution), own, options.progress, options.monitor)

    def mesh(self, scene: Scene, resolution: int | None) -> HalfSpaceMesh | EdgeMeshes:
        """The mesh fitted to a scene, or those that follow the edge."""
        if self.follows_edge(scene):
            grading = self.followed_grading or self.grading
            return edge_meshes(scene, resolution, grading, self.domain_ratio, self.cached_mesh)
        return mesh_for(scene, resolution, self.grading, self.domain_ratio, self.cached_mesh)

    def step_divisions(self, scene: Scene, resolution: int | None) -> int | None:
        """Divisions per process zone that the time steps resolve; ``None``: those of the mesh."""
        return self.step_resolution or (resolution and divisions_of_zone(scene, resolution))

    def follows_edge(self, scene: Scene) -> bool:
        """Whether the mesh is fine around the edge only and moves with it, instead of along its whole path.

        The history is on the surface then. An edge that leaves the rim of a punch at once has no path.
        """
        if self.path == "quadrature" or not scene.is_adhesive or scene.adhesion is None:
            return False
        long = largest_contact_radius(scene) > self.followed_beyond * resolved_length(scene.adhesion)
        return long and (not math.isfinite(scene.indenter.edge) or peels(scene))

    def solves_volume(self, scene: Scene) -> bool:
        """Whether every step on a mesh that stays solves for the whole body: Poisson's ratio changes."""
        relaxes_apart = scene.material.bulk is not None and bool(scene.material.spectrum[0].size)
        return relaxes_apart or self.path == "quadrature"

    def mesh_bytes(self, scene: Scene, divisions: int) -> float:
        """Memory of the mesh and what is worked out on it before the first step, to a factor of 1.3."""
        largest, finer = largest_contact_radius(scene), float(divisions_of_zone(scene, divisions))
        zones = largest / scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 100.0
        if self.follows_edge(scene):
            elements = finer * max(math.log2(max(zones, 1.0)) / FEW_HALVINGS, 1.0)
            return _polynomial(BYTES_FOLLOWING, elements)
        finer *= 1.0 if scene.is_adhesive else 0.5  # without adhesion two divisions are one element
        elements = max(zones, 1.0) * finer
        if math.isfinite(scene.indenter.edge) and not peels(scene):
            outside = 2.0 / (self.grading or GRADING) * math.log(max(zones, 1.0))
            elements = ZONES_AT_RIM * finer + outside
        return _polynomial(BYTES_OF_VOLUME if self.solves_volume(scene) else BYTES_CONDENSED, elements)

    def check(self, scene: Scene, resolution: int | None = None) -> None:
        """As of every solver; a mesh may be too large too, of itself or for the memory of the machine."""
        super().check(scene, resolution)
        parameters = edge_mesh_parameters if self.follows_edge(scene) else mesh_parameters
        parameters(scene, resolution, self.grading, self.domain_ratio)
        installed, divisions = installed_memory(), resolution or self.default_resolution(scene)
        needed = self.mesh_bytes(scene, divisions)
        if installed is None or needed <= installed:
            return

        def fits(coarser: int) -> bool:
            return self.mesh_bytes(scene, coarser) <= ADVISED_SHARE * installed

        there = f"{1e-9 * installed:.3g} GB are installed"
        problem = f"at resolution {divisions} it takes about {1e-9 * needed:.3g} GB of memory, {there}"
        raise SceneError("", problem, finest_resolution(fits, divisions))

    def load(self) -> None:
        """Import the solver and scikit-fem."""
        import fem_solver  # noqa: F401

    def default_resolution(self, scene: Scene) -> int:
        """Elements per process zone, or nodes per hundredth of the largest contact radius."""
        return DIVISIONS if scene.is_adhesive else ADHESIONLESS_DIVISIONS

    def quick_resolution(self, scene: Scene) -> int:
        """As of every solver; the default where the mesh follows the edge: fewer are hardly cheaper."""
        return self.default_resolution(scene) if self.follows_edge(scene) else super().quick_resolution(scene)

    def coarse_resolution(self, adhesive: bool) -> int:
        """Four; without adhesion two."""
        return 4 if adhesive else 2

    def edge_spacing(self, scene: Scene, resolution: int | None = None) -> float:
        """Of nodes, whole ones of which are in contact without adhesion; an elastic solid has no history."""
        relaxes = scene.material.branches or getattr(scene.material.bulk, "branches", ())
        if scene.is_adhesive or not relaxes:
            return 0.0
        return 0.01 * largest_contact_radius(scene) / (resolution or ADHESIONLESS_DIVISIONS)

    def comparison_run(self, scene: Scene, resolution: int | None = None) -> ComparisonRun:
        """Half the resolution, twice the grading, four times the step tolerance; or the reverse."""
        from fem_solver.options import DEFAULT_TOLERANCE

        divisions, other = self._other_resolution(scene, resolution)
        ratio = divisions / other
        method = replace(self, grading=ratio * (self.grading or GRADING))
        run = partial(method.solve, scene, other, step_tolerance=ratio**2 * DEFAULT_TOLERANCE)
        return ComparisonRun(run, ratio)


def _polynomial(coefficients: Sequence[float], unknowns: float) -> float:
    """Of a number of unknowns that may be one that no run could have."""
    return sum(factor * min(unknowns, 1e30) ** power for power, factor in enumerate(coefficients))
