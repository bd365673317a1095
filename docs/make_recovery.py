"""Copies what ``python -m benchmarks.fit_recovery`` found into ``docs/how-to/fit.md``.

Run ``PYTHONPATH=. python docs/make_recovery.py out/recovery/recovery.json``: keeps the numbers in
``docs/data/recovery.json``, writes the table between two marks of the page, and draws the figure. Without a
file the numbers that are kept are used.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from benchmarks.fit_recovery import RecoveredMaterial, draw, report
from validation.drawing.export import png
from validation.execution.files import write_whole

DOCS = Path(__file__).parent
PAGE, FIGURE, KEPT = (
    DOCS / "how-to/fit.md",
    DOCS / "how-to/figures/fit-recovery.png",
    DOCS / "data/recovery.json",
)
BEGIN, END = "<!-- by docs/make_recovery.py -->\n", "<!-- to here -->\n"
DOTS_PER_INCH = 160


def materials(text: str) -> list[RecoveredMaterial]:
    """The materials of ``recovery.json``."""
    return [RecoveredMaterial(**entry) for entry in json.loads(text)]


def with_table(page: str, found: list[RecoveredMaterial]) -> str:
    """The page with the table of these materials between its marks."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{report(found, [])}\n{END}{after}"


def main(arguments: list[str]) -> None:
    """Write the page, the figure and the copy of the numbers."""
    text = (Path(arguments[0]) if arguments else KEPT).read_text("utf-8")
    found = materials(text)
    write_whole(KEPT, text)
    write_whole(PAGE, with_table(PAGE.read_text("utf-8"), found))
    write_whole(FIGURE, png(draw(found), DOTS_PER_INCH))


if __name__ == "__main__":
    main(sys.argv[1:])
