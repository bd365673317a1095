"""What ``crosscontact fields`` does: run, look into the body at the moments asked for, write, sum up."""

from __future__ import annotations

import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from validation import cases
from validation.execution.files import output_folder
from validation.execution.folder_lock import locked_folder
from validation.execution.progress import Progress
from validation.fields.balance import EnergySums, balance
from validation.fields.files import ParaViewSeries
from validation.fields.request import FieldRequest, RecordedFields, check_times, record_fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_scene import Counters, Scene
    from fem_solver import FieldState
    from validation.fields.figures.figure_set import FigureSet


def run(
    name: str,
    times: list[float],
    pull_off: bool,
    every: int,
    resolution: int | None,
    out: str | None,
    figures: FigureSet | None = None,
) -> int:
    """Exit code 0; 1 if the run did not finish or a figure asked for cannot be drawn; 2 for times outside it.

    With an ``figures`` its figures are drawn too, of the moments it needs beside those asked for.
    """
    from contact_scene import SceneError

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
    part = 0.5 if figures is None else 0.25  # of the time, roughly
    kept: list[FieldState] = []
    try:
        found = record_fields(case.scene, request, resolution, lambda done: progress(part * done))
        keep = kept.append if figures is not None else None
        written = write(found, folder, case.scene, lambda done: progress(part * (1.0 + done)), keep)
        if figures is not None and kept:
            trace, asked = found.recording.trace, found.recording.rows.values()
            written += figures.draw(folder, kept, trace, case.scene, lambda d: progress(0.5 + 0.5 * d), asked)
    finally:
        progress.close()
    for line in written:
        print(line)
    return _verdict(found)


def write(
    found: RecordedFields,
    folder: Path,
    scene: Scene,
    progress: Callable[[float], None],
    keep: Callable[[FieldState], None] | None = None,
) -> list[str]:
    """Compute and write all states, and give those of moments to ``keep``; returns lines for a reader."""
    trace = found.recording.trace
    before, begin = asdict(trace.counters), time.process_time()
    series = ParaViewSeries(folder, scene)
    lines = [_HEAD]
    for index, state in enumerate(found.states(), 1):
        sums = balance(state, trace)
        series.add(state, sums)
        lines.append(_line(state, sums))
        if keep is not None and state.row not in found.sampled:  # every n-th are too many to draw
            keep(state)
        progress(index / len(found.moments))
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


def _verdict(found: RecordedFields) -> int:
    outcome = found.recording.trace.outcome
    if not outcome.finished:
        print(f"crosscontact: not finished: {outcome.kind}: {outcome.reason}", file=sys.stderr)
        return 1
    if found.missing:
        outside = ", ".join(f"{time:.10g}" for time in found.missing)
        print(
            f"crosscontact: error: --at {outside}: outside the run, which ended at {outcome.time:.10g} "
            f"({outcome.reason}); allowed: times from 0 to {outcome.time:.10g}",
            file=sys.stderr,
        )
        return 2
    if found.never_pulls:
        print("crosscontact: error: --pull-off: the run never pulls", file=sys.stderr)
        return 2
    return 0
