"""``crosscontact fields``: run, compute the fields in the body at the requested moments, write, sum up.

Of an interrupted command nothing is taken over: the same one begins anew.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import OutcomeKind, SceneError, write_scene
from crosscontact.commands.failures import warn
from crosscontact.commands.field_files import write_moments
from crosscontact.commands.interruption import drop_former
from crosscontact.commands.refusals import check_taken
from validation import cases, solvers
from validation.execution.files import output_folder
from validation.execution.folder_lock import locked_folder
from validation.execution.progress import Progress, StepProgress
from validation.execution.run_folder import check_unused
from validation.execution.signals import GracefulStop, interrupting
from validation.fields.figures.figure_set import FigureSet
from validation.fields.request import METHOD, FieldRequest, RecordedFields, check_times, record_fields

if TYPE_CHECKING:
    from fem_solver import FieldState


@dataclass(frozen=True)
class FieldsCommand:
    """What ``crosscontact fields`` is to do.

    Parameters
    ----------
    case : Case
    request : FieldRequest
        Moments.
    figures : FigureSet or None
        What is drawn, at moments of its own beside the requested ones.
    resolution : int or None
        Divisions per process zone; ``None``: the solver's choice.
    max_steps : int or None
        Largest number of steps; ``None``: the solver's own bound.
    fresh : bool
        Whether results of another scene or solver are replaced.
    """

    case: cases.Case
    request: FieldRequest
    figures: FigureSet | None
    resolution: int | None
    max_steps: int | None
    fresh: bool


def run(
    name: str,
    times: list[float],
    pull_off: bool,
    every: int,
    resolution: int | None,
    out: str | None,
    figures: FigureSet | None = None,
    *,
    max_steps: int | None = None,
    fresh: bool = False,
) -> int:
    """Run the finite elements; write files for ParaView, print energies, draw.

    Parameters
    ----------
    name : str
        Scene file or name of a built-in scene.
    times : list of float
        Moments that are stepped onto.
    pull_off : bool
        Whether the largest tension is a moment too.
    every : int
        Each n-th accepted step is a moment too, which is not drawn; 0: none.
    resolution : int or None
        Divisions per process zone; ``None``: the solver's choice.
    out : str or None
        Folder; ``None``: ``out/fields/SCENE``.
    figures, max_steps, fresh
        As of :class:`FieldsCommand`.

    Returns
    -------
    int
        2 if a moment lies outside the run, 1 if the run does not finish, else 0.

    Raises
    ------
    SceneError
        If no moment is requested, a time cannot lie within the loading, the scene is refused, or the folder
        holds the results of another scene or solver.
    NoRendering
        If a requested figure cannot be drawn here.
    """
    case = cases.load(name)
    if not (times or pull_off or every or (figures is not None and figures.chooses_moments)):
        allowed = "--at T [T ...], --pull-off, --every N, --strip, --animate, or several"
        raise SceneError("fields", "no moment asked for", allowed)
    check_times(times, case.scene.loading)  # before anything is made
    check_taken(name, case.scene, (METHOD,), resolution)
    if figures is not None and METHOD.follows_edge(case.scene) and not case.scene.material.is_elastic:
        figures.check_without_history()
    request = FieldRequest(tuple(times), pull_off, every, None if figures is None else figures.rows)
    command = FieldsCommand(case, request, figures, resolution, max_steps, fresh)
    if out is not None:
        return _into(output_folder(out), command)
    with locked_folder(f"out/fields/{case.name}") as folder:
        return _into(folder, command)


def _into(folder: Path, command: FieldsCommand) -> int:
    scene = command.case.scene
    if not command.fresh:
        check_unused(folder, scene, solver=METHOD.name)
    drop_former(folder)
    stop = GracefulStop()
    warn(solvers.scene_warnings(scene))
    states: list[FieldState] = []  # to be drawn
    figures = command.figures
    try:
        with interrupting(), Progress(f"{command.case.name} fields") as progress:
            progress.phase("set-up")
            steps = StepProgress(progress, "computing and writing")
            with stop.handling_signals():
                recorded = record_fields(
                    scene, command.request, command.resolution, steps, command.max_steps, stop.monitor
                )
            if stop.requested:
                raise KeyboardInterrupt
            write_scene(scene, folder / "scene.toml")
            to_draw = None if figures is None else states.append
            lines = write_moments(recorded, folder, scene, progress, to_draw)
            if figures is not None and states:
                progress.phase("drawing")
                lines += figures.draw(
                    folder,
                    states,
                    recorded.recording.trace,
                    scene,
                    progress,
                    recorded.recording.rows.values(),
                )
    except KeyboardInterrupt:
        print("crosscontact: the same command begins anew", file=sys.stderr)
        raise
    for line in lines:
        print(line)
    return _exit_code(recorded)


def _exit_code(recorded: RecordedFields) -> int:
    outcome = recorded.recording.trace.outcome
    if not outcome.finished:
        hint = "; --max-steps N allows more" if outcome.kind is OutcomeKind.STEP_BUDGET else ""
        print(f"crosscontact: not finished: {outcome.kind}: {outcome.reason}{hint}", file=sys.stderr)
        return 1
    if recorded.missing:
        outside = ", ".join(f"{time:.10g}" for time in recorded.missing)
        print(
            f"crosscontact: error: --at {outside}: outside the run, which ended at {outcome.time:.10g} "
            f"({outcome.reason}); allowed: times from 0 to {outcome.time:.10g}",
            file=sys.stderr,
        )
        return 2
    if recorded.never_pulls:
        print("crosscontact: error: --pull-off: the run never pulls", file=sys.stderr)
        return 2
    return 0
