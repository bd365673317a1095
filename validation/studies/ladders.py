"""Refinement ladders: which settings change from level to level, and by how much.

- ``together``: resolution in space and in time at once; these levels are also timed.
- ``step``: the time step alone, on a fixed discretisation in space.
- ``mesh``: the discretisation in space alone, at a fixed small step.
- ``domain``: the radius of the finite-element domain alone. Boundary elements and front tracking know the
  exact half-space: they have no domain to enlarge.
- ``zone``: the process zone of the model. Not a numerical parameter: the answer changes with it, and every
  solver has to say by how much.

The front tracking has no mesh: its nodes are where the edge has been, so its step is all there is to refine,
and ``together`` is its ladder of steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from contact_scene import Scene
from validation.solvers import REFERENCE, SOLVERS
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.studies.schemes import PAPER, SCHEMES, VOLUME, Settings

BEM, FEM = BoundaryElements.name, FiniteElements.name
FINEST = (80, 60, 40)
"""Resolutions of the front tracking that errors are measured against; the first that reaches its end."""
FINEST_ADHESIONLESS = (16, 8)
"""The same without adhesion, per hundredth of the largest contact radius."""
STEEPEST = 0.5
"""Largest grading of a mesh."""


@dataclass(frozen=True)
class Level:
    """One level of refinement: its relative size, its label, and the settings."""

    size: float
    label: str
    settings: Settings


@dataclass(frozen=True)
class Ladder:
    """A scheme at several levels, coarse to fine.

    ``nominal`` is the order expected; ``None`` takes the scheme's own.
    """

    scheme: str
    kind: str
    refined: str
    levels: tuple[Level, ...]
    nominal: float | None = None

    @property
    def timed(self) -> bool:
        """Whether its levels are points of error against run time."""
        return self.kind == "together"


def finest(scene: Scene) -> tuple[int, ...]:
    """Resolutions of the front tracking to measure errors against, the finest first."""
    return FINEST if scene.is_adhesive else FINEST_ADHESIONLESS


def ladders(scene: Scene) -> list[Ladder]:
    """All ladders of a study of this scene."""
    all_ladders = [_bem(scene), _paper(scene), _fem(scene), _fem_volume(scene), _reference(scene)]
    all_ladders += [_bem_step(), _fem_step(), _bem_mesh(), _fem_mesh(scene), _fem_domain(), _fem_held()]
    if scene.is_adhesive:
        all_ladders += [_zone(BEM, 6), _zone(FEM, 4), _zone(REFERENCE, 5)]
    return all_ladders + [_other(name) for name in SOLVERS if name not in SCHEMES]


def _other(name: str) -> Ladder:
    """A registered solver without a ladder of its own: by its resolution alone."""
    levels = tuple(_by_resolution(n, Settings(n)) for n in (4, 8, 16, 32))
    return Ladder(name, "together", "divisions per zone", levels)


def _bem(scene: Scene) -> Ladder:
    sizes = (4, 8, 16, 32, 64) if scene.is_adhesive else (4, 8, 16, 32)
    levels = tuple(_by_resolution(n, Settings(n)) for n in sizes)
    return Ladder(BEM, "together", "annuli per zone; step tolerance with their square", levels)


def _paper(scene: Scene) -> Ladder:
    sizes = (4, 8, 16, 32, 64) if scene.is_adhesive else (4, 8, 16, 32)
    levels = tuple(_by_resolution(n, Settings(n)) for n in sizes)
    return Ladder(PAPER, "together", "annuli per zone; fixed step in proportion", levels)


def _fem(scene: Scene) -> Ladder:
    levels = _fem_levels(scene, (4, 6, 8, 12) if scene.is_adhesive else (2, 4, 6, 8))
    return Ladder(
        FEM,
        "together",
        "elements per zone, grading; step tolerance with their square",
        levels,
    )


def _fem_volume(scene: Scene) -> Ladder:
    """The same answer as the condensed form, at higher cost: the levels stay coarse."""
    levels = _fem_levels(scene, (3, 4, 5, 6) if scene.is_adhesive else (2, 4, 6, 8))
    refined = "as the condensed form, whose answer it repeats: only the price is of interest"
    return Ladder(VOLUME, "together", refined, levels)


def _fem_levels(scene: Scene, sizes: tuple[int, ...]) -> tuple[Level, ...]:
    """Grading with the element size: near and far are refined alike. The tolerance falls with the square."""
    first = 4 if scene.is_adhesive else 2
    return tuple(
        _by_resolution(
            n, Settings(n, tolerance=5e-3 * (first / n) ** 2, grading=min(0.5 * first / n, STEEPEST))
        )
        for n in sizes
    )


def _reference(scene: Scene) -> Ladder:
    sizes = (5, 10, 20, 40) if scene.is_adhesive else (4, 6, 8, 12)
    levels = tuple(_by_resolution(n, Settings(n)) for n in sizes)
    return Ladder(REFERENCE, "together", "steps per zone; tolerance with their square", levels)


def _bem_step() -> Ladder:
    fixed = Settings(8)
    levels = tuple(
        Level(2.0**-k, f"tolerance {t:.2g}", replace(fixed, tolerance=t))
        for k in range(4)
        if (t := 0.01 * 4.0**-k)
    )
    return Ladder(BEM, "step", "step tolerance, by 4, on 8 annuli per zone", levels)


def _fem_step() -> Ladder:
    fixed = Settings(4)
    levels = tuple(
        Level(1.0 / n, f"steps {n}", replace(fixed, step_resolution=n, tolerance=5e-3 * (4 / n) ** 2))
        for n in (2, 4, 8, 16)
    )
    return Ladder(FEM, "step", "step, at 4 elements per zone", levels)


def _bem_mesh() -> Ladder:
    levels = tuple(_by_resolution(n, Settings(n, tolerance=6e-4)) for n in (4, 8, 16, 32))
    return Ladder(BEM, "mesh", "annuli per zone, at step tolerance 6e-4", levels)


def _fem_mesh(scene: Scene) -> Ladder:
    sizes = (3, 4, 6, 8) if scene.is_adhesive else (2, 4, 6, 8)
    levels = tuple(
        _by_resolution(n, Settings(n, step_resolution=12, tolerance=6e-4, grading=0.5 * sizes[0] / n))
        for n in sizes
    )
    return Ladder(FEM, "mesh", "elements per zone, grading, at 12 steps per zone", levels)


def _fem_domain() -> Ladder:
    """The far boundary carries the displacement of the total force, so the error is small."""
    levels = tuple(_domain(ratio, True) for ratio in (12.5, 25.0, 50.0, 100.0))
    return Ladder(FEM, "domain", "domain radius over the largest contact radius", levels, nominal=2.0)


def _fem_held() -> Ladder:
    """The far boundary held, which the displacement ``F/r`` of a force makes wrong to first order."""
    levels = tuple(_domain(ratio, False) for ratio in (25.0, 50.0, 100.0, 200.0))
    return Ladder(FEM, "domain, far boundary held", "domain radius, no far field", levels, nominal=1.0)


def _domain(ratio: float, far_field: bool) -> Level:
    return Level(1.0 / ratio, f"{ratio:g} a", Settings(4, domain_ratio=ratio, far_field=far_field))


def _zone(scheme: str, divisions: int) -> Ladder:
    factors = (2.0, 1.0, 0.5, 0.25)
    levels = tuple(Level(f, f"zone x {f:g}", Settings(divisions, zone_factor=f)) for f in factors)
    refined = f"process zone of the model (the answer changes), at {divisions} divisions of each"
    return Ladder(scheme, "zone", refined, levels, nominal=1.0)


def _by_resolution(n: int, settings: Settings) -> Level:
    return Level(1.0 / n, str(n), settings)
