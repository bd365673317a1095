"""A solver: what may be asked of its runs, how accurate it is, how its curves are drawn."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, ClassVar

from contact_scene import COLUMNS, RunMonitor, Scene, Trace, UnsupportedScene
from contact_scene.checked import Checked, Finite, Positive
from contact_scene.errors import shown
from contact_scene.run_control import MAX_STEPS
from contact_scene.value_checks import true_or_false, whole_from
from validation.solvers.model_range import cycle_count, interval_count, out_of_range

REFERENCE = "reference"
"""Name of the solver that the others are compared with."""
SKIPPED_WORK: Mapping[str, str] = {
    "closure_evaluations": "no closure was evaluated",
    "history_updates": "no history was carried",
}
"""Work counter of any solver: what its remaining at zero means."""
AT_EXTREMA: Mapping[str, float] = dict.fromkeys(
    ("pull_off_penetration", "pull_off_radius", "pull_off_time", "detachment_radius", "detachment_force"),
    0.02,
)
"""Tolerances of places of a maximum and of states at a limit point: the root of what moves the force."""
QUICK_DIVISIONS = 8
"""Most divisions per process zone in the quick suite."""
Progress = Callable[[float], None]
"""Called with the share of the loading that is done, 0 to 1."""


@dataclass(frozen=True)
class RunOptions(Checked):
    """What may be requested of any solver beside the resolution.

    Parameters
    ----------
    step_tolerance : float, optional
        Tolerance of the time steps, relative; what it bounds, and its default, are the solver's own.
    stop_times : tuple of float
        Times that are stepped onto exactly.
    profile_times : tuple of float
        Times that are stepped onto exactly and give a surface profile each.
    max_steps : int, optional
        Largest number of steps, accepted and rejected together; by default
        :func:`~validation.solvers.base.step_budget`.
    progress : callable, optional
        Called with the share of the loading that is done, 0 to 1.
    monitor : RunMonitor, optional
        Stops the run between two steps, or has it continued.
    estimate_errors : bool
        Put error estimates into ``Trace.errors``, if the solver makes its own.

    Examples
    --------
    >>> cc.RunOptions(max_steps=500).max_steps
    500
    """

    step_tolerance: Positive | None = None
    stop_times: tuple[Finite, ...] = ()
    profile_times: tuple[Finite, ...] = ()
    max_steps: Annotated[int | None, whole_from(1)] = None
    progress: Progress | None = None
    monitor: RunMonitor | None = None
    estimate_errors: Annotated[bool, true_or_false] = False

    @property
    def of_solver(self) -> dict[str, Any]:
        """Keywords that the options of every solver have in common."""
        return {
            "tolerance": self.step_tolerance,
            "stop_times": self.stop_times,
            "profile_times": self.profile_times,
            "max_steps": self.max_steps or MAX_STEPS,
        }


@contextmanager
def exit_is_an_error() -> Iterator[None]:
    """A solver that would end this program, ends its run."""
    try:
        yield
    except SystemExit as error:
        raise RuntimeError(f"the solver called sys.exit({shown(error.code)})") from error


@dataclass(frozen=True)
class ComparisonRun:
    """A second run of a solver: ``solve`` takes the keywords of ``Solver.solve``; ``ratio`` is that of its
    steps and elements to those of the first run, not 1."""

    solve: Callable[..., Trace]
    ratio: float


class Solver(ABC):
    """One method of solution.

    Attributes
    ----------
    name : str
        Short name: on the command line, in ``Trace.solver``, in reports.
    title : str
        The method in words, for tables and legends.
    description : str
        How it works, in a sentence or two, for readers of a report.
    order : float
        Observed order of convergence of whole runs, which studies measure theirs against.
    tolerance, curve_tolerance : float
        Largest relative difference from the reference in a check value, and in a curve (root mean square over
        maximum), where a scene states none.
    quantity_tolerances : mapping of str to float
        Least tolerance of check values that are less accurate than the others, by name.
    coarse_tolerance : float
        Largest relative error at :meth:`coarse_resolution`.
    movement_tolerance : float
        Largest difference of a curve from the reference, relative to its excursion in any load step or cycle
        (root mean square of what is left of the difference without its mean).
    least_resolution : int
        Fewest divisions per process zone that are accepted.
    estimates_errors : bool
        Whether ``solve`` can estimate the errors of a run itself (``Trace.errors``).
    skipped_work : mapping of str to str
        Work counter: what its remaining at zero means.
    curve_style : mapping
        Line properties for matplotlib: colour, line style, line width.
    marker : str
        Marker of single points, in matplotlib's code.
    css_variable : str
        CSS variable that takes the place of the colour on a page.
    columns : tuple of str
        Columns of the trace that the method computes; the others it fills with zeros.

    Examples
    --------
    >>> from validation.solvers import solver
    >>> isinstance(solver("bem"), cc.Solver)
    True
    """

    name: ClassVar[str]
    title: ClassVar[str]
    description: ClassVar[str] = ""
    order: ClassVar[float] = 1.0
    tolerance: ClassVar[float] = 5e-3
    curve_tolerance: ClassVar[float] = 5e-3
    quantity_tolerances: ClassVar[Mapping[str, float]] = {}
    coarse_tolerance: ClassVar[float] = 2e-2
    movement_tolerance: ClassVar[float] = 2e-2
    least_resolution: ClassVar[int] = 4
    estimates_errors: ClassVar[bool] = False
    skipped_work: ClassVar[Mapping[str, str]] = SKIPPED_WORK
    curve_style: ClassVar[Mapping[str, Any]] = {
        "color": "#cc79a7",
        "linestyle": (0, (3, 1, 1, 1)),
        "linewidth": 1.4,
    }
    marker: ClassVar[str] = "x"
    css_variable: ClassVar[str] = "other"
    columns: ClassVar[tuple[str, ...]] = COLUMNS

    @property
    def version(self) -> str:
        """Version of a code that is no part of this program; else empty."""
        return ""

    def transition(self, resolution: int | None) -> float | None:
        """Maugis' transition parameter of a method whose attraction has a finite range; infinite: no zone."""
        return None

    @exit_is_an_error()
    def solve(self, scene: Scene, resolution: int | None = None, **options: Any) -> Trace:
        """Solve a scene.

        Parameters
        ----------
        scene : Scene
        resolution : int, optional
            Divisions per process zone (without adhesion: per hundredth of the largest contact radius, of
            finite elements per twentieth).
        **options
            As of :class:`RunOptions`.

        Returns
        -------
        Trace

        Raises
        ------
        SceneError
            If no solver can compute the scene, or this one does not take it or an option.
        RuntimeError
            If the solver calls ``sys.exit``.
        """
        self.check(scene, resolution)
        asked = RunOptions(**options)
        if asked.max_steps is None:
            asked = replace(asked, max_steps=step_budget(scene))
        return self._solve(scene, resolution, asked)

    def check(self, scene: Scene, resolution: int | None = None) -> None:
        """Refuse a scene as :meth:`solve` does, as far as that is told without solving it."""
        unsupported = out_of_range(scene) or self.refusal(scene)
        if unsupported is not None:
            raise unsupported

    def refusal(self, scene: Scene) -> UnsupportedScene | None:
        """Why the method does not take this scene, told without solving it; ``None`` if it does."""
        return None

    @abstractmethod
    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        """Solve a scene; parameters as of :meth:`solve`."""

    def load(self) -> None:  # noqa: B027 - a solver without imports of its own has nothing to do
        """Import what :meth:`solve` needs, so that the run time does not contain it."""

    def default_resolution(self, scene: Scene) -> int:
        """Divisions per process zone where none are specified."""
        return 8

    def quick_resolution(self, scene: Scene) -> int:
        """Divisions in the quick suite: its checks ask for no more, and the default takes longer."""
        return min(QUICK_DIVISIONS, self.default_resolution(scene))

    def coarse_resolution(self, adhesive: bool) -> int:
        """The fewest divisions per process zone that still meet :attr:`coarse_tolerance`."""
        return 4

    def comparison_run(self, scene: Scene, resolution: int | None = None) -> ComparisonRun:
        """The run from whose difference errors are estimated: at half the resolution, or at twice."""
        divisions, other = self._other_resolution(scene, resolution)
        return ComparisonRun(partial(self.solve, scene, other), divisions / other)

    def _other_resolution(self, scene: Scene, resolution: int | None) -> tuple[int, int]:
        """Resolution of a run, and that of the run it is compared with."""
        divisions = resolution or self.default_resolution(scene)
        half = divisions // 2
        return divisions, half if half >= self.least_resolution else 2 * divisions


def step_budget(scene: Scene) -> int:
    """Most steps of a run, accepted and rejected together, where the user states no number.

    A thousand for each cycle and each interval between kinks of the load: some six times what they take.
    """
    return max(MAX_STEPS, math.ceil(1e3 * (cycle_count(scene) + interval_count(scene))))
