"""Fields in the body along the cycle of Fig. 3: surfaces by two solvers, key moments, whole cycle."""

from __future__ import annotations

from validation.drawing import export
from validation.fields.cycle_fields import CycleFields
from validation.report.document import DataTable, Figure, Figures, Paragraph, Section, with_drawing
from validation.report.report import Chapter

TITLE = "Under the surface"
SURFACES = (
    "Fig. 3: surface and pressure (insets) along the cycle; below, pressure of either way, and the crack"
)
EXPLAINED = (
    "Fields of the finite elements on a section through the axis, in units of the scene. Colours cover "
    "99 % of the area in view (rates: 99.9 %); an arrow on the bar says that values go on, as they do at a "
    "sharp contact edge."
)
LOST = "Energy lost in the branches: densities summed over the body, and the trace's own"
HEAD = ("moment", "time", "penetration", "force", "contact radius", "lost in the body", "in the trace")


def chapter(fields: CycleFields) -> Chapter:
    """Pictures, and the energy balance at the key moments."""
    failed = (Paragraph(f"No pictures of fields: {fields.failure}", False),) if fields.failure else ()
    images = (
        Figure(one.name.partition(".")[0], one.caption, one.data, wide=True, files={one.name: one.data})
        for one in fields.images
    )
    pictures = Figures((_surfaces(fields), *images))
    energies = Section(LOST, (DataTable(HEAD, fields.rows),))
    section = Section(TITLE, (Paragraph(EXPLAINED), *failed, pictures, energies), "fields")
    return Chapter("fields", sections=(section,))


def _surfaces(fields: CycleFields) -> Figure:
    drawing, name = fields.surfaces, "fields-fig3"
    files = {} if drawing is None else {f"{name}.png": export.png(drawing)}
    missing = "No Fig. 3: a run is missing."
    return with_drawing(Figure(name, SURFACES, wide=True, missing=missing, files=files), drawing)
