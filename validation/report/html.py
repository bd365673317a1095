"""The report as one HTML file that loads nothing: for screen, phone and paper, light and dark."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from validation.drawing import figures
from validation.drawing.curves import elastic_limits, labels, of_trace, with_differences
from validation.report import claims_section, costs, fields_section, stability_section
from validation.report.style import STYLE
from validation.report.text import HEAD, MOVE_HEAD, move_row, number, parameters, row, spared_by
from validation.solvers import REFERENCE

if TYPE_CHECKING:
    from validation.compare.suite import SceneComparison
    from validation.report.build import Report


def text(report: Report) -> str:
    """The whole page."""
    failed = len(report.failures)
    verdict = "all passed" if not failed else f"{failed} not passed"
    title = f"crosscontact report, suite {report.suite}"
    parts = [
        f'<p class="{"fail" if failed else "pass"}">{len(report.checks)} checks on {len(report.pages)} '
        f"scenes: {verdict}.</p>",
        "<p>Differences are relative; each stands beside what solver and reference say of their own errors "
        "and beside the scene's tolerance. Two runs agree where they differ by no more than both estimates "
        "together, at most by the tolerance; where an estimate is missing, by the tolerance. A coarse or "
        "failed run stays in the tables and figures.</p></header><main>",
        _overview(report),
        _baseline(report),
        "" if report.claims is None else claims_section.html(report.claims),
        "" if report.stability is None else stability_section.html(report.stability),
        "" if report.fields is None else fields_section.html(report.fields),
        *(_section(page) for page in report.pages),
        "<section><h2>Where the time went</h2>" + table(costs.HEAD, _escaped(costs.rows(report.runs))),
        "</section>",
        environment(report.environment, report.wall_seconds),
    ]
    return document(title, parts)


def document(title: str, parts: Sequence[str]) -> str:
    """A page around ``parts``; these close the header that the title opens, and open ``main``."""
    whole = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        '<meta name="color-scheme" content="light dark">',
        f"<title>{escape(title)}</title>",
        f"<style>{STYLE}</style></head><body>",
        f"<header><h1>{escape(title)}</h1>",
        *parts,
        "</main></body></html>",
    ]
    return "\n".join(whole) + "\n"


def _overview(report: Report) -> str:
    head = ("scene", "paper", "checks", "verdict", "closest to its limit")
    rows = []
    for page in report.pages:
        good = sum(check.passed for check in page.checks)
        rows.append(
            (
                f'<a href="#{_anchor(page)}">{escape(page.case.name)}</a>',
                escape(page.case.figure),
                f"{good}/{len(page.checks)}",
                _verdict("pass" if page.passed else "FAIL"),
                escape(_closest(page)),
            )
        )
    return "<section><h2>Overview</h2>" + table(head, rows) + "</section>"


def _baseline(report: Report) -> str:
    """What moved since an earlier report; nothing without one."""
    if report.baseline is None:
        return ""
    moves = report.baseline.moves
    rows = [
        tuple(
            _flag(cell) if name == "beyond" else escape(cell)
            for name, cell in zip(MOVE_HEAD, cells, strict=True)
        )
        for cells in map(move_row, moves)
    ]
    listed = table(MOVE_HEAD, rows) if rows else ""
    return f"<section><h2>Since the baseline</h2><p>{escape(report.baseline.verdict)}</p>{listed}</section>"


def _flag(word: str) -> str:
    return f'<span class="{"pass" if word == "no" else "fail"}">{escape(word)}</span>'


def _closest(page: SceneComparison) -> str:
    """The check that uses most of what it is allowed."""
    used = [
        (abs(check.difference) / check.limit, check)
        for check in page.checks
        if check.difference is not None and check.limit
    ]
    if not used:
        return "–"
    share, check = max(used, key=lambda pair: pair[0])
    return f"{100 * share:.0f} %: {check.quantity.replace('_', ' ')}, {check.solver}"


def _section(page: SceneComparison) -> str:
    case = page.case
    head = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in parameters(page))
    return "\n".join(
        (
            f'<section id="{_anchor(page)}"><h2>{escape(case.scene.title or case.name)} '
            f"{_verdict('pass' if page.passed else 'FAIL')}</h2>",
            f"<p>{escape(case.statement)}</p>" if case.statement else "",
            f'<details><summary>Parameters (scene units)</summary><div class="wide"><table>{head}</table>'
            "</div></details>",
            f'<div class="figures">{_figures(page)}</div>',
            "<h3>Runs</h3>",
            _runs(page),
            f"<p>{escape(spared_by(page))}</p>",
            "<h3>Checks</h3>",
            table(HEAD, [_check_row(row(check)) for check in page.checks]),
            "</section>",
        )
    )


def _figures(page: SceneComparison) -> str:
    scene = page.case.scene
    traces = [result.trace for result in page.runs.values() if result.trace is not None]
    curves = with_differences([of_trace(trace, scene) for trace in traces if len(trace)], REFERENCE)
    if not curves:
        return "<p>No run gave a curve.</p>"
    curves += elastic_limits(scene, max(float(trace.contact_radius.max()) for trace in traces if len(trace)))
    drawn = []
    for panel in figures.PANELS:
        if not any(panel.up in curve.columns for curve in curves):
            continue
        description = escape(f"{panel.caption}, {page.case.name}")
        picture = figures.svg(
            figures.draw(panel, curves, labels(scene)), f"{_anchor(page)}-{panel.name}", description
        )
        drawn.append(f"<figure>{picture}<figcaption>{escape(panel.caption)}</figcaption></figure>")
    return "\n".join(drawn)


def _runs(page: SceneComparison) -> str:
    head = (
        "solver",
        "ending",
        "steps",
        "rejected",
        "closure",
        "solves",
        "factorisations",
        "seconds",
        "processor",
    )
    rows = []
    for solver, result in page.runs.items():
        counts = [
            number(result.measures.get(f"counters.{name}"))
            for name in ("steps", "rejected_steps", "closure_evaluations", "linear_solves", "factorisations")
        ]
        times = (number(result.wall_seconds, 3), number(result.cpu_seconds, 3))
        cells = (solver, result.ending, *counts, *times)
        rows.append(tuple(map(escape, cells)))
    return table(head, rows)


def _escaped(rows: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    return [tuple(map(escape, line)) for line in rows]


def environment(stamp: Mapping[str, object], wall_seconds: float) -> str:
    """The section on versions, machine and threads."""
    rows = []
    for key, value in stamp.items():
        shown = ", ".join(f"{k} {v}" for k, v in value.items()) if isinstance(value, dict) else str(value)
        rows.append((escape(key), escape(shown)))
    rows.append(("whole report", f"{wall_seconds:.1f} s"))
    return "<section><h2>Computed on</h2>" + table(("", ""), rows) + "</section>"


def _check_row(cells: tuple[str, ...]) -> tuple[str, ...]:
    shown = []
    for head, cell in zip(HEAD, cells, strict=True):
        whole = f'<span class="whole">{escape(cell)}</span>'  # not broken at its signs
        shown.append({"verdict": _verdict(cell), "estimates": whole}.get(head, escape(cell)))
    return tuple(shown)


def _verdict(word: str) -> str:
    return f'<span class="{"pass" if word == "pass" else "fail"}">{escape(word)}</span>'


def table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """A table of ready-made cells that scrolls by itself where it is too wide."""
    titles = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in line) + "</tr>" for line in rows)
    return f'<div class="wide"><table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table></div>'


def _anchor(page: SceneComparison) -> str:
    return "scene-" + "".join(c if c.isascii() and c.isalnum() else "-" for c in page.case.name)
