"""What ``crosscontact stability`` writes: a page, Markdown, JSON, the heat maps."""

from __future__ import annotations

from pathlib import Path

from validation.execution.environment import stamp
from validation.execution.files import to_json, write_whole
from validation.report import stability_section as section
from validation.report.html import document, environment
from validation.stability.runner import StabilityMatrix

JSON = "stability.json"


def keep(matrix: StabilityMatrix, folder: Path, complete: bool) -> None:
    """Write the JSON alone, which also holds what an interrupted run has."""
    write_whole(folder / JSON, to_json({"format": 1, **section.data(matrix, complete)}))


def write(matrix: StabilityMatrix, folder: Path) -> None:
    """Write ``index.html``, ``stability.md``, ``stability.json`` and ``figures/``."""
    computed_on = stamp()
    (folder / "figures").mkdir(exist_ok=True)
    for name, picture in section.pictures(matrix).items():
        write_whole(folder / "figures" / name, picture)
    lines = ["# crosscontact stability", *section.markdown(matrix)]
    write_whole(folder / "stability.md", "\n".join(lines) + "\n")
    keep(matrix, folder, True)
    faults = len(matrix.faults)
    verdict = "no fault" if not faults else f"{faults} at fault"
    parts = [
        f'<p class="{"fail" if faults else "pass"}">{len(matrix.cells)} cells: {verdict}.</p></header><main>',
        section.html(matrix),
        environment(computed_on, matrix.wall_seconds),
    ]
    write_whole(folder / "index.html", document("crosscontact stability", parts))
