"""The first page of the gallery: scenes by topic and by figure of the paper."""

from __future__ import annotations

import re
from collections.abc import Mapping

from site_pages.report_parts import note, raw
from validation.cases import Case
from validation.compare.suite import SceneComparison
from validation.report.report import Report
from validation.report.sections import environment, overview

TOPICS = {
    "cycle": "Approach and retraction",
    "retraction": "Retraction from the relaxed state",
    "dwell": "Dwell before retraction",
    "force": "Constant force",
    "oscillation": "Oscillations",
    "sweep": "Oscillations",
    "elastic": "Elastic limits",
    "relaxed": "Elastic limits",
    "bulk": "Bulk relaxation apart from shear",
    "cone": "Other indenters",
    "punch": "Other indenters",
    "repressed": "Other indenters",
    "three": "Several relaxation times",
    "adhesionless": "Without adhesion",
    "afm": "Springs",
    "spring": "Springs",
    "hysteresis": "Laws of adhesion",
    "rated": "Laws of adhesion",
    "fixed": "Laws of adhesion",
    "pdms": "Short process zones",
}
"""Topic of a scene by the beginning of its name."""
OTHER = "Other scenes"
LEADS_ON = """\
The paper's statements with their verdicts: [statements](statements.md). Refinement: [studies](studies.md).
Stiff and extreme cases: [stability](stability.md).
"""


def page(cases: Mapping[str, Case], compared: Mapping[str, SceneComparison], report: Report) -> str:
    """All built-in scenes; those that the report holds with the count of their checks.

    Parameters
    ----------
    cases : mapping of str to Case
    compared : mapping of str to SceneComparison
        Those of the report, by name.
    report : Report

    Returns
    -------
    str
        Markdown.
    """
    lines = ["# Verification gallery", "", note(report), ""]
    lines += [overview.lead(report).text, ""]
    lines += [LEADS_ON, "## By topic", ""]
    by_topic: dict[str, list[str]] = {}
    for name in cases:
        by_topic.setdefault(TOPICS.get(re.split(r"[-.]", name)[0], OTHER), []).append(name)
    for topic, members in by_topic.items():
        lines += [f"### {topic}", "", "| scene | title | checks | |", "|---|---|---|---|"]
        lines += [_row(cases[name], compared.get(name)) for name in members]
        lines += [""]
    lines += ["## By figure of the paper", "", "| figure | scenes |", "|---|---|"]
    by_figure: dict[str, list[str]] = {}
    for name, case in cases.items():
        by_figure.setdefault(case.figure or "none", []).append(name)
    for figure, members in sorted(by_figure.items()):
        lines += [f"| {figure} | {', '.join(f'[{name}]({name}.md)' for name in members)} |"]
    lines += ["", "```{toctree}", ":hidden:", "", "statements", "studies", "stability", *cases, "```", ""]
    return "\n".join([*lines, raw([environment.section(report.environment, report.wall_seconds)], 2)])


def _row(case: Case, scene: SceneComparison | None) -> str:
    counted, verdict = "–", "not in this report"
    if scene is not None:
        counted = f"{sum(check.passed for check in scene.checks)}/{len(scene.checks)}"
        verdict = "pass" if scene.passed else "**FAIL**"
    return f"| [{case.name}]({case.name}.md) | {case.scene.title} | {counted} | {verdict} |"
