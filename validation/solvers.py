"""The solvers by name, each behind the same call; a solver is imported when it is asked for.

A solver is ``function(scene, resolution, tolerance, profile_times, progress) -> Trace``; ``None`` for
resolution or tolerance leaves the choice to the solver. A sixth argument, a ``RunMonitor``, is given
where the run may be stopped and gone on with.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contact_scene import RunMonitor, Scene, Trace

Progress = Callable[[float], None]
Solver = Callable[..., "Trace"]
REFERENCE = "reference"


def _bem() -> Solver:
    """Boundary elements: annuli on the surface."""
    from bem_solver import Options, solve

    def call(
        scene: Scene,
        resolution: int | None,
        tolerance: float | None,
        profile_times: tuple[float, ...],
        progress: Progress | None,
        watch: RunMonitor | None = None,
    ) -> Trace:
        return solve(scene, Options(resolution, tolerance, profile_times=profile_times), progress, watch)

    return call


@dataclass(frozen=True)
class FiniteElements:
    """Finite elements with node release, on a mesh fitted to the scene.

    ``grading`` is the growth of the elements with the distance from the edge; ``None``: the mesh's default.
    """

    grading: float | None = None

    def __call__(
        self,
        scene: Scene,
        resolution: int | None,
        tolerance: float | None,
        profile_times: tuple[float, ...],
        progress: Progress | None,
        watch: RunMonitor | None = None,
    ) -> Trace:
        from fem_solver import Options, solve
        from validation.contact_range import mesh_for

        mesh = mesh_for(scene, resolution, self.grading)
        return solve(
            scene, mesh, Options(resolution, tolerance, profile_times=profile_times), progress, watch
        )

    @property
    def coarser(self) -> FiniteElements:
        """The same on meshes that grade twice as fast."""
        from validation.contact_range import GRADING

        return FiniteElements(2.0 * (self.grading or GRADING))


@dataclass(frozen=True)
class FrontTracking:
    """Front tracking under the Abel transform."""

    estimate_errors: bool = False

    def __call__(
        self,
        scene: Scene,
        resolution: int | None,
        tolerance: float | None,
        profile_times: tuple[float, ...],
        progress: Progress | None,
        watch: RunMonitor | None = None,
    ) -> Trace:
        from validation.reference import Options, solve

        options = Options(
            resolution, tolerance, profile_times=profile_times, estimate_errors=self.estimate_errors
        )
        return solve(scene, options, progress, watch)

    @property
    def estimating(self) -> FrontTracking:
        """The same with estimates of its errors."""
        return FrontTracking(True)


def _fem() -> Solver:
    import fem_solver  # noqa: F401  # imports are not part of a run

    return FiniteElements()


def _reference() -> Solver:
    import validation.reference  # noqa: F401

    return FrontTracking()


SOLVERS: dict[str, Callable[[], Solver]] = {"bem": _bem, "fem": _fem, REFERENCE: _reference}
