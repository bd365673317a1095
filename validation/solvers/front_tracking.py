"""Front tracking under the Abel transform as a solver of the registry: what the others are compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from contact_scene import RunMonitor, Scene, Trace
from validation.solvers.base import Progress, Solver, cycle_count, specified

REFERENCE = "reference"


@dataclass(frozen=True)
class FrontTracking(Solver):
    """Front tracking, which estimates its errors itself; its tolerances are what it may change between reports."""

    name: ClassVar[str] = REFERENCE
    title: ClassVar[str] = "front tracking"
    order: ClassVar[float] = 2.0
    tolerance: ClassVar[float] = 5e-4
    curve_tolerance: ClassVar[float] = 5e-4
    coarse_tolerance: ClassVar[float] = 2e-3
    estimates_errors: ClassVar[bool] = True
    curve_style: ClassVar[dict[str, Any]] = {"color": "#999999", "linestyle": "-", "linewidth": 3.6}
    marker: ClassVar[str] = "D"
    css_variable: ClassVar[str] = "reference"

    def solve(
        self,
        scene: Scene,
        resolution: int | None = None,
        *,
        step_tolerance: float | None = None,
        stop_times: tuple[float, ...] = (),
        profile_times: tuple[float, ...] = (),
        max_steps: int | None = None,
        progress: Progress | None = None,
        monitor: RunMonitor | None = None,
        estimate_errors: bool = False,
    ) -> Trace:
        """See :meth:`Solver.solve`."""
        from validation.reference import Options, solve

        options = Options(
            resolution,
            step_tolerance,
            stop_times=stop_times,
            profile_times=profile_times,
            estimate_errors=estimate_errors,
            **specified(max_steps=max_steps),
        )
        return solve(scene, options, progress, monitor)

    def load(self) -> None:
        """Import the solver."""
        import validation.reference  # noqa: F401

    def default_resolution(self, scene: Scene) -> int:
        """As in ``validation.reference.Options``."""
        from validation.reference.tracking.options import RESOLUTION

        return int(RESOLUTION[scene.is_adhesive])

    def coarse_resolution(self, adhesive: bool) -> int:
        """Eight; without adhesion four."""
        return 8 if adhesive else 4

    def expected_seconds(self, scene: Scene) -> float:
        """From the built-in scenes: a run, and each of its cycles."""
        return 1.2 + 0.3 * cycle_count(scene)
