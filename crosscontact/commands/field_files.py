"""What ``crosscontact fields`` writes: files of each moment, and a table of energies."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import Counters, Scene
from validation.execution.files import in_words
from validation.execution.progress import Progress
from validation.fields.balance import EnergySums, balance
from validation.fields.files import ParaViewSeries
from validation.fields.request import RecordedFields
from validation.report.document import counted, plain

if TYPE_CHECKING:
    from fem_solver import FieldState


def write_moments(
    recorded: RecordedFields,
    folder: Path,
    scene: Scene,
    progress: Progress,
    on_moment: Callable[[FieldState], None] | None,
) -> list[str]:
    """Compute and write all states; returns lines for a reader.

    Parameters
    ----------
    recorded : RecordedFields
    folder : Path
    scene : Scene
    progress : Progress
    on_moment : callable(FieldState) or None
        Called with each state to be drawn, if any is; states recorded only as every n-th are too many.

    Returns
    -------
    list of str
    """
    trace = recorded.recording.trace
    before, begin = asdict(trace.counters), time.process_time()
    drawn = set(recorded.moments) - recorded.sampled
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
    cost = _difference(trace.counters, before)
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
    return (
        f"{state.label or '-':<20}{state.time:12.6g}{state.penetration:13.5g}{state.force:12.5g}"
        f"{state.contact_radius:11.5g}{sums.stored:12.5g}{_number(sums.dissipated):>14}"
        f"{sums.branch_dissipation:12.6g}{error:>12}"
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"


def _difference(counters: Counters, before: dict[str, int]) -> dict[str, int]:
    return {name: count - before[name] for name, count in asdict(counters).items()}
