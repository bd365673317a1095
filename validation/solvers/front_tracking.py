"""Front tracking under the Abel transform as a solver of the registry: what the others are compared with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from contact_scene import Scene, Trace
from validation.reference.path import Options, solve
from validation.reference.path.solver import DEFAULT_RESOLUTION
from validation.solvers.base import REFERENCE, RunOptions, Solver


@dataclass(frozen=True)
class FrontTracking(Solver):
    """Front tracking, which estimates its own errors; its tolerances are for changes between two reports."""

    name = REFERENCE
    title = "front tracking"
    description = (
        "Under the Abel transform every point of the contact knows only its own history; the edge is "
        "tracked. Nearly exact, with error estimates of its own: the other solvers are measured against it."
    )
    order = 2.0
    tolerance = 5e-4
    curve_tolerance = 5e-4
    coarse_tolerance = 2e-3
    least_resolution = 1
    estimates_errors = True
    curve_style: ClassVar[Mapping[str, Any]] = {"color": "#999999", "linestyle": "-", "linewidth": 3.6}
    marker = "D"
    css_variable = "reference"

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        own = Options(resolution, estimate_errors=options.estimate_errors, **options.of_solver)
        return solve(scene, own, options.progress, options.monitor)

    def default_resolution(self, scene: Scene) -> int:
        return DEFAULT_RESOLUTION

    def coarse_resolution(self, adhesive: bool) -> int:
        return 8
