"""One scene in a report: its small picture, parameters, curves, runs and checks."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from contact_scene import Adhesion, PowerRate
from validation.compare.suite import SceneComparison
from validation.drawing import run_figures
from validation.drawing.curves import elastic_limits, labels, of_trace, with_differences
from validation.drawing.figure import INK, curve_style, format_axes
from validation.report import document as doc
from validation.report.tables import COUNTERS, left_out_by_all, of_checks
from validation.solvers import REFERENCE

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

SMALL = (2.3, 1.7)
"""Inches of a small figure: six beside each other on a wide screen, two on a telephone."""
FLAT = 0.05
"""Half of the least height of a small figure, relative to the force: what differs by less is not seen."""


def drawn(scene: SceneComparison) -> tuple[doc.Section, doc.Figure]:
    """All about one scene, and the small figure that leads there."""
    case, verdict = scene.case, doc.passed_or_not(scene.passed)
    said = tuple(f"{solver}: {text}" for solver, run in scene.runs.items() for text in run.warnings)
    warned = (doc.Bullets(said),) if said else ()
    parts: tuple[doc.Part, ...] = (
        *((doc.Paragraph(case.statement),) if case.statement else ()),
        doc.Fold(f"Parameters ({case.scene.unit_names})", (parameters(scene),)),
        figures(scene),
        doc.Section("Runs", (runs(scene), *warned, doc.Paragraph(skipped_work(scene)))),
        doc.Section("Checks", (of_checks(scene.checks),)),
    )
    section = doc.Section(case.scene.title or case.name, parts, anchor(scene), verdict, folded=scene.passed)
    link = doc.LinkCell(case.name, anchor(scene))
    small = doc.Figure(f"small-{anchor(scene)}", case.name, link=link, verdict=verdict)
    return section, doc.with_drawing(small, _small(scene), f"Force against penetration, {case.name}")


def verdicts(scene: SceneComparison) -> doc.Section:
    """The checks alone, for a terminal."""
    return doc.Section(f"{scene.case.name}: {scene.case.scene.title}", (of_checks(scene.checks),))


def anchor(scene: SceneComparison) -> str:
    """Where the section is found in a page; any name of a scene gives one that is a valid id."""
    return f"scene-{doc.valid_id(scene.case.name)}"


def figures(scene: SceneComparison) -> doc.Part:
    """Curves of all solvers laid over each other."""
    question = scene.case.scene
    traces = [run.curves for run in scene.runs.values() if run.curves is not None]
    curves = with_differences([of_trace(trace, question) for trace in traces], REFERENCE)
    if not curves:
        return doc.Paragraph("No run gave a curve.")
    curves += elastic_limits(question, max(float(trace.contact_radius.max()) for trace in traces))
    drawn = []
    for panel in run_figures.PANELS:
        if any(panel.up in curve.columns for curve in curves):
            figure = doc.Figure(f"{anchor(scene)}-{panel.name}", panel.caption)
            drawing = run_figures.draw(panel, curves, labels(question))
            drawn.append(doc.with_drawing(figure, drawing, f"{panel.caption}, {scene.case.name}"))
    return doc.Figures(tuple(drawn))


def runs(scene: SceneComparison) -> doc.DataTable:
    """How each run ended, and the work and time it took."""
    return doc.DataTable.of(
        {"solver": solver, "ending": run.ending}
        | {title: doc.number(run.measures.get(f"counters.{name}")) for title, name in COUNTERS.items()}
        | {"seconds": doc.number(run.wall_seconds, 3), "processor": doc.number(run.cpu_seconds, 3)}
        for solver, run in scene.runs.items()
    )


def skipped_work(scene: SceneComparison) -> str:
    """What the solvers left out because the scene did not need it."""
    runs = scene.runs.items()
    work = {solver: asdict(run.trace.counters) for solver, run in runs if run.trace is not None}
    return left_out_by_all(work) if work else "No run has counters of its work."


def parameters(scene: SceneComparison) -> doc.DataTable:
    """What the scene consists of, as name and value."""
    question = scene.case.scene
    material, adhesion, loading = question.material, question.adhesion, question.loading
    branches = ", ".join(f"{b.modulus:g} (τ = {b.time:g})" for b in material.branches) or "none: elastic"
    rows = [
        ("relaxed modulus E₀", f"{material.modulus:g}"),
        ("branches", branches if len(material.branches) <= 8 else f"{len(material.branches)} branches"),
        ("Poisson's ratio", f"{material.poisson:g}"),
        ("indenter", ", ".join(filter(None, (question.indenter.shape, _numbers(question.indenter))))),
        *(_of_adhesion(adhesion) if adhesion is not None else ()),
        ("start", f"{loading.start} at penetration {loading.penetration:g}"),
        ("loading", "; ".join(f"{step.kind} {_numbers(step)}" for step in loading.steps) or "none"),
    ]
    return doc.DataTable(("", ""), tuple(rows), numeric=False)


def _of_adhesion(adhesion: Adhesion) -> list[tuple[str, str]]:
    rows = [("work of adhesion", f"{adhesion.work:g}"), ("process zone", f"{adhesion.zone:g}")]
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


def _small(scene: SceneComparison) -> Drawing | None:
    """Force against penetration of all solvers."""
    from matplotlib.figure import Figure as Drawing

    traces = [run.curves for run in scene.runs.values() if run.curves is not None]
    curves = [of_trace(trace, scene.case.scene) for trace in traces]
    if not curves:
        return None
    drawing = Drawing(figsize=SMALL)
    axes = drawing.add_axes((0.14, 0.15, 0.84, 0.83))
    for curve in sorted(curves, key=lambda one: -curve_style(one.style)["linewidth"]):
        x, y = curve.columns["penetration"], curve.columns["force"]
        single = {"marker": "o" if x.size == 1 else None, "markersize": 4}
        axes.plot(x, y, **curve_style(curve.style) | single)
    axes.set_xlabel("penetration", fontsize=8, color=INK, labelpad=3)
    axes.set_ylabel("force", fontsize=8, color=INK, labelpad=3)
    format_axes(axes)
    axes.grid(False)
    low, high = axes.get_ylim()
    spare = FLAT * max(abs(low), abs(high)) - 0.5 * (high - low)
    if spare > 0.0:
        axes.set_ylim(low - spare, high + spare)
    if low < 0.0 < high:
        axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.set(xticks=[], yticks=[])
    return drawing
