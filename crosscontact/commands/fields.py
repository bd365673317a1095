"""``crosscontact fields``: run, compute the fields in the body at the requested moments, write, sum up."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Counters, Scene, SceneError
from validation import cases
from validation.execution.files import output_folder
from validation.execution.folder_lock import locked_folder
from validation.execution.progress import Progress
from validation.fields.balance import EnergySums, balance
from validation.fields.figures.figure_set import FigureSet
from validation.fields.files import ParaViewSeries
from validation.fields.request import FieldRequest, RecordedFields, check_times, record_fields

if TYPE_CHECKING:
    from fem_solver import FieldState


def run(
    name: str,
    times: list[float],
    pull_off: bool,
    every: int,
    resolution: int | None,
    out: str | None,
    figures: FigureSet | None = None,
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
    figures : FigureSet or None
        What is drawn, at moments of its own beside the requested ones.

    Returns
    -------
    int
        2 if a moment lies outside the run, 1 if the run does not finish, else 0.

    Raises
    ------
    SceneError
        If no moment is requested, or a time cannot lie within the loading.
    NoRendering
        If a requested figure cannot be drawn here.
    """
    case = cases.load(name)
    if not (times or pull_off or every or (figures is not None and figures.chooses_moments)):
        allowed = "--at T [T ...], --pull-off, --every N, --strip, --animate, or several"
        raise SceneError("fields", "no moment asked for", allowed)
    check_times(times, case.scene.loading)  # before anything is made
    request = FieldRequest(tuple(times), pull_off, every, None if figures is None else figures.rows)
    if out is not None:
        return _into(output_folder(out), case, request, resolution, figures)
    with locked_folder(f"out/fields/{case.name}") as folder:
        return _into(folder, case, request, resolution, figures)


def _into(
    folder: Path, case: cases.Case, request: FieldRequest, resolution: int | None, figures: FigureSet | None
) -> int:
    progress = Progress(f"{case.name} fields")
    share = 0.5 if figures is None else 0.25  # of run and of fields in the whole time, roughly
    states: list[FieldState] = []  # to be drawn
    try:
        recorded = record_fields(case.scene, request, resolution, lambda done: progress(share * done))
        on_moment = None if figures is None else states.append
        lines = _write(recorded, folder, case.scene, lambda done: progress(share * (1.0 + done)), on_moment)
        if figures is not None and states:
            trace, requested = recorded.recording.trace, recorded.recording.rows.values()
            lines += figures.draw(
                folder, states, trace, case.scene, lambda done: progress(0.5 + 0.5 * done), requested
            )
    finally:
        progress.close()
    for line in lines:
        print(line)
    return _exit_code(recorded)


def _write(
    recorded: RecordedFields,
    folder: Path,
    scene: Scene,
    progress: Callable[[float], None],
    on_moment: Callable[[FieldState], None] | None,
) -> list[str]:
    """Compute and write all states; returns lines for a reader.

    ``on_moment`` is called with the state of each moment; states recorded only as every n-th are too many to
    be drawn.
    """
    trace = recorded.recording.trace
    before, begin = asdict(trace.counters), time.process_time()
    series = ParaViewSeries(folder, scene)
    lines = [_HEAD]
    for index, state in enumerate(recorded.states(), 1):
        sums = balance(state, trace)
        series.add(state, sums)
        lines.append(_line(state, sums))
        if on_moment is not None and state.row not in recorded.sampled:
            on_moment(state)
        progress(index / len(recorded.moments))
    cost = _difference(trace.counters, before)
    files = series.close(
        {
            "outcome": str(trace.outcome.kind),
            "reason": trace.outcome.reason,
            "run": before,
            "fields": cost,
            "processor_seconds": time.process_time() - begin,
        }
    )
    spent = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in cost.items() if count)
    return [*lines, f"cost of the fields: {spent or 'none'}", *(f"written to {file}" for file in files)]


_HEAD = (
    f"{'moment':<20}{'time':>12}{'penetration':>13}{'force':>12}{'radius':>11}"
    f"{'stored':>12}{'lost in mesh':>14}{'in trace':>12}{'difference':>12}"
)


def _line(state: FieldState, sums: EnergySums) -> str:
    error = "-" if sums.error is None else f"{100.0 * sums.error:.3f} %"
    return (
        f"{state.label or '-':<20}{state.time:12.6g}{state.penetration:13.5g}{state.force:12.5g}"
        f"{state.contact_radius:11.5g}{sums.stored:12.5g}{sums.dissipated:14.6g}"
        f"{sums.branch_dissipation:12.6g}{error:>12}"
    )


def _difference(counters: Counters, before: dict[str, int]) -> dict[str, int]:
    return {name: count - before[name] for name, count in asdict(counters).items()}


def _exit_code(recorded: RecordedFields) -> int:
    outcome = recorded.recording.trace.outcome
    if not outcome.finished:
        print(f"crosscontact: not finished: {outcome.kind}: {outcome.reason}", file=sys.stderr)
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
