"""Checks as JUnit XML: one suite for each scene and kind of evidence, one case for each check."""

from __future__ import annotations

import re
import xml.etree.ElementTree as tree
from collections.abc import Iterable, Sequence

from validation.measure.difference import Check
from validation.report.report import Chapter
from validation.report.tables import cells

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def text(name: str, chapters: Iterable[Chapter], seconds: float) -> str:
    """The whole file: a suite for each chapter that has checks."""
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
