"""What a study says, in words and tables: the same for the page and for Markdown.

Orders are signed; a dash stands where there is none (values to and fro, no difference, a failed level).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from validation.report.text import NONE, number
from validation.studies import work_precision
from validation.studies.convergence import Convergence, LevelRun, Row
from validation.studies.schemes import scheme
from validation.studies.study import SceneStudy

HEADLINE = ("pull_off_force", "loop_energy", "approach_force", "approach_radius", "detachment_penetration")
NOTES = (
    "Order against the reference: signed, of neighbouring levels, coarse to fine; negative where the error "
    "grows. Order of values alone: from three neighbouring levels; none where values go to and fro. Index: "
    "grid convergence index of the finest level, safety factor 1.25 where the observed order is within a "
    "tenth of the nominal one, else 3 with the lower of both orders (at least 1/2). Asymptotic: a coarser "
    "difference over its prediction by the finest three levels, 0.7 to 1.4 asked."
)
TRUTH_NOTE = (
    "The front tracking's own levels are measured against a finer run of itself, which makes their orders "
    "against the reference too high towards the fine end; judge it by its values alone."
)
ZONE_NOTE = (
    "The process zone is a length of the model, no numerical parameter: the answer moves with it, and the "
    "limit of no zone is another problem. The ladder tells how much hangs on its value."
)
DOMAIN_NOTE = (
    "On the far boundary the displacement of the total force is prescribed, so the error left by the domain "
    "lies below that of the mesh and the steps; differences that go to and fro say that it has been reached. "
    "Boundary elements and front tracking know the exact half-space and have no domain."
)


@dataclass(frozen=True)
class Table:
    """Ready-made cells under a caption."""

    caption: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]


@dataclass(frozen=True)
class Section:
    """A heading, paragraphs, then tables."""

    title: str
    paragraphs: list[str]
    tables: list[Table]


def overview(scene: SceneStudy) -> Section:
    """The orders and errors that matter most, every scheme beside the others."""
    failed = scene.failed
    said = [
        f"Errors are measured against {scene.reference}."
        if not scene.reference.startswith("no reference")
        else f"{scene.reference[0].upper()}{scene.reference[1:]}. Values are judged by themselves only.",
    ]
    if scene.uncertainty:
        shares = ", ".join(
            f"{_name(name)} {scene.uncertainty[name]:.0e}" for name in HEADLINE if name in scene.uncertainty
        )
        said.append(f"The reference's own relative error, from its ladder and second order: {shares}.")
    said.append(f"{len(failed)} levels failed." if failed else "Every level has an answer.")
    rows = [
        _headline(study, row)
        for name in HEADLINE
        for study in scene.timed
        for row in study.rows
        if row.observable == name
    ]
    head = (
        "observable", "scheme", "levels", "order against the reference", "fitted", "order of values alone",
        "error of the finest", "index of the finest", "covers it", "values alone say",
    )  # fmt: skip
    return Section(
        "Observed orders, everything refined together", [*said, NOTES, TRUTH_NOTE], [Table("", head, rows)]
    )


def zones(scene: SceneStudy) -> Section | None:
    """What every solver says of shorter and longer process zones, side by side; ``None`` without a zone."""
    found = [study for study in scene.ladders if study.ladder.kind == "zone"]
    if not found:
        return None
    labels = [run.level.label for run in found[0].runs]
    rows = [
        (_name(name), study.ladder.scheme, *(number(value, 6) for value in row.values),
         number(row.alone.richardson if row.alone else None, 6))
        for name in HEADLINE for study in found for row in study.rows if row.observable == name
    ]  # fmt: skip
    head = ("observable", "solver", *labels, "Richardson, no zone")
    return Section("Shorter and longer process zones", [ZONE_NOTE], [Table("", head, rows)])


def _headline(study: Convergence, row: Row) -> tuple[str, ...]:
    alone = row.alone
    return (
        _name(row.observable),
        study.ladder.scheme,
        " ".join(run.level.label for run in study.runs),
        _orders(row.orders),
        _order(row.fitted),
        _orders(alone.orders) if alone else NONE,
        _error(row.errors[-1]),
        _error(alone.bound if alone else None, ""),
        _covered(row),
        alone.verdict if alone else NONE,
    )


def _covered(row: Row) -> str:
    """Whether the error against the reference lies within the bound that the values alone give."""
    bound, error = row.alone.bound if row.alone else None, row.errors[-1]
    if bound is None or error is None:
        return NONE
    return "yes" if abs(error) <= bound else "NO"


def ladder(study: Convergence) -> Section:
    """One ladder in full: what each level did, and every observable."""
    labels = [run.level.label for run in study.runs]
    said = [f"Refined: {study.ladder.refined}. Nominal order {study.nominal:g}."]
    said += [scheme(study.ladder.scheme).why] if study.ladder.nominal is None else []
    note = {"zone": ZONE_NOTE, "domain": DOMAIN_NOTE}.get(study.ladder.kind)
    said += [note] if note else []
    head = ("observable", *labels, "orders", "Richardson", "index", "safety", "asymptotic", "verdict")
    values = [
        (
            _name(row.observable),
            *(number(value, 8) for value in row.values),
            _orders(row.alone.orders),
            number(row.alone.richardson, 8),
            _error(row.alone.bound, ""),
            number(row.alone.safety),
            _order(row.alone.asymptotic),
            row.alone.verdict,
        )
        for row in study.rows
        if row.alone is not None
    ]
    errors = [
        (
            _name(row.observable),
            *(_error(error, "" if row.alone is None else "+") for error in row.errors),
            _orders(row.orders),
            _order(row.fitted),
        )
        for row in study.rows
        if any(error is not None for error in row.errors)
    ]
    tables = [levels(study), Table("Values alone", head, values)]
    if errors:
        tables.append(
            Table("Errors against the reference", ("observable", *labels, "orders", "fitted"), errors)
        )
    return Section(f"{scheme(study.ladder.scheme).title}: {study.ladder.kind}", said, tables)


def levels(study: Convergence) -> Table:
    """What each level cost, and how it ended."""
    head = ("level", "ending", "seconds", "processor", "repeats", "steps", "rejected", "solves", "closure",
            "factorisations", "force, RMS")  # fmt: skip
    return Table("Levels", head, [_level(run) for run in study.runs])


def _level(run: LevelRun) -> tuple[str, ...]:
    names = ("steps", "rejected_steps", "linear_solves", "closure_evaluations", "factorisations")
    return (
        run.level.label,
        f"FAILED: {run.failure}" if run.failed else run.outcome,
        number(run.wall_seconds, 3),
        number(run.cpu_seconds, 3),
        str(run.repeats) if run.repeats else NONE,
        *(number(run.counters.get(name)) for name in names),
        _error(run.errors.get("force, RMS"), ""),
    )


def prices(scene: SceneStudy, threads: str) -> Section:
    """Error against run time, in words and as tables."""
    studies = scene.timed
    said = [
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
        said.insert(1, f"The machine was busy: run times are up to {share:.1f} times the processor times.")
    spared = work_precision.left_out(studies)
    if spared:
        said.append("Left out because the scene did not need it: " + " ".join(spared))
    return Section("Error against run time", said, [_price_table(studies), _growth_table(studies)])


def _price_table(studies: Sequence[Convergence]) -> Table:
    head = ("error in", "asked", *(study.ladder.scheme for study in studies), "cheapest")
    rows = []
    for measure in work_precision.measures(list(studies)):
        for asked in work_precision.ASKED:
            best, found = work_precision.cheapest(list(studies), measure, asked)
            cells = [
                NONE if p.seconds is None else f"{'≤ ' if p.at_most else ''}{p.seconds:.2g} s" for p in found
            ]
            rows.append((_name(measure), f"{asked:.0e}", *cells, best.scheme if best else NONE))
    return Table("Processor seconds to an error", head, rows)


def _growth_table(studies: Sequence[Convergence]) -> Table:
    head = ("scheme", *(_name(work) for work in work_precision.WORK))
    rows = []
    for study in studies:
        fitted = [work_precision.growth(study, work) for work in work_precision.WORK]
        rows.append((study.ladder.scheme, *(_order(entry.with_resolution) for entry in fitted)))
        rows.append((f"{study.ladder.scheme}, over 1/error", *(_order(entry.with_error) for entry in fitted)))
    return Table("Exponents of cost over resolution, and over 1/error of F(t)", head, rows)


def threads(environment: dict[str, object]) -> str:
    """The pinned numbers of threads in words."""
    found = environment.get("threads")
    return ", ".join(f"{k} {v}" for k, v in found.items()) if isinstance(found, dict) else "unknown"


def _name(observable: str) -> str:
    return observable.replace("_", " ")


def _order(value: float | None) -> str:
    return NONE if value is None else f"{value:.2f}"


def _orders(values: Sequence[float | None]) -> str:
    return " ".join(map(_order, values)) or NONE


def _error(value: float | None, sign: str = "+") -> str:
    return NONE if value is None else format(value, f"{sign}.1e")
