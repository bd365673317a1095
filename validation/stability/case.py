"""One case of the matrix: a scene, the expected answer, and the tolerance.

Four kinds of expected answer: numbers of a closed form (:class:`ClosedForm`), the front tracking at two
resolutions (:class:`ReferenceRuns`), the same solver on an equivalent scene (:class:`EquivalentScene`), and
that there is no solution, which a solver has to report (:class:`NoSolution`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from contact_scene import OutcomeKind, Scene, SceneError
from validation.solvers import SOLVERS


@dataclass(frozen=True)
class Value:
    """A number of a closed form: an observable's name, its value, what differences are relative to."""

    name: str
    value: float
    scale: float | None = None

    @property
    def unit(self) -> float:
        """The scale, by default the value's own magnitude."""
        return abs(self.value) if self.scale is None else self.scale


@dataclass(frozen=True)
class ClosedForm:
    """Values of a closed form, where they come from, and how the run may end."""

    values: tuple[Value, ...]
    source: str
    endings: tuple[OutcomeKind, ...] = (OutcomeKind.COMPLETED,)


@dataclass(frozen=True)
class ReferenceRuns:
    """Observables taken from the front tracking; a third of its own step halving is its error estimate.

    ``force, RMS`` among the names is the curve ``F(t)``, RMS over maximum. Names in ``of_largest`` are
    relative to the largest magnitude of their column in the run: at that instant the value may vanish.
    """

    names: tuple[str, ...]
    fine: int = 20
    coarse: int = 10
    of_largest: tuple[str, ...] = ()


@dataclass(frozen=True)
class EquivalentScene:
    """The same solver on a scene that differs in units, or in something without any effect.

    Factors turn the columns of ``scene`` into those of the case: penetration and radius by ``length``,
    time by ``time``, force by ``stress * length**2``, energies by ``stress * length**3``.
    """

    scene: Scene
    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0


@dataclass(frozen=True)
class NoSolution:
    """There is no solution; ``why`` in words. A solver must refuse, or end with ``no equilibrium``."""

    why: str


Expectation = ClosedForm | ReferenceRuns | EquivalentScene | NoSolution


@dataclass(frozen=True)
class Tolerance:
    """Largest relative error by solver, the reason for these numbers, and a limit for any other solver.

    A solver not in ``limits`` has ``other``; its own ``coarse_tolerance`` where that is ``None``.
    """

    limits: Mapping[str, float]
    why: str
    other: float | None = None

    def limit(self, solver: str) -> float:
        """Largest relative error of one solver."""
        other = SOLVERS[solver].coarse_tolerance if self.other is None else self.other
        return self.limits.get(solver, other)


USUAL = Tolerance(
    {},
    "coarse runs (6, 4 and 8 divisions a zone): about three times their error in the studies of cycles",
)


@dataclass(frozen=True)
class StabilityCase:
    """A scene on an axis of the matrix.

    Parameters
    ----------
    axis, label : str
        Which axis, where on it.
    scene : Scene or SceneError
        The scene, or the error where it is invalid before any solver sees it.
    expected : ClosedForm, ReferenceRuns, EquivalentScene or NoSolution
    tolerance : Tolerance
    series : str
        Cases of one series differ in stiffness alone; their work is fitted against it. Empty: no series.
    stiffness : float
        Ratio of the longest to the shortest time, or of the moduli.
    resolutions : mapping
        Divisions per process zone by solver, where they are not its ``coarse_resolution``.
    max_steps : int
        Step budget.
    seconds : float
        Processor time after which a run counts as hung and is killed.
    """

    axis: str
    label: str
    scene: Scene | SceneError
    expected: Expectation
    tolerance: Tolerance = USUAL
    series: str = ""
    stiffness: float = 1.0
    resolutions: Mapping[str, int] = field(default_factory=dict)
    max_steps: int = 20_000
    seconds: float = 180.0

    def resolution(self, solver: str) -> int:
        """Divisions per process zone for one solver."""
        adhesive = isinstance(self.scene, Scene) and self.scene.is_adhesive
        return self.resolutions.get(solver) or SOLVERS[solver].coarse_resolution(adhesive)

    @property
    def name(self) -> str:
        """Unique within the matrix."""
        return f"{self.axis}: {self.label}"


def scene_or_refusal(build: Callable[[], Scene]) -> Scene | SceneError:
    """The scene, or the error with which it is refused before any solver sees it."""
    try:
        return build()
    except SceneError as error:
        return error
