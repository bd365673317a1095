"""Pages of the documentation that are made from the program and from a saved report."""

from __future__ import annotations

import shutil
from pathlib import Path

from site_pages import api, command_line, costs, gallery, readme, report_parts, scene_keys
from validation.report import html


def write(docs: Path, report: Path) -> None:
    """Write ``docs/generated`` anew, and the style and script of reports to ``docs/_static``.

    Parameters
    ----------
    docs : Path
    report : Path
        The folder of a report, or its archive.
    """
    target = docs / "generated"
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir()
    pages = {
        "command-line.md": command_line.page(),
        "api.md": api.page(),
        "scene-keys.md": scene_keys.page(),
        "costs.md": costs.page(),
        "accuracy.md": readme.accuracy(report),
    }
    for name, text in pages.items():
        (target / name).write_text(text, "utf-8")
    gallery.write(target / "gallery", report)
    (docs / "_static" / "report-parts.js").write_text(html.source("script.js"), "utf-8")
    (docs / "_static" / "report-parts.css").write_text(report_parts.style(), "utf-8")
