"""What each kind of evidence hands in to a report, and the folder that a report is written to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.measure.difference import Check
from validation.report import html
from validation.report.document import Document, Part, Section, figures_of
from validation.runs.folder import write_whole


@dataclass(frozen=True)
class Chapter:
    """One kind of evidence, or one scene of it, as it stands in a report.

    Parameters
    ----------
    name : str
        Of its suite in ``junit.xml``.
    checks : sequence of Check
    sections : tuple of Section
        Of the page.
    summary : tuple of Part
        Of ``summary.md``.
    data : mapping
        The keys of ``report.json`` that are its own.
    seconds : mapping of str to float
        Of the run of each solver, which its checks share alike; under the empty name, those that all checks
        share.
    outputs : sequence of str
        For the ``system-out`` of each check in ``junit.xml``; empty: none.
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
