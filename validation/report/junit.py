"""The report as JUnit XML: one suite per scene, one case per check."""

from __future__ import annotations

import re
import xml.etree.ElementTree as tree
from typing import TYPE_CHECKING

from validation.report import claims_section, stability_section
from validation.report.text import HEAD, row

if TYPE_CHECKING:
    from validation.report.build import Report

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def text(report: Report) -> str:
    """The whole report."""
    root = tree.Element("testsuites", name=f"crosscontact {report.suite}")
    _count(root, len(report.checks), len(report.failures), report.wall_seconds)
    for page in report.pages:
        seconds = sum(result.wall_seconds for result in page.runs.values())
        suite = tree.SubElement(root, "testsuite", name=_clean(page.case.name))
        _count(suite, len(page.checks), sum(not check.passed for check in page.checks), seconds)
        for index, check in enumerate(page.checks, 1):
            cells = dict(zip(HEAD, row(check), strict=True))
            case = tree.SubElement(
                suite,
                "testcase",
                classname=_clean(f"{check.scene}.{check.solver}"),
                name=_clean(f"{index} {check.quantity} ({check.source})"),
                time="0",
            )
            if not check.passed:
                message = ", ".join(f"{name} {cells[name]}" for name in HEAD[2:])
                tree.SubElement(case, "failure", message=_clean(message)).text = _clean(check.note or message)
    if report.claims is not None:
        root.append(claims_section.junit(report.claims))
    if report.stability is not None:
        root.append(stability_section.junit(report.stability))
    tree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + tree.tostring(root, encoding="unicode") + "\n"


def _count(element: tree.Element, tests: int, failures: int, seconds: float) -> None:
    element.attrib |= {
        "tests": str(tests),
        "failures": str(failures),
        "errors": "0",
        "time": f"{seconds:.3f}",
    }


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("?", text)
