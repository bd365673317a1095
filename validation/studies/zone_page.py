"""Cost and error over the process zone, as tables, chart and ``zones-SCENE.json``.

The keys of that file are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validation.cases import Case
from validation.drawing import export
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import curve_style
from validation.report import markdown
from validation.report.document import (
    ABSENT,
    DataTable,
    Document,
    Paragraph,
    Record,
    Section,
    formatted,
    plain,
)
from validation.runs.folder import to_json, write_whole
from validation.runs.provenance import of_case
from validation.studies.zones import OBSERVED, ZoneRun, growth

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NOTES = """\
Errors: relative, against the reference at twice its default resolution with the same zone. Updates: of the
history, in a step on average, as each solver counts them (the reference: points of the surface). Megabytes:
the most that the process of a run held, program and libraries included. Growth: exponent p of a fit by
zone^-p over all zones of a solver; 0 where a shorter zone costs no more than its logarithm."""


def write(case: Case, runs: Sequence[ZoneRun], folder: Path) -> Path:
    """Write ``zones-NAME.md``, ``.json``, ``.png`` and ``.svg``; returns the first."""
    shown, path = section(case.name, runs), folder / f"zones-{case.name}.json"
    write_whole(path, to_json(data(case, runs)))
    page = path.with_suffix(".md")
    write_whole(page, markdown.text(Document(shown.title, (), shown.parts)))
    figure = draw(runs)
    write_whole(path.with_suffix(".png"), export.png(figure))
    write_whole(path.with_suffix(".svg"), export.svg_file(figure))
    return page


def data(case: Case, runs: Sequence[ZoneRun]) -> dict[str, Any]:
    """``zones-SCENE.json``."""
    return {
        "scene": case.name,
        "premises": of_case(case),
        "runs": [
            {
                "zone_over_radius": one.ratio,
                "zone": one.zone,
                "solver": one.solver,
                "outcome": None if one.run is None else one.run.ending,
                "skipped": one.skipped or None,
                "steps": one.steps,
                "history_updates_per_step": one.updates,
                "cpu_seconds": one.seconds,
                "peak_memory_bytes": one.peak_memory,
                "errors": one.errors,
                "error_estimates": {} if one.run is None else one.run.errors,
            }
            for one in runs
        ],
    }


def section(name: str, runs: Sequence[ZoneRun]) -> Section:
    """A row for every zone and solver, then the growth for every solver."""
    rows = DataTable.of(_row(one) for one in runs)
    fits = DataTable.of(_growth_rows(runs))
    return Section(f"{name}: cost over the process zone", (rows, fits, Paragraph(NOTES)))


def _row(one: ZoneRun) -> Record:
    ending = one.skipped
    if one.run is not None and not one.run.finished:
        ending = one.run.ending
    return {
        "zone / radius": f"{one.ratio:.0e}",
        "solver": one.solver,
        "steps": formatted(one.steps, "d"),
        "updates": formatted(one.updates, ".0f"),
        "seconds": formatted(one.seconds, ".2f"),
        "megabytes": formatted(one.megabytes, ".0f"),
        **{f"{plain(name)}: error": formatted(one.errors.get(name), "+.1e") for name in OBSERVED},
        "not finished": ending or ABSENT,
    }


def _growth_rows(runs: Sequence[ZoneRun]) -> Iterator[Record]:
    for solver in dict.fromkeys(one.solver for one in runs):
        own = [one for one in runs if one.solver == solver]
        yield {
            "solver": solver,
            **{
                f"growth of {name}": formatted(growth(own, name), ".2f")
                for name in ("steps", "updates", "seconds")
            },
        }


def _error_of(name: str) -> Callable[[ZoneRun], float | None]:
    return lambda one: abs(one.errors[name]) if name in one.errors else None


PANELS: dict[str, Callable[[ZoneRun], float | None]] = {
    "accepted steps": lambda one: one.steps,
    "updates of the history in a step": lambda one: one.updates,
    "processor time (s)": lambda one: one.seconds,
    "memory of the process (MB)": lambda one: one.megabytes,
    **{f"error of {plain(name)} (relative)": _error_of(name) for name in OBSERVED},
}
COLUMNS = 3


def draw(runs: Sequence[ZoneRun]) -> Figure:
    """Logarithmic axes, one for each quantity; a solver's curve ends at the last zone it was run with."""
    from matplotlib.figure import Figure

    rows = len(PANELS) // COLUMNS
    figure = Figure(figsize=(COLUMNS * SIZE[0], rows * SIZE[1]), layout="constrained")
    for axes, (label, value_of) in zip(figure.subplots(rows, COLUMNS).flat, PANELS.items(), strict=True):
        axes.set_xscale("log")
        axes.set_yscale("log")
        for solver in dict.fromkeys(one.solver for one in runs):
            own = [(one.ratio, value_of(one)) for one in runs if one.solver == solver]
            known = [(ratio, value) for ratio, value in own if value]
            if known:
                across, up = zip(*known, strict=True)
                axes.plot(across, up, label=solver, markersize=4.5, **curve_style(solver))
        axes.invert_xaxis()
        axes.set_xlabel("process zone over contact radius")
        axes.set_ylabel(label)
        format_axes(axes)
    if figure.axes[0].lines:  # no solver may have answered
        figure.axes[0].legend(fontsize=8)
    return figure
