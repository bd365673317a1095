"""Finite elements as a solver, on meshes that are fine around the contact edge, with which they travel."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, TypeVar

import meshes
from contact_scene import Scene, SceneError, Trace
from contact_scene.run_control import installed_memory
from validation.solvers.base import AT_EXTREMA, SKIPPED_WORK, ComparisonRun, RunOptions, Solver
from validation.solvers.contact_range import largest_contact_radius

Run = TypeVar("Run")

DIVISIONS = 10
"""Elements per process zone where no resolution is specified."""
ADHESIONLESS_DIVISIONS = 4
"""Elements per twentieth of the largest contact radius, without adhesion and with no resolution specified."""
PRESSED_LENGTHS = 20.0
"""Lengths that the resolution divides, along the largest contact radius without adhesion: one mesh, fine from
the axis on, serves all radii then."""
RESERVE = 2.0
"""Largest radius of a mesh without adhesion over that of the contact, where the loading tells far more."""
LEAST_DIVISIONS = 4
"""Smallest resolution that a user may choose; coarser meshes serve estimates of the error alone. The zone of
a closing edge then has an element at least: with less the edge closes in steps, behind where it should be."""
GRADING = 0.4
"""Growth of the element size with the distance from the contact edge, by the root of the number of elements a
zone: elements in the zone err by its square, quadratic ones of size ``grading * r`` by the fourth power."""
WIDEST = 0.14
"""The same at most: under the middle of the contact, where no strip is fine,
the stress is off by 0.9 % of the largest, twice that at 0.2."""
THICK = 3.0
"""Largest contact radius, in thicknesses of a layer, from which on elements grow less, as its inverse root.
Under a wide contact the compliance of a layer is a small difference. Without adhesion that of a bonded,
incompressible one is off by 3e-4 at 3 thicknesses, by 8e-4 at 10, where it would be by 4e-3."""
BYTES = 2e7, 1.75e7
"""Memory before the first step, measured: without elements, and for each in a process zone."""
ADVISED_SHARE = 0.9
"""Memory of a resolution that is advised, over what is installed: the mesh may be a little larger than its
forecast."""
FEW_HALVINGS = 8.0
"""Halvings of the contact radius down to the process zone above which the rest of the mesh counts."""


@dataclass(frozen=True)
class FiniteElements(Solver):
    """Finite elements with node release.

    ``grading`` is the growth of the element size with the distance from the edge, by default ``GRADING`` over
    the root of the elements a zone; ``domain_ratio`` the domain radius over the largest contact radius, by
    default the mesh's own. ``far_field``: the displacement of the total force is prescribed on the far
    boundary, or it is held; without ``cached_mesh`` the mesh is made anew, as part of the run time.
    """

    grading: float | None = None
    domain_ratio: float | None = None
    far_field: bool = True
    cached_mesh: bool = True

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
        **AT_EXTREMA,
        **dict.fromkeys(("branch_dissipation", "zone_excess"), 0.08),
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

        own = Options(far_field=self.far_field, **options.of_solver)

        def run(made: meshes.EdgeMeshes) -> Trace:
            return solve(scene, made, own, options.progress, options.monitor)

        return self.on_meshes(scene, resolution, run, lambda trace: trace)

    def on_meshes(
        self,
        scene: Scene,
        resolution: int | None,
        run: Callable[[meshes.EdgeMeshes], Run],
        trace_of: Callable[[Run], Trace],
    ) -> Run:
        """A run on the meshes of a scene, made anew where contact stays far below what its loading tells."""
        divisions, largest = resolution or self.default_resolution(scene), largest_contact_radius(scene)
        while True:
            found = run(self._places(scene, divisions, largest))
            trace = trace_of(found)
            reached = RESERVE * float(trace.contact_radius.max(initial=0.0))
            ended = trace.outcome is not None and trace.outcome.finished
            if scene.is_adhesive or not ended or not 0.0 < RESERVE * reached < largest:
                return found
            largest = reached

    def mesh(self, scene: Scene, resolution: int | None = None) -> meshes.EdgeMeshes:
        """The meshes of a scene; one that is too large refuses when it is made."""
        return self._places(
            scene, resolution or self.default_resolution(scene), largest_contact_radius(scene)
        )

    def _places(self, scene: Scene, divisions: int, largest: float) -> meshes.EdgeMeshes:
        return meshes.EdgeMeshes(
            resolved_length(scene, largest),
            divisions,
            largest,
            self._growth(divisions) * slower_growth(scene),
            self.domain_ratio,
            self.cached_mesh,
        )

    def _growth(self, divisions: int) -> float:
        """Growth of the element size with the distance from the edge."""
        return self.grading or min(GRADING / math.sqrt(divisions), WIDEST)

    def parameters(self, scene: Scene, divisions: int) -> meshes.MeshParameters:
        """Of the largest mesh; ``ValueError`` if it is too large."""
        largest = largest_contact_radius(scene)
        made = self._places(scene, divisions, largest)
        return made.parameters(made.place(largest).level)

    def mesh_bytes(self, scene: Scene, divisions: int) -> float:
        """Memory of the mesh and what is worked out on it before the first step, to a factor of 1.3."""
        largest = largest_contact_radius(scene)
        zones = largest / resolved_length(scene, largest)
        elements = divisions * max(math.log2(max(zones, 1.0)) / FEW_HALVINGS, 1.0) / slower_growth(scene) ** 2
        return BYTES[0] + BYTES[1] * min(elements, 1e30)

    def check(self, scene: Scene, resolution: int | None = None) -> None:
        """As of every solver; a mesh may be too large too, of itself or for the memory of the machine."""
        super().check(scene, resolution)
        divisions, installed = resolution or self.default_resolution(scene), installed_memory()
        try:
            self.parameters(scene, divisions)
        except ValueError as error:
            problem = f"no mesh for this scene: {error}"
            raise SceneError("", problem, self._advice(scene, divisions)) from None
        needed = self.mesh_bytes(scene, divisions)
        if installed is not None and needed > installed:
            there = f"{1e-9 * installed:.3g} GB are installed"
            problem = f"at resolution {divisions} it takes about {1e-9 * needed:.3g} GB of memory, {there}"
            raise SceneError("", problem, self._advice(scene, divisions))

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
        """The default: the mesh follows the edge, and fewer elements are hardly cheaper."""
        return self.default_resolution(scene)

    def coarse_resolution(self, adhesive: bool) -> int:
        return 4 if adhesive else 2

    def comparison_run(self, scene: Scene, resolution: int | None = None) -> ComparisonRun:
        """Half the resolution, the grading by its root, four times the step tolerance; or the reverse."""
        divisions, other = self._other_resolution(scene, resolution)
        ratio = divisions / other
        method = replace(self, grading=min(math.sqrt(ratio) * self._growth(divisions), meshes.WIDEST))
        return ComparisonRun(partial(method.solve, scene, other), ratio)


def resolved_length(scene: Scene, largest: float) -> float:
    """Length that the resolution divides: the process zone, or less where that of a closing edge is short.

    Without adhesion a share of the largest contact radius.
    """
    if scene.adhesion is None or not scene.is_adhesive:
        return largest / PRESSED_LENGTHS
    return min(scene.adhesion.zone, LEAST_DIVISIONS * scene.adhesion.closing_zone)


def slower_growth(scene: Scene) -> float:
    """Factor on the growth of the elements where a layer is thin; 1 for a half-space."""
    if scene.body is None:
        return 1.0
    return math.sqrt(min(THICK * scene.body.thickness / largest_contact_radius(scene), 1.0))
