"""Finite elements as a solver, on meshes fitted to the scene.

A mesh is fine along the whole path of the contact edge, up to the largest contact of the loading, or, where
that is many process zones long, around the edge alone, with which it travels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Literal

import meshes
from contact_scene import Adhesion, Scene, SceneError, Trace
from contact_scene.run_control import installed_memory
from validation.solvers.base import SKIPPED_WORK, ComparisonRun, RunOptions, Solver
from validation.solvers.contact_range import largest_contact_radius

DIVISIONS = 10
"""Elements per process zone where no resolution is specified."""
ADHESIONLESS_DIVISIONS = 4
"""Nodes per hundredth of the largest contact radius, without adhesion and with no resolution specified.

Without adhesion the edge rests on nodes, mid-side nodes among them: two divisions are an element.
"""
LEAST_DIVISIONS = 4
"""Smallest resolution that a user may choose; coarser meshes serve estimates of the error alone. The zone of
a closing edge then has an element at least: with less the edge closes in steps, behind where it should be."""
GRADING = 0.4
"""Growth of the element size with the distance from the contact edge, by the root of the number of elements a
zone: elements in the zone err by its square, quadratic ones of size ``grading * r`` by the fourth power."""
WIDEST_FOLLOWING = 0.14
"""The same at most where the mesh follows the edge: under the middle of the contact, where no strip is fine,
the stress is off by 0.9 % of the largest, twice that at 0.2."""
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
        Growth of the element size with the distance from the edge, by default ``GRADING`` over the root of
        the elements a zone, and domain radius over the largest contact radius, by default the mesh's own.
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
    """

    grading: float | None = None
    domain_ratio: float | None = None
    path: Literal["auto", "condensed", "quadrature"] = "auto"
    far_field: bool = True
    step_resolution: int | None = None
    cached_mesh: bool = True
    followed_beyond: float = FOLLOWED_BEYOND

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

    def mesh(self, scene: Scene, resolution: int | None) -> meshes.HalfSpaceMesh | meshes.EdgeMeshes:
        """The mesh fitted to a scene, or those that follow the edge; ``SceneError`` if it is too large."""
        divisions = resolution or self.default_resolution(scene)
        if self.follows_edge(scene):
            return self._edge_meshes(scene, divisions)
        try:
            parameters = self.parameters(scene, divisions)
        except ValueError as error:
            raise self._too_large(scene, divisions, error) from None
        return meshes.cached(parameters) if self.cached_mesh else meshes.half_space(parameters)

    def parameters(self, scene: Scene, divisions: int) -> meshes.MeshParameters:
        """Of the mesh, the largest one where it follows the edge; ``ValueError`` if it is too large."""
        largest, edge = largest_contact_radius(scene), scene.indenter.edge
        if self.follows_edge(scene):
            followed = self._edge_meshes(scene, divisions)
            return followed.parameters(followed.place(largest).level)
        if scene.adhesion is not None and scene.is_adhesive:
            zone = resolved_length(scene.adhesion)
            margin = 2.0 * scene.adhesion.zone / zone
        else:
            zone, margin = 0.02 * largest, 1.0
        rim = edge if math.isfinite(edge) else None
        return meshes.fit(
            0.0 if rim is None or peels(scene) else rim,
            largest,
            zone,
            divisions,
            margin=margin,
            domain_ratio=self.domain_ratio or meshes.DOMAIN_RATIO,
            grading=self._growth(scene, divisions),
            edge=rim,
        )

    def _edge_meshes(self, scene: Scene, divisions: int) -> meshes.EdgeMeshes:
        assert scene.adhesion is not None
        return meshes.EdgeMeshes(
            resolved_length(scene.adhesion),
            divisions,
            largest_contact_radius(scene),
            self._growth(scene, divisions),
            self.domain_ratio,
            self.cached_mesh,
        )

    def _growth(self, scene: Scene, divisions: int) -> float:
        """Growth of the element size with the distance from the edge."""
        widest = WIDEST_FOLLOWING if self.follows_edge(scene) else math.inf
        return self.grading or min(GRADING / math.sqrt(divisions), widest)

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
            outside = 2.0 / self._growth(scene, divisions) * math.log(max(zones, 1.0))
            elements = ZONES_AT_RIM * finer + outside
        return _polynomial(BYTES_OF_VOLUME if self.solves_volume(scene) else BYTES_CONDENSED, elements)

    def check(self, scene: Scene, resolution: int | None = None) -> None:
        """As of every solver; a mesh may be too large too, of itself or for the memory of the machine."""
        super().check(scene, resolution)
        divisions, installed = resolution or self.default_resolution(scene), installed_memory()
        try:
            self.parameters(scene, divisions)
        except ValueError as error:
            raise self._too_large(scene, divisions, error) from None
        needed = self.mesh_bytes(scene, divisions)
        if installed is not None and needed > installed:
            there = f"{1e-9 * installed:.3g} GB are installed"
            problem = f"at resolution {divisions} it takes about {1e-9 * needed:.3g} GB of memory, {there}"
            raise SceneError("", problem, self._advice(scene, divisions))

    def _too_large(self, scene: Scene, divisions: int, error: ValueError) -> SceneError:
        return SceneError("", f"no mesh for this scene: {error}", self._advice(scene, divisions))

    def _advice(self, scene: Scene, refused: int) -> str:
        """What is allowed in place of a refused resolution, in words: the finest one that can be made."""
        installed = installed_memory()

        def possible(divisions: int) -> bool:
            try:
                self.parameters(scene, divisions)
            except ValueError:
                return False
            return installed is None or self.mesh_bytes(scene, divisions) <= ADVISED_SHARE * installed

        low, high = LEAST_DIVISIONS - 1, max(refused, LEAST_DIVISIONS)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if possible(middle) else (low, middle)
        if low < LEAST_DIVISIONS:
            return "a longer process zone, a smaller contact, or another solver"
        return f"a coarser resolution, at most {low}"

    def load(self) -> None:
        import fem_solver  # noqa: F401

    def default_resolution(self, scene: Scene) -> int:
        return DIVISIONS if scene.is_adhesive else ADHESIONLESS_DIVISIONS

    def quick_resolution(self, scene: Scene) -> int:
        """As of every solver; the default where the mesh follows the edge: fewer are hardly cheaper."""
        return self.default_resolution(scene) if self.follows_edge(scene) else super().quick_resolution(scene)

    def coarse_resolution(self, adhesive: bool) -> int:
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
        method = replace(self, grading=min(ratio * self._growth(scene, divisions), meshes.WIDEST))
        run = partial(method.solve, scene, other, step_tolerance=ratio**2 * DEFAULT_TOLERANCE)
        return ComparisonRun(run, ratio)


def resolved_length(adhesion: Adhesion) -> float:
    """Length that the resolution divides: the process zone, or less where that of a closing edge is short."""
    return min(adhesion.zone, LEAST_DIVISIONS * adhesion.closing_zone)


def divisions_of_zone(scene: Scene, resolution: int) -> int:
    """Elements in a process zone at rest; without adhesion the resolution."""
    if scene.adhesion is None or not scene.is_adhesive:
        return resolution
    return round(resolution * scene.adhesion.zone / resolved_length(scene.adhesion))


def peels(scene: Scene) -> bool:
    """Whether the contact edge takes time to leave the rim of a punch; otherwise it stays or goes at once."""
    rated = scene.adhesion is not None and scene.adhesion.rate is not None
    return scene.is_adhesive and (rated or bool(scene.material.spectrum[0].size))


def _polynomial(coefficients: Sequence[float], unknowns: float) -> float:
    """Of a number of unknowns that may be one that no run could have."""
    return sum(factor * min(unknowns, 1e30) ** power for power, factor in enumerate(coefficients))
