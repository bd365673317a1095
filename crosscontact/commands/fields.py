"""``crosscontact fields``: run, compute the fields in the body at the requested moments, write, sum up.

Of an interrupted command nothing is taken over: the same one begins anew.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Scene, SceneError, write_scene
from contact_scene.value_checks import Range
from crosscontact.arguments import COUNT, option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import flag, say, value
from validation import cases, solvers
from validation.fields import moments
from validation.fields.figures import USUAL, FigureSet
from validation.fields.files import ParaViewSeries
from validation.fields.quantities import QUANTITIES
from validation.report.document import counted, plain
from validation.report.texts import aligned
from validation.runs.folder import claim, in_words, locked_folder, output_folder, scene_question
from validation.runs.process import GracefulStop, interrupting
from validation.runs.progress import Progress, StepProgress

if TYPE_CHECKING:
    from fem_solver import FieldState

FIGURES = {
    "--strip": flag("draw the key moments of the run side by side too"),
    "--animate": flag("draw the whole run as an animated GIF too; no files for ParaView"),
    "--revolve": flag("draw the body in three dimensions too"),
    "--show": flag("the last moment in a window too, where there is a screen"),
    "--alike": flag("one magnification, view and range of colours for all sections of the run"),
}
"""What is drawn beside sections at all moments, and how."""
OPTIONS = {
    **shared.SCENE,
    "--at": value(
        "T",
        "times, stepped onto exactly; where the load jumps, the state before",
        type=option_type(Range("times >= 0", 0.0)),
        nargs="+",
        default=[],
    ),
    "--pull-off": flag("the moment of largest tension"),
    "--every": value(
        "N",
        "every N-th accepted step, the start included; not drawn",
        type=option_type(COUNT),
        default=0,
    ),
    **shared.resolution("divisions per process zone, as for solve"),
    "--out": value("DIR", "default: out/fields/SCENE"),
    **shared.MAX_STEPS,
    **shared.REPLACE,
    **FIGURES,
    "--quantity": value(
        "Q",
        "what to draw, of %(choices)s; default: von_mises stress_zz dissipation_rate",
        nargs="+",
        choices=tuple(QUANTITIES),
    ),
    "--no-figures": flag("files for ParaView only"),
}
HEAD = (
    *("moment", "time", "penetration", "force", "radius"),
    *("stored", "lost in mesh", "in trace", "difference"),
)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Write files for ParaView, print energies, draw; 2 if a moment lies outside the run, 1 if it does not
    finish."""
    figures, times = _figures(options), options.at
    case = cases.load(options.scene)
    chooses = figures is not None and figures.chooses_moments
    if not (times or options.pull_off or options.every or chooses):
        allowed = "--at T [T ...], --pull-off, --every N, --strip, --animate, or several"
        raise SceneError("fields", "no moment asked for", allowed)
    moments.check_times(times, case.scene.loading)  # before anything is made
    shared.check_taken(options.scene, case.scene, (moments.METHOD,), options.resolution)
    request = moments.FieldRequest(
        tuple(times), options.pull_off, options.every, None if figures is None else figures.rows
    )
    if options.out is not None:
        return _into(output_folder(options.out), case, request, figures, options)
    with locked_folder(f"out/fields/{case.name}") as folder:
        return _into(folder, case, request, figures, options)


def _figures(options: argparse.Namespace) -> FigureSet | None:
    """The figures that are requested; ``None`` for none."""
    flags = [getattr(options, name.strip("-")) for name in FIGURES]
    if not options.no_figures:
        return FigureSet(tuple(dict.fromkeys(options.quantity or USUAL)), *flags)
    if options.quantity or any(flags):
        raise SceneError("--no-figures", "figures are asked for beside it", "one or the other")
    return None


def _into(
    folder: Path,
    case: cases.Case,
    request: moments.FieldRequest,
    figures: FigureSet | None,
    options: argparse.Namespace,
) -> int:
    scene, stop = case.scene, GracefulStop()
    claim(folder, "a run", scene_question(("", scene), solver=moments.METHOD.name), fresh=options.fresh)
    shared.warn(solvers.scene_warnings(scene))
    try:
        with interrupting(), Progress(f"{case.name} fields", "set-up") as progress:
            how = options.resolution, StepProgress(progress, "computing and writing"), options.max_steps
            with stop.handling_signals():
                recorded = moments.record_fields(scene, request, *how, stop.monitor)
            if stop.requested:
                raise KeyboardInterrupt
            write_scene(scene, folder / "scene.toml")
            lines, states = _write_moments(recorded, folder, scene, progress, keep=figures is not None)
            if figures is not None and states:
                progress.phase("drawing")
                recording = recorded.recording
                lines += figures.draw(
                    folder, states, recording.trace, scene, progress, recording.rows.values()
                )
    except SceneError as error:
        raise error.in_file(options.scene) from None
    except KeyboardInterrupt:
        say("the same command begins anew")
        raise
    print("\n".join(lines))
    return _exit_code(recorded)


def _write_moments(
    recorded: moments.RecordedFields, folder: Path, scene: Scene, progress: Progress, keep: bool
) -> tuple[list[str], list[FieldState]]:
    """Compute and write all states; lines for a reader, and the states to be drawn, if they are kept."""
    trace = recorded.recording.trace
    drawn: list[FieldState] = []
    rows: list[tuple[str, ...]] = [HEAD]
    before, begin = asdict(trace.counters), time.process_time()
    written = set(recorded.moments) - recorded.frames
    series = ParaViewSeries(folder, scene) if written else None
    for count, state in enumerate(recorded.states(), 1):
        if series is not None and state.row in written:
            sums = moments.balance(state, trace)
            series.add(state, sums)
            error = "-" if sums.error is None else f"{100.0 * sums.error:.3f} %"
            numbers = state.time, state.penetration, state.force, state.contact_radius, sums.stored
            shown = [format(number, ".6g") for number in (*numbers, sums.dissipated, sums.branch_dissipation)]
            rows.append((state.label or "-", *shown, error))
        if keep and state.row not in recorded.sampled:  # every n-th state would be too many
            drawn.append(state)
        progress(count / len(recorded.moments), detail=f"{count} of {len(recorded.moments)} moments")
    cost = {name: count - before[name] for name, count in asdict(trace.counters).items()}
    spent = ", ".join(counted(count, plain(name).removesuffix("s")) for name, count in cost.items() if count)
    spent_on = f"cost of the fields: {spent or 'none'}"
    if series is None:
        return [spent_on], drawn
    lists = series.close(
        {
            "solver": trace.solver,
            "outcome": str(trace.outcome.kind),
            "reason": trace.outcome.reason,
            "run": before,
            "fields": cost,
            "processor_seconds": time.process_time() - begin,
        }
    )
    size, kinds = f"for ParaView: {in_words(series.bytes)}", ["text", *["number"] * (len(HEAD) - 1)]
    return [*aligned(rows, kinds), spent_on, *(f"written to {file}" for file in lists), size], drawn


def _exit_code(recorded: moments.RecordedFields) -> int:
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
