"""The methods that a study compares: every registered solver, and variants of two of them.

A method that cannot be imported or breaks down is a failed level of its ladder. Finite-element runs build
their mesh anew, so that meshing is part of their run time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from contact_scene import Scene, Trace
from validation.solvers import SOLVERS, Solver
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.front_tracking import FrontTracking


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
        The paper's scheme: its fixed time step.
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

    @property
    def of_solver(self) -> dict[str, Any]:
        """Settings that are fields of a solver object, those left to the solver omitted."""
        names = ("step_resolution", "step", "grading", "domain_ratio")
        settings = {name: value for name in names if (value := getattr(self, name)) is not None}
        return settings if self.far_field else settings | {"far_field": False}


@dataclass(frozen=True)
class Scheme:
    """A method of a study.

    Parameters
    ----------
    name, title : str
        Short name; the method in words.
    nominal : float
        Order that its design promises.
    why : str
        Reason for that order.
    solver : Solver
    line : mapping
        Line properties that differ from those of the solver.
    """

    name: str
    title: str
    nominal: float
    why: str
    solver: Solver
    line: Mapping[str, Any] | None = None

    @property
    def curve_style(self) -> dict[str, Any]:
        """Line properties for matplotlib, marker included."""
        return {**self.solver.curve_style, "marker": self.solver.marker, **(self.line or {})}

    def solve(
        self,
        scene: Scene,
        settings: Settings,
        stop_times: tuple[float, ...] = (),
        max_steps: int | None = None,
    ) -> Trace:
        """Solve a scene with the settings of one level.

        Parameters
        ----------
        scene : Scene
        settings : Settings
        stop_times : tuple of float
            Stepped onto.
        max_steps : int or None
            ``None``: the solver's own bound.

        Returns
        -------
        Trace
        """
        return self._solver_with(settings).solve(
            with_zone(scene, settings.zone_factor),
            settings.resolution,
            step_tolerance=settings.tolerance,
            stop_times=stop_times,
            max_steps=max_steps,
        )

    def _solver_with(self, settings: Settings) -> Solver:
        changes: Any = settings.of_solver
        return replace(self.solver, **changes) if changes else self.solver  # type: ignore[type-var]


def with_zone(scene: Scene, factor: float) -> Scene:
    """The scene with its process zone multiplied by ``factor``."""
    if factor == 1.0 or scene.adhesion is None:
        return scene
    return replace(scene, adhesion=replace(scene.adhesion, zone=factor * scene.adhesion.zone))


_FIRST = "The edge sits on borders and the history is backward Euler: first order by construction."
_SECOND = "Continuous edge, exact recursion in time: second order in zone divisions and steps."
_ELEMENTS = (
    "Between 2, of node release and steps, and 4, of integral quantities on quadratic elements: coarse "
    "levels can fall faster than the nominal order."
)
_STRAIGHT = "Loading and history are straight within a step: second order in the step."

PAPER = "paper-scheme"
VOLUME = f"{FiniteElements.name}-volume"
SCHEMES: dict[str, Scheme] = {
    scheme.name: scheme
    for scheme in (
        Scheme(
            BoundaryElements.name, "boundary elements, default", 2.0, _SECOND, SOLVERS[BoundaryElements.name]
        ),
        Scheme(
            PAPER,
            "the paper's uniform annuli with backward Euler",
            1.0,
            _FIRST,
            BoundaryElements(annuli="uniform", scheme="backward-euler"),
            {"color": "#009e73", "linestyle": (0, (1, 1.2)), "marker": "^"},
        ),
        Scheme(
            FiniteElements.name,
            "finite elements, condensed on the surface",
            2.0,
            _ELEMENTS,
            FiniteElements(cached_mesh=False),
        ),
        Scheme(
            VOLUME,
            "finite elements, history in the volume",
            2.0,
            _ELEMENTS,
            FiniteElements(path="quadrature", cached_mesh=False),
            {"color": "#cc79a7", "linestyle": (0, (5, 1.5, 1, 1.5)), "marker": "v"},
        ),
        Scheme(FrontTracking.name, FrontTracking.title, 2.0, _STRAIGHT, SOLVERS[FrontTracking.name]),
    )
}


def scheme(name: str) -> Scheme:
    """A scheme by name; a solver without a scheme of its own is one with its defaults."""
    if name in SCHEMES:
        return SCHEMES[name]
    solver = SOLVERS[name]
    return Scheme(name, solver.title, solver.order, "The order observed in whole runs.", solver)
