"""The paper's statements, with their verdicts and figures, in every form of the report."""

from __future__ import annotations

import xml.etree.ElementTree as tree
from dataclasses import asdict, dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from validation.claims.claim import Finding, Verdict
from validation.claims.evidence import Evidence
from validation.drawing import figures
from validation.report.paper_figures import FIGURES, drawn

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TITLE = "What the paper says"
COUNTED = dict(zip(Verdict, ("hold", "hold in part", "do not hold", "could not be judged"), strict=True))
HEAD = ("verdict", "place in the paper", "what it says", "what was found")
EXPLAINED = (
    "Statements of the paper, paraphrased, each judged on boundary-element runs (and on the reference "
    "where it "
    "says so). A statement that does not hold as worded is a finding, not a failed check; a verdict "
    "that is no "
    "longer the recorded one is. Within a line, NOT marks what does not hold. The process zone has the "
    "paper's "
    "length, 0.013 R, and is part of the model: the elastic pull-off force is then 1.027 (soft) to "
    "1.058 (stiff) "
    "times that of JKR."
)


@dataclass(frozen=True)
class Claims:
    """The findings, and the runs they rest on."""

    findings: tuple[Finding, ...]
    evidence: Evidence

    @cached_property
    def figures(self) -> dict[str, Figure | None]:
        """The paper's figures by name; ``None`` where a run is missing."""
        return {paper.name: drawn(paper, self.evidence) for paper in FIGURES}

    @property
    def summary(self) -> str:
        """How many hold, and how many not."""
        counts = {verdict: sum(one.verdict is verdict for one in self.findings) for verdict in Verdict}
        said = ", ".join(f"{count} {COUNTED[verdict]}" for verdict, count in counts.items() if count)
        changed = sum(one.changed for one in self.findings)
        verdicts = "no verdict" if not changed else f"{changed} verdict{'s' if changed > 1 else ''}"
        return f"{len(self.findings)} statements: {said}; {verdicts} changed."


def html(claims: Claims) -> str:
    """Section of the page: figures and a table."""
    rows = ""
    for one in claims.findings:
        cells = (_verdict(one), *map(escape, _cells(one)[1:]))
        rows += "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
    titles = "".join(f"<th>{escape(name)}</th>" for name in HEAD)
    table = f"<table><thead><tr>{titles}</tr></thead><tbody>{rows}</tbody></table>"
    return (
        f'<section id="claims"><h2>{TITLE}</h2><p>{escape(claims.summary)}</p><p>{escape(EXPLAINED)}</p>'
        f'<div class="figures">{_figures(claims)}</div>'
        f'<div class="wide">{table}</div></section>'
    )


def _figures(claims: Claims) -> str:
    shown = []
    for paper in FIGURES:
        made = claims.figures[paper.name]
        body = (
            "<p>No figure: a run is missing.</p>"
            if made is None
            else figures.svg(made, f"paper-{paper.name}", escape(paper.caption))
        )
        opening = '<figure class="whole">' if paper.whole else "<figure>"
        shown.append(f"{opening}{body}<figcaption>{escape(paper.caption)}</figcaption></figure>")
    return "\n".join(shown)


def pictures(claims: Claims) -> dict[str, bytes]:
    """The same figures as PNG, by file name."""
    return {
        f"{name}.png": figures.png(figure) for name, figure in claims.figures.items() if figure is not None
    }


def _cells(one: Finding) -> tuple[str, str, str, str]:
    verdict = str(one.verdict) + (f" (recorded: {one.recorded})" if one.changed else "")
    return verdict, one.place, one.wording, one.shown


def _verdict(one: Finding) -> str:
    kind = "fail" if one.changed else "pass" if one.verdict is Verdict.HOLDS else ""
    return f'<span class="{kind}">{escape(_cells(one)[0])}</span>' if kind else escape(_cells(one)[0])


def markdown(claims: Claims) -> list[str]:
    """Lines of the summary: the count, and whatever does not simply hold."""
    lines = [
        "",
        f"## {TITLE}",
        "",
        claims.summary,
        "",
        "| " + " | ".join(HEAD) + " |",
        "|---" * len(HEAD) + "|",
    ]
    told = [one for one in claims.findings if one.verdict is not Verdict.HOLDS or one.changed]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in _cells(one)) + " |" for one in told]
    return lines


def data(claims: Claims) -> list[dict[str, Any]]:
    """Everything, for programs."""
    return [
        asdict(one) | {"verdict": str(one.verdict), "changed": one.changed, "found": one.shown}
        for one in claims.findings
    ]


def junit(claims: Claims) -> tree.Element:
    """A test suite, one case a statement; the verdict and what was found are its output."""
    changed = sum(one.changed for one in claims.findings)
    suite = tree.Element(
        "testsuite",
        name="claims",
        tests=str(len(claims.findings)),
        failures=str(changed),
        errors="0",
        time="0",
    )
    for one in claims.findings:
        case = tree.SubElement(
            suite, "testcase", classname="claims", name=f"{one.name} ({one.place})", time="0"
        )
        if one.changed:
            message = f"{one.verdict}, recorded: {one.recorded}"
            tree.SubElement(case, "failure", message=message).text = one.shown
        tree.SubElement(case, "system-out").text = f"{one.verdict}: {one.wording} Found: {one.shown}"
    return suite
