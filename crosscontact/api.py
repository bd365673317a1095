"""Solving and comparing from Python."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from contact_scene.value_checks import function_or_none, true_or_false
from crosscontact import arguments
from crosscontact.arguments import COUNT, RESOLUTION, case_of, given, times
from crosscontact.result import Result, html_table
from validation import cases
from validation import scenes as builtin_scenes
from validation.compare.checks import check_case
from validation.drawing import run_figures
from validation.measure.difference import Check
from validation.report.tables import of_checks
from validation.report.texts import aligned
from validation.runs import run as runs

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def builtin(name: str) -> Scene:
    """A built-in scene; :func:`scenes` lists them.

    Examples
    --------
    >>> cc.builtin("cycle-v0.02").indenter
    Sphere(radius=1.0)
    """
    if not isinstance(name, str) or name not in builtin_scenes.names():
        raise SceneError("name", f"no built-in scene {shown(name)}", "a name listed by crosscontact.scenes()")
    return cases.load(name).scene


def scenes() -> dict[str, str]:
    """Titles of the built-in scenes by name.

    Examples
    --------
    >>> cc.scenes()["cycle-v0.02"]
    'Approach and retraction at V = 0.02 (Fig. 2)'
    """
    return builtin_scenes.titles()


def solvers() -> tuple[str, ...]:
    """Names of the solvers.

    Examples
    --------
    >>> cc.solvers()[:3]
    ('bem', 'fem', 'reference')
    """
    return arguments.names()


def solve(
    scene: Scene | str | os.PathLike[str],
    solver: str = arguments.REFERENCE,
    resolution: int | None = None,
    *,
    estimate_errors: bool = False,
    stop_times: Collection[float] = (),
    profile_times: Collection[float] | None = None,
    max_steps: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a built-in one, or a scene file.
    solver : str
        One of :func:`solvers`.
    resolution : int, optional
        Divisions per process zone (without adhesion: per hundredth of the largest contact radius,
        of finite elements per twentieth), at least 4; by default the solver's choice.
    estimate_errors : bool
        Whether to estimate the errors; takes a second run, about half as long again.
    stop_times : collection of float
        Times that are stepped onto exactly, in units of the scene. The ends of oscillation cycles always are.
    profile_times : collection of float, optional
        Times that are stepped onto and whose surface profile the trace holds; by default those of the
        built-in scene, if it is given by name.
    max_steps : int, optional
        Bounds accepted and rejected steps together; by default a bound that no sound run comes near.
    progress : callable, optional
        Called with the share of the run that is done, 0 to 1.

    Returns
    -------
    Result
        Also of a run that did not reach its end: ``result.outcome`` says why.

    Raises
    ------
    SceneError
        If an argument is wrong or the solver does not take the scene (``UnsupportedScene``); one line.

    Examples
    --------
    >>> result = cc.solve("cycle-v0.02", estimate_errors=True)
    >>> f"{result.pull_off.force:.5e}", result.errors["pull_off_force"] < 1e-5
    ('1.01854e-02', True)
    """
    case = case_of(scene)
    arguments.check_solver(solver, "solver", arguments.selectable())
    function_or_none(progress, "progress", "the share that is done")
    if profile_times is not None:
        case = replace(case, profile_times=times(profile_times, "profile_times"))
    run = runs.run_or_raise(
        case,
        solver,
        given(RESOLUTION, resolution, "resolution"),
        progress,
        true_or_false(estimate_errors, "estimate_errors"),
        stop_times=times(stop_times, "stop_times"),
        max_steps=given(COUNT, max_steps, "max_steps"),
    )
    return Result(case.scene, run)


def compare(
    scene: Scene | str | os.PathLike[str],
    solvers: Collection[str] | None = None,
    resolution: int | None = None,
    estimate_errors: bool = True,
    *,
    max_steps: int | None = None,
) -> SolverComparison:
    """Solve a scene by several solvers and compare each with the reference.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a built-in one (then with its check values and tolerances), or a scene file.
    solvers : collection of str, optional
        Names, the reference among them; by default all.
    resolution, max_steps : int, optional
        As for :func:`solve`.
    estimate_errors : bool
        Whether agreement is judged by error estimates, as ``crosscontact compare`` does, or by the
        tolerances of the scene alone.

    Returns
    -------
    SolverComparison

    Examples
    --------
    >>> comparison = cc.compare("elastic-relaxed", solvers=("reference", "bem"))
    >>> comparison.agree
    True
    """
    case = case_of(scene)
    resolution = given(RESOLUTION, resolution, "resolution")
    max_steps = given(COUNT, max_steps, "max_steps")
    true_or_false(estimate_errors, "estimate_errors")
    names = arguments.usable() if solvers is None else arguments.chosen(solvers, "solvers")
    by_solver = {
        name: runs.run(case, name, resolution, estimate=estimate_errors, max_steps=max_steps)
        for name in names
    }
    results = {name: Result(case.scene, run) for name, run in by_solver.items() if run.trace is not None}
    failures = {name: run.failure for name, run in by_solver.items() if run.trace is None}
    return SolverComparison(case.scene, results, failures, tuple(check_case(case, by_solver)))


@dataclass(frozen=True)
class SolverComparison:
    """Several solvers on one scene.

    Parameters
    ----------
    scene : Scene
    results : mapping of str to Result
        By solver.
    failures : mapping of str to str
        Why a solver gave no answer, by solver.
    checks : tuple of Check
        Differences from the reference and from known values, each with its verdict.

    Examples
    --------
    >>> comparison = cc.compare("elastic-relaxed", solvers=("reference", "bem"))
    >>> f"{comparison['bem'].pull_off.force:.3e}"
    '2.432e-03'
    """

    scene: Scene
    results: Mapping[str, Result]
    failures: Mapping[str, str]
    checks: tuple[Check, ...]

    @property
    def agree(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    def __getitem__(self, solver: str) -> Result:
        return self.results[solver]

    def plot(self, axes: Sequence[Axes] | None = None) -> tuple[Axes, ...]:
        """All results laid over each other, as :meth:`Result.plot`."""
        with_stage = any(run_figures.has_stage(result.trace) for result in self.results.values())
        count = len(run_figures.side_by_side(with_stage))
        if axes is None:
            axes = run_figures.new_figure(count).axes
        panels = run_figures.checked_axes(axes, count)
        for result in sorted(self.results.values(), key=lambda result: result.solver != arguments.REFERENCE):
            result.plot(panels)
        return panels

    def __repr__(self) -> str:
        verdict = "all agree" if self.agree else "they disagree"
        lines = aligned(of_checks(self.checks).texts)
        return "\n".join([f"{self.scene.title or 'a scene'}: {verdict}", *lines])

    def _repr_html_(self) -> str:
        return html_table(of_checks(self.checks).texts)
