"""The page of a fit: verdict, estimates with errors, what the data cannot tell, second solver."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from validation.fits.fit_result import FitResult
from validation.report.document import (
    Bullets,
    DataTable,
    Document,
    Figure,
    Figures,
    Paragraph,
    Part,
    Section,
)
from validation.report.figures import fit_chart
from validation.report.pictures import with_drawing
from validation.report.sections.fit_statements import lead, statements
from validation.report.sections.fit_tables import curves, method, products, second_opinion, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

CURVES = """\
Measured and fitted force over the position of indenter or stage; below, what is left, over the noise. Grey
rows around jumps of the force are not compared, the moments of the jumps are."""
COMBINATIONS = """\
Products of powers of the parameters whose errors are independent of each other, the least known first, with
their relative standard deviation. Powers below 0.2 are left out."""
PROFILES = """\
Increase of the least sum of squares as one parameter is held at a value and all others are fitted anew, over
the variance of a residual; at 3.84 the 95 % interval ends."""


def document(result: FitResult, drawings: Mapping[str, Drawing]) -> Document:
    """The whole page, with the figures of :func:`drawings`."""
    said = statements(result)
    parts: list[Part] = [Section("Parameters", (table(result),))]
    if said:
        parts.insert(0, Section("Before you use a number", (Bullets(tuple(said)),)))

    def figures(name: str, caption: str) -> Figures:
        wide = name == "curves"
        return Figures((with_drawing(Figure(f"fit-{name}", caption, wide=wide), drawings[name]),))

    parts.append(Section("Curves", (figures("curves", CURVES), DataTable.of(curves(result)))))
    known = (
        Paragraph(COMBINATIONS),
        DataTable.of(products(result.combinations)),
        figures("correlations", "Correlations of the parameters."),
    )
    parts.append(Section("What the data tell apart", known))
    if result.profiles:
        parts.append(Section("Profile likelihood", (figures("profiles", PROFILES),)))
    if result.check is not None:
        parts.append(Section(f"The same by {result.check.solver}", tuple(second_opinion(result))))
    parts.append(Section("How it was done", (Bullets(tuple(method(result))),)))
    return Document(f"Fit: {result.scene.title or 'a scene'}", (lead(result),), tuple(parts))


def drawings(result: FitResult) -> dict[str, Drawing]:
    """The figures by name: ``curves``, ``correlations`` and, where there are some, ``profiles``."""
    made = {
        "curves": fit_chart.draw_curves(result.curves),
        "correlations": fit_chart.draw_correlations(result),
    }
    return made | ({"profiles": fit_chart.draw_profiles(result.profiles)} if result.profiles else {})
