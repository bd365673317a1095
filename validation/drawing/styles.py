"""Colours and line styles of all figures, stated once.

Colours are Okabe and Ito's, distinct for any kind of colour vision; line style or marker differ beside them.
In a page each colour is a CSS variable, so that a page can be light or dark.
"""

from __future__ import annotations

from typing import Any

from validation.solvers import SOLVERS

BLUE, VERMILION, PURPLE, ORANGE, SKY, GREEN = (
    "#0072b2", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#009e73"
)  # fmt: skip
GREY = "#999999"
INK = "#0a0a0a"  # text and axes; not quite black, so that the page can replace it by its own
GRID = "#b3b3b4"
SERIES = (BLUE, VERMILION, PURPLE, ORANGE, SKY, INK)  # colours of curves that belong to no solver
DASHES: tuple[Any, ...] = ("-", (0, (6, 1.5)), (0, (3, 1, 1, 1)), (0, (1, 1)), (0, (8, 2, 2, 2)), "-.")
MARKERS = "os^Dvx"
APPROACH, RETRACTION = BLUE, VERMILION

CSS_VARIABLES = {
    GREY: "var(--reference)",
    BLUE: "var(--bem)",
    VERMILION: "var(--fem)",
    GREEN: "var(--closed)",
    INK: "currentColor",
    GRID: "var(--grid)",
}
CLOSED_FORM: dict[str, Any] = {"color": GREEN, "linestyle": ":", "linewidth": 1.3}
_OTHER: dict[str, Any] = {"color": ORANGE, "linestyle": (0, (8, 2, 2, 2)), "linewidth": 1.4, "marker": "P"}


def curve_style(name: str) -> dict[str, Any]:
    """Line properties of a solver: colour, line style and width, marker."""
    method = SOLVERS.get(name)
    if method is None:
        return _OTHER
    return {**method.curve_style, "marker": method.marker}
