"""``crosscontact fields``: run, compute the fields in the body at the requested moments, write, sum up.

Of an interrupted command nothing is taken over: the same one begins anew.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Scene, SceneError, write_scene
from crosscontact.commands import shared
from crosscontact.commands.shared import say
from validation import cases, solvers
from validation.fields.figures import USUAL, FigureSet
from validation.fields.files import ParaViewSeries
from validation.fields.moments import (
    METHOD,
    EnergySums,
    FieldRequest,
    RecordedFields,
    balance,
    check_times,
    record_fields,
)
from validation.fields.quantities import QUANTITIES
from validation.report.document import counted, plain
from validation.runs.folder import claim, in_words, locked_folder, output_folder, scene_question
from validation.runs.process import GracefulStop, interrupting
from validation.runs.progress import Progress, StepProgress

if TYPE_CHECKING:
    from fem_solver import FieldState

_time = shared.number(lambda value: 0.0 <= value < math.inf, "times >= 0")


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scene, moments and figures."""
    shared.scene_argument(command)
    command.add_argument(
        "--at",
        type=_time,
        nargs="+",
        default=[],
        metavar="T",
        help="times, stepped onto exactly; where the load jumps, the state before",
    )
    command.add_argument("--pull-off", action="store_true", help="the moment of largest tension")
    command.add_argument(
        "--every",
        type=shared.count,
        default=0,
        metavar="N",
        help="every N-th accepted step, the start included; not drawn",
    )
    command.add_argument(
        "--resolution", type=shared.resolution, metavar="N", help="divisions per process zone, as for solve"
    )
    command.add_argument("--out", metavar="DIR", help="default: out/fields/SCENE")
    shared.run_options(command, jobs="", max_steps=True, keeps_runs=False)
    drawn = command.add_argument_group("figures", "sections are drawn at all moments; where asked for, also")
    for name, words in {
        "--strip": "the key moments of the run side by side",
        "--animate": "the whole run as an animated GIF; no files for ParaView",
        "--revolve": "the body in three dimensions",
        "--show": "the last moment in a window, where there is a screen",
        "--alike": "one magnification, view and range of colours for all sections of the run",
    }.items():
        drawn.add_argument(name, action="store_true", help=words)
    drawn.add_argument(
        "--quantity",
        nargs="+",
        choices=tuple(QUANTITIES),
        metavar="Q",
        help="what to draw, of %(choices)s; default: von_mises stress_zz dissipation_rate",
    )
    drawn.add_argument("--no-figures", action="store_true", help="files for ParaView only")


def run(options: argparse.Namespace, jobs: int) -> int:
    """Write files for ParaView, print energies, draw; 2 if a moment lies outside the run, 1 if it does not
    finish."""
    figures, times = _figures(options), options.at
    case = cases.load(options.scene)
    chooses = figures is not None and figures.chooses_moments
    if not (times or options.pull_off or options.every or chooses):
        allowed = "--at T [T ...], --pull-off, --every N, --strip, --animate, or several"
        raise SceneError("fields", "no moment asked for", allowed)
    check_times(times, case.scene.loading)  # before anything is made
    shared.check_taken(options.scene, case.scene, (METHOD,), options.resolution)
    if figures is not None and METHOD.follows_edge(case.scene) and not case.scene.material.is_elastic:
        figures.check_without_history()
    request = FieldRequest(
        tuple(times), options.pull_off, options.every, None if figures is None else figures.rows
    )
    if options.out is not None:
        return _into(output_folder(options.out), case, request, figures, options)
    with locked_folder(f"out/fields/{case.name}") as folder:
        return _into(folder, case, request, figures, options)


def _figures(options: argparse.Namespace) -> FigureSet | None:
    """The figures that are requested; ``None`` for none."""
    flags = (options.strip, options.animate, options.revolve, options.show, options.alike)
    if not options.no_figures:
        return FigureSet(tuple(dict.fromkeys(options.quantity or USUAL)), *flags)
    if options.quantity or any(flags):
        raise SceneError("--no-figures", "figures are asked for beside it", "one or the other")
    return None


def _into(
    folder: Path,
    case: cases.Case,
    request: FieldRequest,
    figures: FigureSet | None,
    options: argparse.Namespace,
) -> int:
    scene, max_steps = case.scene, options.max_steps
    claim(folder, "a run", scene_question(("", scene), solver=METHOD.name), fresh=options.fresh)
    stop = GracefulStop()
    shared.warn(solvers.scene_warnings(scene))
    states: list[FieldState] = []  # to be drawn
    try:
        with interrupting(), Progress(f"{case.name} fields") as progress:
            progress.phase("set-up")
            steps = StepProgress(progress, "computing and writing")
            with stop.handling_signals():
                recorded = record_fields(scene, request, options.resolution, steps, max_steps, stop.monitor)
            if stop.requested:
                raise KeyboardInterrupt
            write_scene(scene, folder / "scene.toml")
            to_draw = None if figures is None else states.append
            lines = _write_moments(recorded, folder, scene, progress, to_draw)
            if figures is not None and states:
                progress.phase("drawing")
                recording = recorded.recording
                lines += figures.draw(
                    folder, states, recording.trace, scene, progress, recording.rows.values()
                )
    except KeyboardInterrupt:
        say("the same command begins anew")
        raise
    for line in lines:
        print(line)
    return _exit_code(recorded)


def _write_moments(
    recorded: RecordedFields,
    folder: Path,
    scene: Scene,
    progress: Progress,
    on_moment: Callable[[FieldState], None] | None,
) -> list[str]:
    """Compute and write all states, each handed on if it is to be drawn; returns lines for a reader."""
    trace = recorded.recording.trace
    before, begin = asdict(trace.counters), time.process_time()
    drawn = set(recorded.moments) - recorded.sampled  # every n-th state would be too many
    written = set(recorded.moments) - recorded.frames
    series = ParaViewSeries(folder, scene) if written else None
    lines = [_HEAD] if written else []
    for count, state in enumerate(recorded.states(), 1):
        if series is not None and state.row in written:
            sums = balance(state, trace)
            series.add(state, sums)
            lines.append(_line(state, sums))
        if on_moment is not None and state.row in drawn:
            on_moment(state)
        progress(count / len(recorded.moments), detail=f"{count} of {len(recorded.moments)} moments")
    cost = {name: count - before[name] for name, count in asdict(trace.counters).items()}
    spent = ", ".join(counted(count, plain(name).removesuffix("s")) for name, count in cost.items() if count)
    lines.append(f"cost of the fields: {spent or 'none'}")
    if series is None:
        return lines
    numbers = {
        "solver": trace.solver,
        "outcome": str(trace.outcome.kind),
        "reason": trace.outcome.reason,
        "run": before,
        "fields": cost,
        "processor_seconds": time.process_time() - begin,
    }
    lists = series.close(numbers)
    return [*lines, *(f"written to {file}" for file in lists), f"for ParaView: {in_words(series.bytes)}"]


_HEAD = (
    f"{'moment':<20}{'time':>12}{'penetration':>13}{'force':>12}{'radius':>11}"
    f"{'stored':>12}{'lost in mesh':>14}{'in trace':>12}{'difference':>12}"
)


def _line(state: FieldState, sums: EnergySums) -> str:
    error = "-" if sums.error is None else f"{100.0 * sums.error:.3f} %"
    lost = "-" if sums.dissipated is None else f"{sums.dissipated:.6g}"
    return (
        f"{state.label or '-':<20}{state.time:12.6g}{state.penetration:13.5g}{state.force:12.5g}"
        f"{state.contact_radius:11.5g}{sums.stored:12.5g}{lost:>14}{sums.branch_dissipation:12.6g}{error:>12}"
    )


def _exit_code(recorded: RecordedFields) -> int:
    outcome = recorded.recording.trace.outcome
    if not outcome.finished:
        say(f"not finished: {outcome.kind}: {outcome.reason}{shared.step_hint(outcome.kind)}")
        return 1
    if recorded.missing:
        outside = ", ".join(f"{time:.10g}" for time in recorded.missing)
        say(
            f"error: --at {outside}: outside the run, which ended at {outcome.time:.10g} "
            f"({outcome.reason}); allowed: times from 0 to {outcome.time:.10g}"
        )
        return 2
    if recorded.never_pulls:
        say("error: --pull-off: the run never pulls")
        return 2
    return 0
