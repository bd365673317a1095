"""One scene: its parameters, curves, runs and checks."""

from __future__ import annotations

from dataclasses import asdict

from contact_scene import Adhesion, PowerRate
from validation.compare import overview_figures
from validation.compare.suite import SceneComparison
from validation.drawing import run_figures
from validation.drawing.curves import elastic_limits, labels, of_trace, with_differences
from validation.measure.warnings import left_out_by_all
from validation.report.document import (
    Bullets,
    DataTable,
    Figure,
    Figures,
    Fold,
    Paragraph,
    Part,
    Section,
    number,
    passed_or_not,
    valid_id,
    with_drawing,
)
from validation.report.tables import COUNTERS, of_checks
from validation.solvers import REFERENCE


def section(scene: SceneComparison) -> Section:
    """All about one scene."""
    case = scene.case
    parts: tuple[Part, ...] = (
        *((Paragraph(case.statement),) if case.statement else ()),
        Fold("Parameters (scene units)", (parameters(scene),)),
        figures(scene),
        Section("Runs", (runs(scene), *_warnings(scene), Paragraph(skipped_work(scene)))),
        Section("Checks", (of_checks(scene.checks),)),
    )
    verdict = passed_or_not(scene.passed)
    return Section(case.scene.title or case.name, parts, anchor(scene), verdict, folded=scene.passed)


def drawn(scene: SceneComparison) -> tuple[Section, Figure]:
    """The section of a scene, and the small figure that leads to it."""
    return section(scene), overview_figures.small(scene, anchor(scene))


def verdicts(scene: SceneComparison) -> Section:
    """The checks alone, for a terminal."""
    return Section(f"{scene.case.name}: {scene.case.scene.title}", (of_checks(scene.checks),))


def anchor(scene: SceneComparison) -> str:
    """Where the section is found in a page; any name of a scene gives one that is a valid id."""
    return f"scene-{valid_id(scene.case.name)}"


def figures(scene: SceneComparison) -> Part:
    """Curves of all solvers laid over each other."""
    question = scene.case.scene
    traces = [run.curves for run in scene.runs.values() if run.curves is not None]
    curves = with_differences([of_trace(trace, question) for trace in traces], REFERENCE)
    if not curves:
        return Paragraph("No run gave a curve.")
    curves += elastic_limits(question, max(float(trace.contact_radius.max()) for trace in traces))
    drawn = []
    for panel in run_figures.PANELS:
        if any(panel.up in curve.columns for curve in curves):
            figure = Figure(f"{anchor(scene)}-{panel.name}", panel.caption)
            drawing = run_figures.draw(panel, curves, labels(question))
            drawn.append(with_drawing(figure, drawing, f"{panel.caption}, {scene.case.name}"))
    return Figures(tuple(drawn))


def runs(scene: SceneComparison) -> DataTable:
    """How each run ended, and the work and time it took."""
    return DataTable.of(
        {"solver": solver, "ending": run.ending}
        | {title: number(run.measures.get(f"counters.{name}")) for title, name in COUNTERS.items()}
        | {"seconds": number(run.wall_seconds, 3), "processor": number(run.cpu_seconds, 3)}
        for solver, run in scene.runs.items()
    )


def _warnings(scene: SceneComparison) -> tuple[Bullets, ...]:
    """What makes the answers doubtful, by solver."""
    said = tuple(f"{solver}: {text}" for solver, run in scene.runs.items() for text in run.warnings)
    return (Bullets(said),) if said else ()


def skipped_work(scene: SceneComparison) -> str:
    """What the solvers left out because the scene did not need it."""
    traces = {solver: run.trace for solver, run in scene.runs.items() if run.trace is not None}
    work = {solver: asdict(trace.counters) for solver, trace in traces.items()}
    return left_out_by_all(work) if work else "No run has counters of its work."


def parameters(scene: SceneComparison) -> DataTable:
    """What the scene consists of, as name and value."""
    question = scene.case.scene
    material, adhesion = question.material, question.adhesion
    branches = ", ".join(f"{b.modulus:g} (τ = {b.time:g})" for b in material.branches) or "none: elastic"
    steps = "; ".join(f"{step.kind} {_numbers(step)}" for step in question.loading.steps)
    rows = [
        ("relaxed modulus E₀", f"{material.modulus:g}"),
        ("branches", branches if len(material.branches) <= 8 else f"{len(material.branches)} branches"),
        ("Poisson's ratio", f"{material.poisson:g}"),
        ("indenter", ", ".join(filter(None, (question.indenter.shape, _numbers(question.indenter))))),
        ("start", f"{question.loading.start} at penetration {question.loading.penetration:g}"),
        ("loading", steps or "none"),
    ]
    if adhesion is not None:
        rows[4:4] = [
            ("work of adhesion", f"{adhesion.work:g}"),
            ("process zone", f"{adhesion.zone:g}"),
            *_laws(adhesion),
        ]
    return DataTable(("", ""), tuple(rows), numeric=False)


def _laws(adhesion: Adhesion) -> list[tuple[str, str]]:
    """What an adhesion tells beyond work and zone."""
    rows = []
    if adhesion.stress is not None:
        rows.append(("cohesive stress, the zone above being that at rest", f"{adhesion.stress:g}"))
    if adhesion.work_closing is not None:
        rows.append(("work of adhesion on closing", f"{adhesion.work_closing:g}"))
    if isinstance(adhesion.rate, PowerRate):
        law = f"w (1 + (v/{adhesion.rate.speed:g})^{adhesion.rate.exponent:g})"
        rows.append(("work of adhesion on opening at v", law))
    elif adhesion.rate is not None:
        rows.append(("work of adhesion on opening at v", f"table of {len(adhesion.rate.speeds)} rows"))
    return rows


def _numbers(stated: object) -> str:
    """The numbers of an indenter or a loading step, by name."""
    facts = vars(stated).items()
    return ", ".join(
        f"{name.replace('_', ' ')} {value:g}" for name, value in facts if isinstance(value, float)
    )
