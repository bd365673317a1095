"""Fields in the body along the cycle of Fig. 3, for a report: surfaces by two solvers, moments, whole cycle.

The surfaces are those of runs that exist already; the fields take a finite-element run of their own, which
keeps its history.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from contact_scene import Scene, Trace
from validation.cases import Case, load
from validation.drawing.figure import png
from validation.fields import fig3, figures
from validation.fields.figures import USUAL, FigureSet
from validation.fields.moments import FieldRequest, balance, record_fields
from validation.fields.quantities import QUANTITIES
from validation.fields.rendering import NoRendering
from validation.fields.section import looks
from validation.measure.events import end_of_approach
from validation.report import document as doc
from validation.report.report import Chapter
from validation.runs.run import Run

if TYPE_CHECKING:
    from fem_solver import FieldState

SCENE = "cycle-v0.002"
FRAMES = 40
"""Of the animation."""
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


def chapter(runs: Mapping[str, Run], progress: Callable[[float], None] = lambda done: None) -> Chapter:
    """Run the finite elements once more and draw; a machine that cannot draw is no error.

    ``runs`` are those on ``SCENE`` by solver, or none.
    """
    case = load(SCENE)
    asked = FieldRequest(picked=FigureSet(moments=True, animate=True, frames=FRAMES).rows)
    recorded = record_fields(case.scene, asked, None, lambda done: progress(0.2 * done))
    states, trace = list(recorded.states()), recorded.recording.trace
    progress(0.4)
    images: list[doc.Figure] = []
    failure: tuple[doc.Paragraph, ...] = ()
    try:
        images += pictures(states, trace, case.scene, lambda done: progress(0.4 + 0.6 * done))
    except NoRendering as error:
        failure = (doc.Paragraph(f"No pictures of fields: {error}", False),)
    rows = tuple(_energies(state, trace) for state in states if state.label)
    shown = doc.Figures((surfaces(runs, case), *images))
    lost = doc.Section(LOST, (doc.DataTable(HEAD, rows),))
    parts: tuple[doc.Part, ...] = (doc.Paragraph(EXPLAINED), *failure, shown, lost)
    return Chapter("fields", sections=(doc.Section(TITLE, parts, "fields"),))


def surfaces(runs: Mapping[str, Run], case: Case) -> doc.Figure:
    """Fig. 3 from boundary and finite elements, or that a run or a surface is missing."""
    traces = [run.trace for name in fig3.TWO_SOLVERS if (run := runs.get(name)) and run.trace is not None]
    found = [sorted(trace.profiles, key=lambda one: one.time) for trace in traces]
    shown = doc.Figure("fields-fig3", SURFACES, wide=True, missing="No Fig. 3: a run is missing.")
    if len(traces) != 2 or {len(one) for one in found} != {len(case.profile_times)}:
        return shown
    turn = float(traces[0].time[end_of_approach(traces[0])])
    drawing = fig3.figure(case.scene, found[0], found[1], turn)
    shown = doc.Figure(shown.name, SURFACES, wide=True, files={"fields-fig3.png": png(drawing)})
    return doc.with_drawing(shown, drawing)


def pictures(
    states: Sequence[FieldState], trace: Trace, scene: Scene, progress: Callable[[float], None]
) -> Iterator[doc.Figure]:
    """The key moments, sections at the largest tension, the body of revolution and the animation."""
    key, drawn = [state for state in states if state.label], [QUANTITIES[name] for name in USUAL]
    for one in drawn:
        data = png(figures.panels(key, scene, one))
        yield _image(f"strip-{one.name}.png", f"Key moments: {one.plain}", data)
    for one in drawn[:2]:
        data = png(figures.section(key[-1], scene, looks(key[-1:], scene, one)))
        yield _image(
            f"section-{one.name}.png", f"At {key[-1].label}, and close to the edge: {one.plain}", data
        )
    first, early = drawn[0], key[min(1, len(key) - 1)]
    data = png(figures.body(early, scene, looks([early], scene, first)[0]))
    yield _image("revolution.png", f"In three dimensions: {first.plain}", data)
    progress(0.3)
    data = figures.film(states, trace, scene, first, lambda done: progress(0.3 + 0.7 * done))
    yield _image("cycle.gif", f"The whole cycle: {first.plain}", data)


def _image(name: str, caption: str, data: bytes) -> doc.Figure:
    file = f"fields-{name}"
    return doc.Figure(file.partition(".")[0], caption, data, wide=True, files={file: data})


def _energies(state: FieldState, trace: Trace) -> tuple[str, ...]:
    """Label, time, penetration, force, contact radius; energy lost by the fields and by the trace."""
    sums = balance(state, trace)
    values = (state.time, state.penetration, state.force, state.contact_radius)
    return (state.label, *map(doc.number, (*values, sums.dissipated, sums.branch_dissipation)))
