"""Parts of a saved report inside a page of the site, their style, and where they come from."""

from __future__ import annotations

import re
from collections.abc import Sequence

from validation.report import html
from validation.report.document import Part
from validation.report.report import Report

NOTE = "From a saved report of suite `{suite}`, computed {time} with crosscontact {version}; nothing is run."
SHOWN_RULES = re.compile(r"\.(pass|fail|wide|figures|sortable)|figure|figcaption")
"""Rules of a report's style sheet that its parts need on a page of the site."""


def style() -> str:
    """The rules for tables, figures and verdicts of a report, inside a page of the site."""
    rules = html.source("style.css")
    kept = [line for line in rules.splitlines() if SHOWN_RULES.match(line)]
    light = re.search(r":root \{ color-scheme: light dark; (.*?)\}", rules, re.DOTALL)
    dark = re.search(r"prefers-color-scheme: dark\) \{ :root \{(.*?)\}", rules, re.DOTALL)
    assert light is not None
    assert dark is not None
    return (
        f"body {{ {light.group(1)} }}\n"
        f'body[data-theme="dark"] {{ {dark.group(1)} }}\n'
        f"@media (prefers-color-scheme: dark) {{ body:not([data-theme=light]) {{ {dark.group(1)} }} }}\n"
        + "\n".join(kept)
        + "\n"
    )


def note(report: Report) -> str:
    """When and with which version the report was computed."""
    packages = report.environment["packages"]
    assert isinstance(packages, dict)
    time = str(report.environment["time"]).partition("T")[0]
    return NOTE.format(suite=report.suite, time=time, version=packages.get("crosscontact", ""))


def raw(parts: Sequence[Part], level: int) -> str:
    """Parts of a report inside a page of the site."""
    shown = re.sub(r"\n\s*\n+", "\n", html.fragment(parts, level))
    return f"```````{{raw}} html\n{shown}\n```````\n"
