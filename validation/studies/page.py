"""A study: observed orders, error against run time, process zones, every ladder; ``study.json``.

Orders are signed; a dash stands where there is none (values to and fro, no difference, a failed level). The
keys of ``study.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from validation.drawing import export
from validation.report import markdown, report
from validation.report.document import (
    ABSENT,
    DataTable,
    Document,
    Figure,
    Figures,
    Fold,
    Paragraph,
    Record,
    Section,
    VerdictCell,
    counted,
    formatted,
    number,
    plain,
    valid_id,
    with_drawing,
)
from validation.report.tables import COUNTERS, environment, in_words
from validation.runs.folder import to_json
from validation.runs.provenance import of_case
from validation.studies import charts, schemes, work_precision
from validation.studies.convergence import Convergence, LevelRun, Row
from validation.studies.schemes import scheme
from validation.studies.study import SceneStudy, Study

FORMAT = 1
TITLE = "crosscontact study"
HEADLINE = ("pull_off_force", "loop_energy", "approach_force", "approach_radius", "detachment_penetration")
SCHEMES = (
    "The methods: "
    + "; ".join(f"{name}: {one.title}" for name, one in schemes.SCHEMES.items())
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
ZONE_NOTE = (
    "The process zone is a length of the model, no numerical parameter: the answer moves with it, and the "
    "limit of no zone is another problem. The ladder shows how much depends on its value."
)
DOMAIN_NOTE = (
    "On the far boundary the displacement of the total force is prescribed, so the error left by the domain "
    "lies below that of the mesh and the steps; differences that go to and fro say that it has been reached. "
    "Boundary elements and front tracking know the exact half-space and have no domain."
)


def write(study: Study, folder: Path) -> None:
    """Write ``index.html``, ``study.md``, ``study.json`` and ``figures/SCENE-NAME.png`` and ``.svg``."""
    page = document(study)
    report.write(folder, page, {"study.json": to_json(data(study)), "study.md": markdown.text(page)})


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
        | {"seconds": {entry.scheme: entry.seconds for entry in prices}}
        for measure in work_precision.measures(scene.timed)
        for error in work_precision.ERRORS
        for best, prices in [work_precision.cheapest(scene.timed, measure, error)]
    ]
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "premises": of_case(scene.case),
        "reference": scene.reference,
        "reference_uncertainty": scene.uncertainty,
        "failed_levels": len(scene.failed),
        "ladders": [_ladder(entry) for entry in scene.ladders],
        "cheapest": cheapest,
        "growth": [
            asdict(work_precision.growth(entry, work))
            for entry in scene.timed
            for work in work_precision.WORK
        ],
    }


def _ladder(entry: Convergence) -> dict[str, Any]:
    return {
        "scheme": entry.ladder.scheme,
        "kind": entry.ladder.kind,
        "refined": entry.ladder.refined,
        "nominal_order": entry.nominal,
        "levels": [asdict(run) for run in entry.runs],
        "observables": [asdict(row) for row in entry.rows],
    }


def document(study: Study, figures: bool = True) -> Document:
    """The whole study; ``figures`` leaves them out where nobody looks at them."""
    parts = (*(_scene(scene, study, figures) for scene in study.scenes),
             environment(study.environment, study.wall_seconds))  # fmt: skip
    return Document(TITLE, (Paragraph(verdict(study)), Paragraph(SCHEMES)), parts, contents_depth=2)


def short(study: Study) -> Section:
    """What a terminal shows: the orders of each scene, and the prices in words."""
    scenes = []
    for scene in study.scenes:
        orders = [part for part in overview(scene).parts if isinstance(part, DataTable)]
        words = [Paragraph(line) for line in work_precision.in_words(scene.timed)]
        scenes.append(Section(f"{scene.case.name}: {scene.reference}", (*orders, *words)))
    return Section(TITLE, (*scenes, Paragraph(verdict(study))))


def verdict(study: Study) -> str:
    """How many levels there are, and how many failed."""
    levels = sum(len(entry.runs) for scene in study.scenes for entry in scene.ladders)
    failed = sum(len(scene.failed) for scene in study.scenes)
    size = f"{counted(len(study.scenes), 'scene')}, {counted(levels, 'level')}"
    return f"{size}, {failed} failed, {study.wall_seconds:.0f} s."


def _scene(scene: SceneStudy, study: Study, figures: bool) -> Section:
    threads = in_words(study.environment.get("threads", "unknown"))
    first = (
        (overview(scene), charts.CONVERGENCE),
        (_prices(scene.timed, threads), charts.PRICES),
    )
    shown = (
        replace(one, parts=(*((_charts(scene, drawn),) if figures else ()), *one.parts))
        for one, drawn in first
    )
    beside = zones(scene)
    folded = (Fold(one.title, one.parts) for one in map(ladder, scene.ladders))
    parts = (*shown, *(() if beside is None else (beside,)), *folded)
    return Section(scene.case.scene.title or scene.case.name, parts)


def _charts(scene: SceneStudy, shown: Sequence[charts.Chart]) -> Figures:
    """Charts in which something is known, with their copies as PNG and SVG."""
    figures = []
    for chart in shown:
        drawing = charts.draw(chart, scene.timed)
        if drawing is not None:
            file = f"{scene.case.name}-{chart.name}"
            files = {f"{file}.png": export.png(drawing), f"{file}.svg": export.svg_file(drawing)}
            figure = Figure(f"study-{valid_id(file)}", chart.caption, files=files)
            figures.append(with_drawing(figure, drawing, f"{chart.caption}, {scene.case.name}"))
    return Figures(tuple(figures))


def overview(scene: SceneStudy) -> Section:
    """The orders and errors that matter most, every scheme beside the others."""
    failed = scene.failed
    stated = [
        f"Errors are measured against {scene.reference}."
        if not scene.reference.startswith("no reference")
        else f"{scene.reference[0].upper()}{scene.reference[1:]}. Values are judged by themselves only.",
    ]
    if scene.uncertainty:
        shares = ", ".join(
            f"{plain(name)} {scene.uncertainty[name]:.0e}" for name in HEADLINE if name in scene.uncertainty
        )
        stated.append(f"The reference's own relative error, from its ladder and second order: {shares}.")
    refused = {
        study.ladder.scheme: run.failure for study in scene.ladders for run in study.runs if run.refused
    }
    stated += [f"{scheme} is left out, {reason}." for scheme, reason in refused.items()]
    other = "other " if refused else ""
    stated.append(f"{len(failed)} levels failed." if failed else f"Every {other}level has an answer.")
    rows = (_headline(study, row) for study, row in _headlines(scene.timed))
    title = "Observed orders, everything refined together"
    return _section(title, [*stated, NOTES, REFERENCE_NOTE], DataTable.of(rows))


def _headlines(studies: Sequence[Convergence]) -> Iterator[tuple[Convergence, Row]]:
    """The observables that matter most, each by every study."""
    for name in HEADLINE:
        yield from ((study, row) for study in studies for row in study.rows if row.observable == name)


def zones(scene: SceneStudy) -> Section | None:
    """Results with shorter and longer process zones, every solver's; ``None`` without a zone."""
    studies = [study for study in scene.ladders if study.ladder.kind == "zone"]
    if not studies:
        return None
    rows = (
        {"observable": plain(row.observable), "solver": study.ladder.scheme}
        | _by_level(studies[0], (number(value, 6) for value in row.values))
        | {"Richardson, no zone": number(row.alone.richardson if row.alone else None, 6)}
        for study, row in _headlines(studies)
    )
    return _section("Shorter and longer process zones", [ZONE_NOTE], DataTable.of(rows))


def _by_level(study: Convergence, values: Iterable[str]) -> dict[str, str]:
    return dict(zip((run.level.label for run in study.runs), values, strict=True))


def _headline(study: Convergence, row: Row) -> dict[str, str]:
    alone = row.alone
    return {
        "observable": plain(row.observable),
        "scheme": study.ladder.scheme,
        "levels": " ".join(run.level.label for run in study.runs),
        "order against the reference": _orders(row.orders),
        "fitted": formatted(row.fitted, ".2f"),
        "order of values alone": _orders(alone.orders) if alone else ABSENT,
        "error of the finest": formatted(row.errors[-1], "+.1e"),
        "index of the finest": formatted(alone.bound if alone else None, ".1e"),
        "covers it": _covered(row),
        "values alone say": alone.verdict if alone else ABSENT,
    }


def _covered(row: Row) -> str:
    """Whether the error against the reference lies within the bound that the values alone give."""
    bound, error = row.alone.bound if row.alone else None, row.errors[-1]
    if bound is None or error is None:
        return ABSENT
    return "yes" if abs(error) <= bound else "NO"


def ladder(study: Convergence) -> Section:
    """One ladder in full: what each level did, and every observable."""
    stated = [f"Refined: {study.ladder.refined}. Nominal order {study.nominal:g}."]
    stated += [scheme(study.ladder.scheme).why] if study.ladder.nominal is None else []
    note = {"zone": ZONE_NOTE, "domain": DOMAIN_NOTE}.get(study.ladder.kind)
    stated += [note] if note else []
    values = (
        {"observable": plain(row.observable)}
        | _by_level(study, (number(value, 8) for value in row.values))
        | {
            "orders": _orders(alone.orders),
            "Richardson": number(alone.richardson, 8),
            "index": formatted(alone.bound, ".1e"),
            "safety": number(alone.safety),
            "asymptotic": formatted(alone.asymptotic, ".2f"),
            "verdict": alone.verdict,
        }
        for row in study.rows
        if (alone := row.alone) is not None
    )
    errors = (
        {"observable": plain(row.observable)}
        | _by_level(study, (formatted(e, ".1e" if row.alone is None else "+.1e") for e in row.errors))
        | {"orders": _orders(row.orders), "fitted": formatted(row.fitted, ".2f")}
        for row in study.rows
        if any(error is not None for error in row.errors)
    )
    tables = (
        DataTable.of(map(_level, study.runs), "Levels"),
        DataTable.of(values, "Values alone"),
        DataTable.of(errors, "Errors against the reference"),
    )
    title = f"{scheme(study.ladder.scheme).title}: {study.ladder.kind}"
    return _section(title, stated, *(table for table in tables if table.rows))


def _ended(run: LevelRun) -> VerdictCell | str:
    if run.refused:
        return run.failure
    return VerdictCell(f"FAILED: {run.failure}", False) if run.failed else run.outcome


def _level(run: LevelRun) -> Record:
    """What a level cost, and how it ended."""
    return (
        {
            "level": run.level.label,
            "ending": _ended(run),
            "seconds": number(run.wall_seconds, 3),
            "processor": number(run.cpu_seconds, 3),
            "repeats": str(run.repeats) if run.repeats else ABSENT,
        }
        | {title: number(run.counters.get(name)) for title, name in COUNTERS.items()}
        | {"force, RMS": formatted(run.errors.get("force, RMS"), ".1e")}
    )


def _section(title: str, paragraphs: Sequence[str], *tables: DataTable) -> Section:
    return Section(title, (*map(Paragraph, paragraphs), *tables))


def _orders(values: Sequence[float | None]) -> str:
    return " ".join(formatted(value, ".2f") for value in values) or ABSENT


def _prices(studies: list[Convergence], threads: str) -> Section:
    """Error against run time, in words and as tables."""
    stated = [
        "Each run alone, after a warm-up run of its scheme: the smallest of the repeats stated below (fewer "
        f"where a run takes longer than a second), threads {threads}. Meshing and assembly count, imports "
        "do not. Prices below are processor seconds, on one thread the run time of a quiet machine; between "
        "levels they are interpolated on logarithms, never extrapolated.",
        "By the RMS error of F(t) over the run, relative to the largest force: "
        + " ".join(work_precision.in_words(studies)),
        "By the pull-off force: " + " ".join(work_precision.in_words(studies, "pull_off_force")),
        "By the loop integral: " + " ".join(work_precision.in_words(studies, "loop_energy")),
        "Growth of cost (least squares over the ladder, the error that of F(t), RMS): "
        + " ".join(work_precision.growth_in_words(studies)),
    ]
    share = work_precision.busy(studies)
    if share > work_precision.BUSY:
        stated.insert(1, f"The machine was busy: run times are up to {share:.1f} times the processor times.")
    skipped = work_precision.left_out(studies)
    if skipped:
        stated.append("Left out because the scene did not need it: " + " ".join(skipped))
    tables = _price_table(studies), _growth_table(studies)
    return Section("Error against run time", (*map(Paragraph, stated), *tables))


def _price_table(studies: list[Convergence]) -> DataTable:
    rows = []
    for measure in work_precision.measures(studies):
        for asked in work_precision.ERRORS:
            best, found = work_precision.cheapest(studies, measure, asked)
            bounds = ("≤ " if price.at_most else "" for price in found)
            seconds = (formatted(price.seconds, ".2g") for price in found)
            shown = (s if s == ABSENT else f"{b}{s} s" for b, s in zip(bounds, seconds, strict=True))
            rows.append(
                {"error in": plain(measure), "asked": f"{asked:.0e}"}
                | dict(zip((study.ladder.scheme for study in studies), shown, strict=True))
                | {"cheapest": best.scheme if best else ABSENT}
            )
    return DataTable.of(rows, "Processor seconds to an error")


def _growth_table(studies: list[Convergence]) -> DataTable:
    rows = []
    for study in studies:
        fitted = {plain(work): work_precision.growth(study, work) for work in work_precision.WORK}
        by_resolution = {work: formatted(one.with_resolution, ".2f") for work, one in fitted.items()}
        by_error = {work: formatted(one.with_error, ".2f") for work, one in fitted.items()}
        rows.append({"scheme": study.ladder.scheme} | by_resolution)
        rows.append({"scheme": f"{study.ladder.scheme}, over 1/error"} | by_error)
    return DataTable.of(rows, "Exponents of cost over resolution, and over 1/error of F(t)")
