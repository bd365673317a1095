"""A study in its forms: one HTML page, Markdown, JSON with every number, figures as PNG and SVG."""

from __future__ import annotations

import io
from dataclasses import asdict
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validation.drawing import figures
from validation.execution.files import to_json, write_whole
from validation.report import study_figures
from validation.report.html import document, environment, table
from validation.report.study_text import Section, ladder, overview, prices, threads, zones
from validation.studies import work_precision

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from validation.studies.convergence import Convergence
    from validation.studies.study import SceneStudy, Study

FORMAT = 1
TITLE = "crosscontact study"
Drawn = dict[str, tuple[str, "Figure"]]  # figure name: caption, figure


def write(study: Study, folder: Path) -> None:
    """Write ``index.html``, ``study.md``, ``study.json`` and ``figures/SCENE-NAME.png`` and ``.svg``."""
    pictures = folder / "figures"
    pictures.mkdir(parents=True, exist_ok=True)
    drawn = {scene.case.name: _drawn(scene) for scene in study.scenes}
    for name, found in drawn.items():
        for figure_name, (_, figure) in found.items():
            write_whole(pictures / f"{name}-{figure_name}.png", figures.png(figure))
            write_whole(pictures / f"{name}-{figure_name}.svg", _plain_svg(figure))
    write_whole(folder / "study.json", json(study))
    write_whole(folder / "study.md", markdown(study))
    write_whole(folder / "index.html", html(study, drawn))


def _drawn(scene: SceneStudy) -> Drawn:
    charts = (*study_figures.CONVERGENCE, *study_figures.PRICES)
    found = {chart.name: (chart.caption, study_figures.draw(chart, scene.timed)) for chart in charts}
    return {name: (caption, figure) for name, (caption, figure) in found.items() if figure is not None}


def _plain_svg(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", facecolor="white", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def lines(study: Study) -> list[str]:
    """What the terminal shows: the orders of each scene in aligned columns, and the prices in words."""
    said = []
    for scene in study.scenes:
        said.append(f"{scene.case.name}: {scene.reference}")
        for entry in overview(scene).tables:
            rows = [entry.head, *entry.rows]
            widths = [max(len(row[i]) for row in rows) for i in range(len(entry.head))]
            said += [
                "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
                for row in rows
            ]
        said += work_precision.in_words(scene.timed)
    return [*said, _verdict(study)]


def html(study: Study, drawn: dict[str, Drawn]) -> str:
    """The page; it loads nothing."""
    parts = [f"<p>{escape(_verdict(study))}</p></header><main>"]
    shown = threads(study.environment)
    for scene in study.scenes:
        parts.append(f"<h2>{escape(scene.case.scene.title or scene.case.name)}</h2>")
        found = drawn[scene.case.name]
        parts.append(_section(overview(scene), _pictures(scene, found, "order")))
        parts.append(_section(prices(scene, shown), _pictures(scene, found, "price")))
        beside = zones(scene)
        parts += [] if beside is None else [_section(beside, "")]
        parts += [_folded(ladder(entry)) for entry in scene.ladders]
    parts.append(environment(study.environment, study.wall_seconds))
    return document(TITLE, parts)


def _section(section: Section, pictures: str) -> str:
    return f"<section><h3>{escape(section.title)}</h3>{pictures}{_body(section)}</section>"


def _folded(section: Section) -> str:
    return f"<details><summary>{escape(section.title)}</summary>{_body(section)}</details>"


def _body(section: Section) -> str:
    parts = [f"<p>{escape(text)}</p>" for text in section.paragraphs]
    for entry in section.tables:
        parts.append(f"<h4>{escape(entry.caption)}</h4>" if entry.caption else "")
        parts.append(table(tuple(map(escape, entry.head)), [tuple(map(_cell, row)) for row in entry.rows]))
    return "\n".join(parts)


def _cell(text: str) -> str:
    return f'<span class="fail">{escape(text)}</span>' if text.startswith("FAILED") else escape(text)


def _pictures(scene: SceneStudy, drawn: Drawn, kind: str) -> str:
    parts = []
    for name, (caption, figure) in drawn.items():
        if name.startswith(kind):
            unique = "".join(c if c.isascii() and c.isalnum() else "-" for c in f"{scene.case.name}-{name}")
            picture = figures.svg(figure, f"study-{unique}", escape(f"{caption}, {scene.case.name}"))
            parts.append(f"<figure>{picture}<figcaption>{escape(caption)}</figcaption></figure>")
    return f'<div class="figures">{"".join(parts)}</div>'


def markdown(study: Study) -> str:
    """Everything but the figures, which are named beside."""
    lines = [f"# {TITLE}", "", _verdict(study)]
    for scene in study.scenes:
        lines += ["", f"## {scene.case.scene.title or scene.case.name}"]
        first = [overview(scene), prices(scene, threads(study.environment)), zones(scene)]
        sections = [section for section in first if section is not None]
        for section in (*sections, *map(ladder, scene.ladders)):
            lines += ["", f"### {section.title}", ""]
            lines += [line for text in section.paragraphs for line in (text, "")]
            for entry in section.tables:
                lines += [f"**{entry.caption}**", ""] if entry.caption else []
                lines += ["| " + " | ".join(entry.head) + " |", "|---" * len(entry.head) + "|"]
                lines += ["| " + " | ".join(map(_bare, row)) + " |" for row in entry.rows]
                lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def _bare(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())


def json(study: Study) -> str:
    """Every number."""
    return to_json(
        {
            "format": FORMAT,
            "wall_seconds": study.wall_seconds,
            "environment": study.environment,
            "scenes": [_scene(scene) for scene in study.scenes],
        }
    )


def _scene(scene: SceneStudy) -> dict[str, Any]:
    asked = [
        {"measure": measure, "asked": error, "cheapest": best.scheme if best else None}
        | {"seconds": {entry.scheme: entry.seconds for entry in found}}
        for measure in work_precision.measures(scene.timed)
        for error in work_precision.ASKED
        for best, found in [work_precision.cheapest(scene.timed, measure, error)]
    ]
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "reference": scene.reference,
        "reference_uncertainty": scene.uncertainty,
        "failed_levels": len(scene.failed),
        "ladders": [_ladder(entry) for entry in scene.ladders],
        "cheapest": asked,
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


def _verdict(study: Study) -> str:
    levels = sum(len(entry.runs) for scene in study.scenes for entry in scene.ladders)
    failed = sum(len(scene.failed) for scene in study.scenes)
    return f"{len(study.scenes)} scenes, {levels} levels, {failed} failed, {study.wall_seconds:.0f} s."
