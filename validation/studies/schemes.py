"""The ways of solving a scene that a study prices: each solver, and the paper's own scheme beside them.

A scheme is imported when it is asked for; one that is missing or breaks down is a failed level of its ladder.
Finite-element runs build their mesh anew, so that meshing is part of their price.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from contact_scene import Scene, Trace
    from meshes import HalfSpaceMesh


@dataclass(frozen=True)
class Settings:
    """What a ladder may change; ``None`` leaves the choice to the solver.

    Parameters
    ----------
    resolution : int
        Divisions per process zone (without adhesion: per hundredth of the largest contact radius).
    tolerance : float, optional
        Of the time steps.
    step_resolution : int, optional
        Finite elements: divisions that the steps resolve, where they differ from those of the mesh.
    step : float, optional
        Baseline: its fixed time step.
    grading, domain_ratio : float, optional
        Finite elements: growth of the element size, and domain radius over the largest contact radius.
    far_field : bool
        Finite elements: prescribe the displacement of the total force on the far boundary, or hold it.
    zone_factor : float
        The scene's process zone is multiplied by it; this changes the model.
    """

    resolution: int
    tolerance: float | None = None
    step_resolution: int | None = None
    step: float | None = None
    grading: float | None = None
    domain_ratio: float | None = None
    far_field: bool = True
    zone_factor: float = 1.0


Scheme = Callable[["Scene", Settings, "tuple[float, ...]"], "Trace"]


@dataclass(frozen=True)
class Named:
    """A scheme by name: what it is in words, the order its design promises and why, and how to get it."""

    name: str
    title: str
    nominal: float
    why: str
    load: Callable[[], Scheme]


def with_zone(scene: Scene, factor: float) -> Scene:
    """The scene with its process zone multiplied by ``factor``."""
    if factor == 1.0 or scene.adhesion is None:
        return scene
    return replace(scene, adhesion=replace(scene.adhesion, zone=factor * scene.adhesion.zone))


def _bem() -> Scheme:
    from bem_solver import Options, solve

    return lambda scene, s, times: solve(scene, Options(s.resolution, s.tolerance, profile_times=times))


def _baseline() -> Scheme:
    from bem_solver import Options, solve

    def call(scene: Scene, s: Settings, times: tuple[float, ...]) -> Trace:
        paper: dict[str, Any] = {"annuli": "uniform", "scheme": "backward-euler"}
        return solve(scene, Options(s.resolution, s.tolerance, profile_times=times, step=s.step, **paper))

    return call


def _fem(path: Literal["auto", "quadrature"] = "auto") -> Scheme:
    from fem_solver import Options, solve

    def call(scene: Scene, s: Settings, times: tuple[float, ...]) -> Trace:
        steps = s.step_resolution or s.resolution
        options = Options(steps, s.tolerance, profile_times=times, path=path, far_field=s.far_field)
        return solve(scene, mesh_for(scene, s), options)

    return call


def _reference() -> Scheme:
    from validation.reference import Options, solve

    return lambda scene, s, times: solve(scene, Options(s.resolution, s.tolerance, profile_times=times))


def mesh_for(scene: Scene, s: Settings) -> HalfSpaceMesh:
    """A mesh of the declared grading and domain, never one remembered."""
    import meshes
    from validation.solvers.contact_range import largest_contact_radius

    largest = largest_contact_radius(scene)
    edge = scene.indenter.edge if scene.indenter.edge < float("inf") else None
    zone = scene.adhesion.zone if scene.adhesion is not None and scene.is_adhesive else 0.01 * largest
    chosen = {"grading": s.grading, "domain_ratio": s.domain_ratio}
    given: dict[str, Any] = {name: value for name, value in chosen.items() if value is not None}
    start = edge if edge is not None else 0.0
    return meshes.half_space(meshes.fit(start, largest, zone, s.resolution, edge=edge, **given))


_FIRST = "The edge sits on borders and the history is backward Euler: first order by construction."
_SECOND = "Continuous edge, exact recursion in time: second order in zone divisions and steps."
_ELEMENTS = (
    "Between 2, of node release and steps, and 4, of integral quantities on quadratic elements: coarse "
    "levels can fall faster than the nominal order."
)
_STRAIGHT = "Loading and history are straight within a step: second order in the step."

SCHEMES: dict[str, Named] = {
    scheme.name: scheme
    for scheme in (
        Named("bem", "boundary elements, default", 2.0, _SECOND, _bem),
        Named("baseline", "the paper's uniform annuli with backward Euler", 1.0, _FIRST, _baseline),
        Named("fem", "finite elements, condensed on the surface", 2.0, _ELEMENTS, _fem),
        Named(
            "fem-volume",
            "finite elements, history in the volume",
            2.0,
            _ELEMENTS,
            lambda: _fem("quadrature"),
        ),
        Named("reference", "front tracking", 2.0, _STRAIGHT, _reference),
    )
}
