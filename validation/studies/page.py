"""A study: observed orders, error against run time, process zones, every ladder; ``study.json``.

Orders are signed; a dash stands where there is none (values to and fro, no difference, a failed level). In
all charts a scheme keeps its colour, line style and marker. A level that failed is a cross at the upper edge,
at its size; it has no run time, so in the other charts it stands in a list at the upper edge. The keys of
``study.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validation.drawing.figure import INK, as_files, drawing, format_axes
from validation.report import document as doc
from validation.report import report
from validation.report.tables import COUNTERS, environment
from validation.report.tables import in_words as fact_in_words
from validation.report.texts import markdown
from validation.runs.folder import to_json
from validation.runs.provenance import of_case
from validation.studies import prices
from validation.studies.ladders import SCHEMES, scheme
from validation.studies.study import Convergence, LevelRun, Row, SceneStudy, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing

FORMAT = 1
TITLE = "crosscontact study"
HEADLINE = ("pull_off_force", "loop_energy", "approach_force", "approach_radius", "detachment_penetration")
METHODS = (
    "The methods: "
    + "; ".join(f"{name}: {one.title}" for name, one in SCHEMES.items())
    + ". Each is refined level by level, a ladder; the front tracking is nearly exact, and the others are "
    "measured against it."
)
NOTES = (
    "Order against the reference: signed, of neighbouring levels, coarse to fine; negative where the error "
    "grows. Order of values alone: from three neighbouring levels; none where values go to and fro. Index: "
    "grid convergence index of the finest level, safety factor 1.25 where the observed order is within a "
    "tenth of the nominal one, else 3 with the lower of both orders (at least 1/2). Asymptotic: a coarser "
    "difference over its prediction by the finest three levels, 0.7 to 1.4 expected."
)
REFERENCE_NOTE = (
    "The front tracking's own levels are measured against a finer run of itself, which makes their orders "
    "against the reference too high towards the fine end; use the orders of its values alone."
)
KIND_NOTES = {
    "zone": "The process zone is a length of the model, no numerical parameter: the answer moves with it, "
    "and the limit of no zone is another problem. The ladder shows how much depends on its value.",
    "domain": "On the far boundary the displacement of the total force is prescribed, so the error left by "
    "the domain lies below that of the mesh and the steps; differences that go to and fro say that it has "
    "been reached. Boundary elements and front tracking know the exact half-space and have no domain.",
}
WORK_LABELS = {
    "": "level size h/h₀ (finer to the right)",
    "wall_seconds": "run time (s)",
    "cpu_seconds": "processor time (s)",
    "steps": "accepted steps",
    "linear_solves": "triangular solves",
}
Chart = tuple[str, str, str, str]
"""Name, caption, error, and kind of work it is drawn over; none: level size."""
ORDER_CHARTS: tuple[Chart, ...] = (
    ("order-pull-off", "Pull-off force: error over level size", "pull_off_force", ""),
    ("order-loop", "Loop integral: error over level size", "loop_energy", ""),
    ("order-force", "F(t), RMS: error over level size", "force, RMS", ""),
    ("order-radius", "a(t), RMS: error over level size", "radius, RMS", ""),
)
PRICE_CHARTS: tuple[Chart, ...] = (
    ("price-force", "F(t), RMS, against run time", "force, RMS", "wall_seconds"),
    ("price-processor", "F(t), RMS, against processor time", "force, RMS", "cpu_seconds"),
    ("price-pull-off", "Pull-off force against run time", "pull_off_force", "wall_seconds"),
    ("price-loop", "Loop integral against run time", "loop_energy", "wall_seconds"),
    ("price-steps", "F(t), RMS, against steps", "force, RMS", "steps"),
    ("price-solves", "F(t), RMS, against triangular solves", "force, RMS", "linear_solves"),
)


def write(study: Study, folder: Path) -> None:
    """Write ``index.html``, ``study.md``, ``study.json`` and ``figures/SCENE-NAME.png`` and ``.svg``."""
    page = document(study)
    report.write(folder, page, {"study.json": to_json(data(study)), "study.md": markdown(page)})


def data(study: Study) -> dict[str, Any]:
    """``study.json``."""
    return {
        "format": FORMAT,
        "wall_seconds": study.wall_seconds,
        "environment": study.environment,
        "scenes": [_data_of(scene) for scene in study.scenes],
    }


def _data_of(scene: SceneStudy) -> dict[str, Any]:
    cheapest = [
        {"measure": measure, "asked": error, "cheapest": best.scheme if best else None}
        | {"seconds": {entry.scheme: entry.seconds for entry in found}}
        for measure in prices.measures(scene.timed)
        for error in prices.ERRORS
        for best, found in [prices.cheapest(scene.timed, measure, error)]
    ]
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "premises": of_case(scene.case),
        "reference": scene.reference,
        "reference_uncertainty": scene.uncertainty,
        "failed_levels": len(scene.failed),
        "ladders": [
            {
                "scheme": entry.ladder.scheme,
                "kind": entry.ladder.kind,
                "refined": entry.ladder.refined,
                "nominal_order": entry.nominal,
                "levels": [asdict(run) for run in entry.runs],
                "observables": [asdict(row) for row in entry.rows],
            }
            for entry in scene.ladders
        ],
        "cheapest": cheapest,
        "growth": [asdict(prices.growth(entry, work)) for entry in scene.timed for work in prices.WORK],
    }


def document(study: Study, figures: bool = True) -> doc.Document:
    """The whole study; ``figures`` leaves them out where nobody looks at them."""
    parts = [_scene(scene, study, figures) for scene in study.scenes]
    parts.append(environment(study.environment, study.wall_seconds))
    return doc.Document(
        TITLE, (doc.Paragraph(verdict(study)), doc.Paragraph(METHODS)), tuple(parts), contents_depth=2
    )


def short(study: Study) -> doc.Section:
    """What a terminal shows: the orders of each scene, and the prices in words."""
    scenes = []
    for scene in study.scenes:
        words = map(doc.Paragraph, prices.in_words(scene.timed))
        title = f"{scene.case.name}: {scene.reference}"
        scenes.append(doc.Section(title, (_headline_table(scene), *words)))
    return doc.Section(TITLE, (*scenes, doc.Paragraph(verdict(study))))


def verdict(study: Study) -> str:
    """How many levels there are, and how many failed."""
    levels = sum(len(entry.runs) for scene in study.scenes for entry in scene.ladders)
    failed = sum(len(scene.failed) for scene in study.scenes)
    size = f"{doc.counted(len(study.scenes), 'scene')}, {doc.counted(levels, 'level')}"
    return f"{size}, {failed} failed, {study.wall_seconds:.0f} s."


def _scene(scene: SceneStudy, study: Study, figures: bool) -> doc.Section:
    threads = fact_in_words(study.environment.get("threads", "unknown"))
    orders, costs = (_charts(scene, charts) if figures else () for charts in (ORDER_CHARTS, PRICE_CHARTS))
    title = "Observed orders, everything refined together"
    parts = [_section(title, _stated(scene), _headline_table(scene), first=orders)]
    tables = _price_table(scene.timed), _growth_table(scene.timed)
    parts.append(
        _section("Error against run time", _stated_prices(scene.timed, threads), *tables, first=costs)
    )
    zones = [study for study in scene.ladders if study.ladder.kind == "zone"]
    if zones:
        rows = (
            {"observable": doc.plain(row.observable), "solver": study.ladder.scheme}
            | _by_level(zones[0], (doc.number(value, 6) for value in row.values))
            | {"Richardson, no zone": doc.number(row.alone.richardson if row.alone else None, 6)}
            for study, row in _headlines(zones)
        )
        title = "Shorter and longer process zones"
        parts.append(_section(title, [KIND_NOTES["zone"]], doc.DataTable.of(rows)))
    folded = (doc.Fold(one.title, one.parts) for one in map(_ladder, scene.ladders))
    return doc.Section(scene.case.scene.title or scene.case.name, (*parts, *folded))


def _section(
    title: str, words: Sequence[str], *tables: doc.DataTable, first: Sequence[doc.Figures] = ()
) -> doc.Section:
    return doc.Section(title, (*first, *map(doc.Paragraph, words), *tables))


def _stated(scene: SceneStudy) -> list[str]:
    """What errors are measured against, who is left out, and what failed."""
    stated = [f"Errors are measured against {scene.reference}."]
    if scene.reference.startswith("no reference"):
        stated = [f"N{scene.reference[1:]}. Values are judged by themselves only."]
    if scene.uncertainty:
        shares = ", ".join(
            f"{doc.plain(name)} {scene.uncertainty[name]:.0e}"
            for name in HEADLINE
            if name in scene.uncertainty
        )
        stated.append(f"The reference's own relative error, from its ladder and second order: {shares}.")
    refused = {
        study.ladder.scheme: run.failure for study in scene.ladders for run in study.runs if run.refused
    }
    stated += [f"{scheme} is left out, {reason}." for scheme, reason in refused.items()]
    other, failed = "other " if refused else "", len(scene.failed)
    stated.append(f"{failed} levels failed." if failed else f"Every {other}level has an answer.")
    return [*stated, NOTES, REFERENCE_NOTE]


def _headlines(studies: Sequence[Convergence]) -> Iterator[tuple[Convergence, Row]]:
    """The observables that matter most, each by every study."""
    for name in HEADLINE:
        yield from ((study, row) for study in studies for row in study.rows if row.observable == name)


def _headline_table(scene: SceneStudy) -> doc.DataTable:
    """The orders and errors that matter most, every scheme beside the others."""
    return doc.DataTable.of(_headline(study, row) for study, row in _headlines(scene.timed))


def _headline(study: Convergence, row: Row) -> doc.Record:
    alone, error = row.alone, row.errors[-1]
    bound = alone.bound if alone else None
    covers = doc.ABSENT if bound is None or error is None else "yes" if abs(error) <= bound else "NO"
    return {
        "observable": doc.plain(row.observable),
        "scheme": study.ladder.scheme,
        "levels": " ".join(run.level.label for run in study.runs),
        "order against the reference": _orders(row.orders),
        "fitted": doc.formatted(row.fitted, ".2f"),
        "order of values alone": _orders(alone.orders) if alone else doc.ABSENT,
        "error of the finest": doc.formatted(error, "+.1e"),
        "index of the finest": doc.formatted(bound, ".1e"),
        "covers it": covers,
        "values alone say": alone.verdict if alone else doc.ABSENT,
    }


def _orders(values: Sequence[float | None]) -> str:
    return " ".join(doc.formatted(value, ".2f") for value in values) or doc.ABSENT


def _by_level(study: Convergence, values: Iterable[str]) -> dict[str, str]:
    return dict(zip((run.level.label for run in study.runs), values, strict=True))


def _ladder(study: Convergence) -> doc.Section:
    """One ladder in full: what each level did, and every observable."""
    method, note = scheme(study.ladder.scheme), KIND_NOTES.get(study.ladder.kind)
    stated = [f"Refined: {study.ladder.refined}. Nominal order {study.nominal:g}."]
    stated += [method.why] if study.ladder.nominal is None else []
    stated += [note] if note else []
    values = (
        {"observable": doc.plain(row.observable)}
        | _by_level(study, (doc.number(value, 8) for value in row.values))
        | {
            "orders": _orders(alone.orders),
            "Richardson": doc.number(alone.richardson, 8),
            "index": doc.formatted(alone.bound, ".1e"),
            "safety": doc.number(alone.safety),
            "asymptotic": doc.formatted(alone.asymptotic, ".2f"),
            "verdict": alone.verdict,
        }
        for row in study.rows
        if (alone := row.alone) is not None
    )
    errors = (
        {"observable": doc.plain(row.observable)}
        | _by_level(study, (doc.formatted(e, ".1e" if row.alone is None else "+.1e") for e in row.errors))
        | {"orders": _orders(row.orders), "fitted": doc.formatted(row.fitted, ".2f")}
        for row in study.rows
        if any(error is not None for error in row.errors)
    )
    tables = (
        doc.DataTable.of(map(_level, study.runs), "Levels"),
        doc.DataTable.of(values, "Values alone"),
        doc.DataTable.of(errors, "Errors against the reference"),
    )
    return _section(f"{method.title}: {study.ladder.kind}", stated, *(one for one in tables if one.rows))


def _level(run: LevelRun) -> doc.Record:
    """What a level cost, and how it ended."""
    failed = run.failed and not run.refused
    ending = doc.VerdictCell(f"FAILED: {run.failure}", False) if failed else run.failure or run.outcome
    return (
        {
            "level": run.level.label,
            "ending": ending,
            "seconds": doc.number(run.wall_seconds, 3),
            "processor": doc.number(run.cpu_seconds, 3),
            "repeats": str(run.repeats) if run.repeats else doc.ABSENT,
        }
        | {title: doc.number(run.counters.get(name)) for title, name in COUNTERS.items()}
        | {"force, RMS": doc.formatted(run.errors.get("force, RMS"), ".1e")}
    )


def _stated_prices(studies: list[Convergence], threads: str) -> list[str]:
    """Error against run time in words."""
    stated = [
        "Each run alone, after a warm-up run of its scheme: the smallest of the repeats stated below (fewer "
        f"where a run takes longer than a second), threads {threads}. Meshing and assembly count, imports "
        "do not. Prices below are processor seconds, on one thread the run time of a quiet machine; between "
        "levels they are interpolated on logarithms, never extrapolated.",
        "By the RMS error of F(t) over the run, relative to the largest force: "
        + " ".join(prices.in_words(studies)),
    ]
    share, skipped = prices.busy(studies), prices.left_out(studies)
    if share > prices.BUSY:
        stated.insert(1, f"The machine was busy: run times are up to {share:.1f} times the processor times.")
    if skipped:
        stated.append("Left out because the scene did not need it: " + " ".join(skipped))
    return stated


def _price_table(studies: list[Convergence]) -> doc.DataTable:
    rows = []
    for measure in prices.measures(studies):
        for asked in prices.ERRORS:
            best, found = prices.cheapest(studies, measure, asked)
            shown = {
                one.scheme: doc.ABSENT
                if one.seconds is None
                else f"{'≤ ' if one.at_most else ''}{one.seconds:.2g} s"
                for one in found
            }
            first = {"error in": doc.plain(measure), "asked": f"{asked:.0e}"}
            rows.append(first | shown | {"cheapest": best.scheme if best else doc.ABSENT})
    return doc.DataTable.of(rows, "Processor seconds to an error")


def _growth_table(studies: list[Convergence]) -> doc.DataTable:
    rows = []
    for study in studies:
        fitted = {doc.plain(work): prices.growth(study, work) for work in prices.WORK}
        by_resolution = {work: doc.formatted(one.with_resolution, ".2f") for work, one in fitted.items()}
        by_error = {work: doc.formatted(one.with_error, ".2f") for work, one in fitted.items()}
        rows.append({"scheme": study.ladder.scheme} | by_resolution)
        rows.append({"scheme": f"{study.ladder.scheme}, over 1/error"} | by_error)
    return doc.DataTable.of(rows, "Exponents of cost over resolution, and over 1/error of F(t)")


def _charts(scene: SceneStudy, charts: Sequence[Chart]) -> tuple[doc.Figures]:
    """Charts in which something is known, with their copies as PNG and SVG."""
    figures = []
    for name, caption, error, work in charts:
        drawing = draw(scene.timed, error, work)
        if drawing is not None:
            file = f"{scene.case.name}-{name}"
            figure = doc.Figure(f"study-{doc.valid_id(file)}", caption, files=as_files(drawing, file))
            figures.append(doc.with_drawing(figure, drawing, f"{caption}, {scene.case.name}"))
    return (doc.Figures(tuple(figures)),)


def draw(studies: Sequence[Convergence], error: str, work: str = "") -> Drawing | None:
    """An error over level size, relative to the coarsest of a scheme, or over a kind of work.

    ``None`` if nothing in it is known and nothing failed.
    """
    from matplotlib.ticker import NullFormatter

    figure, axes = drawing()
    axes.set(xscale="log", yscale="log")
    axes.set(xlabel=WORK_LABELS[work], ylabel=f"relative error, {doc.plain(error)}")
    drawn: list[tuple[float, float]] = []
    for row, study in enumerate(studies):
        name, coarsest = study.ladder.scheme, study.runs[0].level.size
        style = scheme(name).curve_style | {"linewidth": 1.4}
        across = [prices.cost(run, work) if work else run.level.size / coarsest for run in study.runs]
        found = zip(across, (abs(run.errors.get(error, 0.0)) for run in study.runs), strict=True)
        points = [(x, y) for x, y in found if x and y]
        if points:
            axes.plot(*zip(*points, strict=True), label=name, markersize=4.5, **style)
            drawn += points
        failed = [run for run in study.runs if run.failed and not run.refused]
        if failed:
            places = [0.04 + 0.04 * i if work else run.level.size / coarsest for i, run in enumerate(failed)]
            style = {"color": style["color"], "markersize": 7, "label": f"{name}: {len(failed)} failed"}
            where = axes.transAxes if work else axes.get_xaxis_transform()
            axes.plot(places, [0.97 - 0.05 * row] * len(failed), "x", transform=where, **style)
    if not axes.lines:
        return None
    if not work:
        _slopes(axes, drawn)
        axes.invert_xaxis()
        low = min((x for x, _ in drawn), default=1.0)
        parts = [n for n in (1, 2, 4, 8, 16) if low * n < 1.05]
        axes.set_xticks([1.0 / n for n in parts], [f"1/{n}" if n > 1 else "1" for n in parts])
    format_axes(axes)
    for axis in (axes.xaxis, axes.yaxis):  # few decades: labels between them would run into each other
        axis.set_minor_formatter(NullFormatter())
    figure.legend(  # above the axes, where it hides no point
        loc="outside upper center",
        ncols=min(4, len(axes.get_legend_handles_labels()[0])),
        frameon=False,
        labelcolor=INK,
        fontsize="x-small",
        handlelength=2.4,
        columnspacing=1.0,
    )
    return figure


def _slopes(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    """Lines of order 1 and 2 to compare with."""
    low, top = min((x for x, _ in points), default=1.0), max((y for _, y in points), default=0.0)
    for order, dash in ((1, (0, (6, 3))), (2, (0, (6, 2, 1, 2)))) if low < 1.0 else ():
        ends = [top, top * low**order]
        axes.plot((1.0, low), ends, color=INK, linewidth=0.7, linestyle=dash, label=f"order {order}")
