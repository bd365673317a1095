"""The solvers by name, each behind the same call; a solver is imported when it is asked for.

A solver is ``function(scene, resolution, tolerance, profile_times, progress) -> Trace``; ``None`` for
resolution or tolerance leaves the choice to the solver.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scene import Scene, Trace

Progress = Callable[[float], None]
Solver = Callable[
    ["Scene", "int | None", "float | None", "tuple[float, ...]", "Progress | None"],
    "Trace",
]
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
    ) -> Trace:
        return solve(scene, Options(resolution, tolerance, profile_times=profile_times), progress)

    return call


def _fem() -> Solver:
    """Finite elements with node release, on a mesh fitted to the scene."""
    from fem_solver import Options, solve
    from validation.contact_range import mesh_for

    def call(
        scene: Scene,
        resolution: int | None,
        tolerance: float | None,
        profile_times: tuple[float, ...],
        progress: Progress | None,
    ) -> Trace:
        mesh = mesh_for(scene, resolution)
        return solve(scene, mesh, Options(resolution, tolerance, profile_times), progress)

    return call


def _reference() -> Solver:
    """Front tracking under the Abel transform."""
    from validation.reference import Options, solve

    def call(
        scene: Scene,
        resolution: int | None,
        tolerance: float | None,
        profile_times: tuple[float, ...],
        progress: Progress | None,
    ) -> Trace:
        return solve(scene, Options(resolution, tolerance, profile_times=profile_times), progress)

    return call


SOLVERS: dict[str, Callable[[], Solver]] = {"bem": _bem, "fem": _fem, REFERENCE: _reference}
