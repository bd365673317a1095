"""What each kind of evidence hands in to a report, the folder that a report is written to, and JUnit XML."""

from __future__ import annotations

import re
import xml.etree.ElementTree as tree
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.measure.difference import Check
from validation.report import html
from validation.report.document import Document, Part, Section, figures_of
from validation.report.tables import cells
from validation.runs.folder import write_whole

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML does not hold."""


@dataclass(frozen=True)
class Chapter:
    """One kind of evidence, or one scene of it, as it stands in a report.

    ``sections`` are those of the page, ``summary`` parts of ``summary.md``, ``data`` keys of ``report.json``
    that are its own; ``name`` is that of its suite in ``junit.xml``. ``seconds`` are those of the run of each
    solver, which its checks share alike, under the empty name those that all checks share; ``outputs`` the
    ``system-out`` of each check.
    """

    name: str
    checks: Sequence[Check] = ()
    sections: tuple[Section, ...] = ()
    summary: tuple[Part, ...] = ()
    data: Mapping[str, Any] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    outputs: Sequence[str] = ()

    def time_of(self, check: Check) -> float:
        """Seconds of a check."""
        own = sum(other.solver == check.solver for other in self.checks)
        return self.seconds.get(check.solver, 0.0) / own + self.seconds.get("", 0.0) / len(self.checks)


def write(folder: Path, page: Document, files: Mapping[str, str | bytes]) -> None:
    """Write files by their names, copies of the figures, and the page.

    ``index.html`` is last: where it exists, the set is complete. What passed has pages of its own in
    ``pages/`` where one page would be too large.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / html.INDEX).unlink(missing_ok=True)
    for name, content in files.items():
        write_whole(folder / name, content)
    for figure in figures_of(page.parts):
        for name, data in figure.files.items():
            (folder / "figures").mkdir(exist_ok=True)
            write_whole(folder / "figures" / name, data)
    for old in (folder / html.FOLDER).glob("*.html"):
        old.unlink()
    for name, text in reversed(html.pages(page).items()):
        (folder / name).parent.mkdir(exist_ok=True)
        write_whole(folder / name, text)


def junit(name: str, chapters: Iterable[Chapter], seconds: float) -> str:
    """Checks as JUnit XML: a suite for each chapter that has some, a case for each check."""
    suites = [chapter for chapter in chapters if chapter.checks]
    root = tree.Element("testsuites", name=_allowed(name))
    _count(root, [check for suite in suites for check in suite.checks], seconds)
    root.extend(map(element, suites))
    tree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + tree.tostring(root, encoding="unicode") + "\n"


def element(suite: Chapter) -> tree.Element:
    """One suite."""
    made = tree.Element("testsuite", name=_allowed(suite.name))
    _count(made, suite.checks, sum(suite.seconds.values()))
    for index, check in enumerate(suite.checks):
        case = tree.SubElement(
            made,
            "testcase",
            classname=_allowed(f"{check.scene}.{check.solver}"),
            name=_allowed(f"{index + 1} {check.quantity} ({check.source})"),
            time=f"{suite.time_of(check):.4f}",
        )
        if not check.passed:
            message = ", ".join(f"{title} {shown}" for title, shown in list(cells(check).items())[2:])
            tree.SubElement(case, "failure", message=_allowed(message)).text = _allowed(check.note or message)
        if suite.outputs:
            tree.SubElement(case, "system-out").text = _allowed(suite.outputs[index])
    return made


def _count(element: tree.Element, checks: Sequence[Check], seconds: float) -> None:
    element.attrib |= {
        "tests": str(len(checks)),
        "failures": str(sum(not check.passed for check in checks)),
        "errors": "0",
        "time": f"{seconds:.3f}",
    }


def _allowed(text: str) -> str:
    return _FORBIDDEN.sub("?", text)
