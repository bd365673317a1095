"""What a study refines: the methods it compares, the settings of a level, and the ladders of levels.

- ``together``: resolution in space and in time at once; these levels are also timed.
- ``step``: the time step alone, on a fixed discretisation in space.
- ``mesh``: the discretisation in space alone, at a fixed small step.
- ``domain``: the radius of the finite-element domain alone. Boundary elements and front tracking know the
  exact half-space: they have no domain to enlarge.
- ``zone``: the process zone of the model. Not a numerical parameter: the answer changes with it, and every
  solver has to say by how much.

The front tracking has no mesh: its nodes are where the edge has been, so its step is all there is to refine,
and ``together`` is its ladder of steps. Finite-element runs build their mesh anew, so that meshing is part of
their run time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from contact_scene import Scene
from validation.cases import Case
from validation.runs.run import Run, run
from validation.solvers import SOLVERS, Solver
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.front_tracking import FrontTracking

BEM, FEM, REFERENCE = BoundaryElements.name, FiniteElements.name, FrontTracking.name
PAPER = "paper-scheme"
FINEST, FINEST_ADHESIONLESS = (80, 60, 40), (16, 8)
"""Resolutions of the front tracking that errors are measured against; the first that reaches its end. Without
adhesion per hundredth of the largest contact radius."""


@dataclass(frozen=True)
class Settings:
    """What a ladder may change; ``None`` leaves the choice to the solver.

    ``resolution`` is in divisions per process zone (without adhesion: per hundredth of the largest contact
    radius), ``tolerance`` that of the time steps, ``step`` the fixed one of the paper's scheme. Of finite
    elements: growth of the element size; domain radius over the largest contact radius; whether the
    displacement of the total force is prescribed on the far boundary, or it is held. The scene's process zone
    is multiplied by ``zone_factor``, which changes the model.
    """

    resolution: int
    tolerance: float | None = None
    step: float | None = None
    grading: float | None = None
    domain_ratio: float | None = None
    far_field: bool = True
    zone_factor: float = 1.0

    @property
    def of_solver(self) -> dict[str, Any]:
        """Settings that are fields of a solver object, those left to the solver omitted."""
        names = ("step", "grading", "domain_ratio")
        settings = {name: value for name in names if (value := getattr(self, name)) is not None}
        return settings if self.far_field else settings | {"far_field": False}


@dataclass(frozen=True)
class Scheme:
    """A method of a study: a registered solver or a variant of one.

    ``nominal`` is the order that its design promises, ``why`` the reason for it, ``line`` line properties
    that differ from those of the solver.
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

    def run(self, case: Case, settings: Settings, max_steps: int | None = None) -> Run:
        """Run a scene with the settings of one level; a breakdown is part of the answer."""
        changes: Any = settings.of_solver
        solver: Solver = replace(self.solver, **changes) if changes else self.solver  # type: ignore[type-var]
        asked = replace(case, scene=with_zone(case.scene, settings.zone_factor), profile_times=())
        tolerance = settings.tolerance
        return run(asked, solver, settings.resolution, max_steps=max_steps, step_tolerance=tolerance)


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
_ANNULI = BoundaryElements(annuli="uniform", scheme="backward-euler")
_DOTTED = {"color": "#009e73", "linestyle": (0, (1, 1.2)), "marker": "^"}
SCHEMES: dict[str, Scheme] = {
    scheme.name: scheme
    for scheme in (
        Scheme(BEM, "boundary elements, default", 2.0, _SECOND, SOLVERS[BEM]),
        Scheme(PAPER, "the paper's uniform annuli with backward Euler", 1.0, _FIRST, _ANNULI, _DOTTED),
        Scheme(
            FEM,
            "finite elements, history on the surface",
            2.0,
            _ELEMENTS,
            FiniteElements(cached_mesh=False),
        ),
        Scheme(REFERENCE, FrontTracking.title, 2.0, _STRAIGHT, SOLVERS[REFERENCE]),
    )
}


def scheme(name: str) -> Scheme:
    """A scheme by name; a solver without a scheme of its own is one with its defaults."""
    if name in SCHEMES:
        return SCHEMES[name]
    solver = SOLVERS[name]
    return Scheme(name, solver.title, solver.order, "The order observed in whole runs.", solver)


@dataclass(frozen=True)
class Level:
    """One level of refinement: its relative size, its label, and the settings."""

    size: float
    label: str
    settings: Settings


@dataclass(frozen=True)
class Ladder:
    """A scheme at several levels, coarse to fine; ``nominal`` order: ``None`` takes the scheme's own."""

    scheme: str
    kind: str
    refined: str
    levels: tuple[Level, ...]
    nominal: float | None = None

    @property
    def timed(self) -> bool:
        """Whether its levels are points of error against run time."""
        return self.kind == "together"


HELD = "domain, far boundary held"
"""Kind of a ladder."""


def finest(scene: Scene) -> tuple[int, ...]:
    """Resolutions of the front tracking to measure errors against, the finest first."""
    return FINEST if scene.is_adhesive else FINEST_ADHESIONLESS


def ladders(scene: Scene) -> list[Ladder]:
    """All ladders of a study of this scene."""
    adhesive = scene.is_adhesive
    four, annuli = (4, 8, 16, 32), (4, 8, 16, 32, 64) if adhesive else (4, 8, 16, 32)
    first, bodies = (4, (4, 6, 8, 12)) if adhesive else (2, (2, 4, 6, 8))
    meshes, steps = ((3, 4, 6, 8), (5, 10, 20, 40)) if adhesive else ((2, 4, 6, 8), (4, 6, 8, 12))

    def elements(n: float) -> Settings:
        return Settings(int(n), tolerance=5e-3 * (first / n) ** 2)

    def mesh(n: float) -> Settings:
        return Settings(int(n), tolerance=2e-4, grading=0.5 * meshes[0] / n)

    def step(n: float) -> Settings:
        return Settings(4, tolerance=5e-3 * (4 / n) ** 2)

    def tolerance(n: float) -> Settings:
        return Settings(8, tolerance=0.01 / n**2)

    def domain(n: float, far_field: bool = True) -> Settings:
        return Settings(4, domain_ratio=n, far_field=far_field)

    graded = "elements per zone; step tolerance with their square"
    held = partial(
        domain, far_field=False
    )  # which the displacement F/r of a force makes wrong to first order
    found = [
        _ladder(BEM, "together", "annuli per zone; step tolerance with their square", annuli),
        _ladder(PAPER, "together", "annuli per zone; fixed step in proportion", annuli),
        _ladder(FEM, "together", graded, bodies, elements),
        _ladder(REFERENCE, "together", "steps per zone; tolerance with their square", steps),
        _ladder(
            BEM, "step", "step tolerance, by 4, on 8 annuli per zone", (1, 2, 4, 8), tolerance,
            lambda n: f"tolerance {0.01 / n**2:.2g}",
        ),
        _ladder(FEM, "step", "step, at 4 elements per zone", (2, 4, 8, 16), step, "steps {:g}".format),
        _ladder(
            BEM, "mesh", "annuli per zone, at step tolerance 6e-4", four,
            lambda n: Settings(int(n), tolerance=6e-4),
        ),
        _ladder(FEM, "mesh", "elements per zone, grading, at step tolerance 2e-4", meshes, mesh),
        # the far boundary carries the displacement of the total force, so the error is small
        _ladder(
            FEM, "domain", "domain radius over the largest contact radius", (12.5, 25.0, 50.0, 100.0), domain,
            "{:g} a".format, nominal=2.0,
        ),
        _ladder(
            FEM, HELD, "domain radius, no far field", (25.0, 50.0, 100.0, 200.0), held,
            "{:g} a".format, nominal=1.0,
        ),
    ]  # fmt: skip
    if adhesive:
        found += [_zone_ladder(BEM, 6), _zone_ladder(FEM, 4), _zone_ladder(REFERENCE, 5)]
    if scene.body is not None:  # uniform annuli know no layer, which is known beside a half-space without end
        found = [each for each in found if each.scheme != PAPER and each.kind != HELD]
    others = [name for name in SOLVERS if name not in SCHEMES]
    return found + [_ladder(name, "together", "divisions per zone", four) for name in others]


def _zone_ladder(name: str, divisions: int) -> Ladder:
    return _ladder(
        name,
        "zone",
        f"process zone of the model (the answer changes), at {divisions} divisions of each",
        (0.5, 1.0, 2.0, 4.0),
        lambda n: Settings(divisions, zone_factor=1.0 / n),
        lambda n: f"zone x {1.0 / n:g}",
        nominal=1.0,
    )


def _ladder(
    name: str,
    kind: str,
    refined: str,
    fineness: Sequence[float],
    settings: Callable[[float], Settings] = lambda n: Settings(int(n)),
    label: Callable[[float], str] = "{:g}".format,
    nominal: float | None = None,
) -> Ladder:
    levels = tuple(Level(1.0 / n, label(n), settings(n)) for n in fineness)
    return Ladder(name, kind, refined, levels, nominal)
