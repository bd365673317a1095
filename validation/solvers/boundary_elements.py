"""Boundary elements as a solver of the registry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from bem_solver import Options, solve
from bem_solver.options import DEFAULT_RESOLUTION
from contact_scene import Scene, Trace
from validation.solvers.base import AT_EXTREMA, RunOptions, Solver


@dataclass(frozen=True)
class BoundaryElements(Solver):
    """Annuli on the surface.

    ``annuli`` and ``scheme`` as in ``bem_solver.Options``: ``"uniform"`` with ``"backward-euler"`` is the
    paper's own scheme, whose time step ``step`` may fix. The order of whole runs is 1: static states converge
    faster, but the annuli that resolve the layer behind an advancing edge do not double with the resolution,
    and with order 2 the error estimates of whole cycles were below the true error, by up to 1.7 times in the
    quick suite.
    """

    annuli: str = "graded"
    scheme: str = "exponential"
    step: float | None = None

    name = "bem"
    title = "boundary elements"
    description = (
        "Rings of constant pressure on the surface, which travel with the contact edge; the history is "
        "carried at points of the surface. The paper's own discretisation is a setting of it."
    )
    order = 1.0
    tolerance = 5e-3
    curve_tolerance = 5e-3
    quantity_tolerances: ClassVar[Mapping[str, float]] = {
        **AT_EXTREMA,
        **dict.fromkeys(("branch_dissipation", "zone_excess"), 0.01),
    }
    coarse_tolerance = 1e-2
    curve_style: ClassVar[Mapping[str, Any]] = {"color": "#0072b2", "linestyle": "-", "linewidth": 1.4}
    marker = "o"
    css_variable = "bem"

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        own = Options(resolution, annuli=self.annuli, scheme=self.scheme, step=self.step, **options.of_solver)
        return solve(scene, own, options.progress, options.monitor)

    def check(self, scene: Scene, resolution: int | None = None) -> None:
        """As of every solver; its resolution has an upper bound."""
        super().check(scene, resolution)
        Options(resolution)

    def default_resolution(self, scene: Scene) -> int:
        return DEFAULT_RESOLUTION

    def coarse_resolution(self, adhesive: bool) -> int:
        return 6
