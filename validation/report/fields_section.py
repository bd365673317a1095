"""Fields under the surface in the report, where asked for: Fig. 3 of both solvers, key moments, whole cycle.

They belong to one built-in scene, the cycle of Fig. 3. The surfaces are those of the runs in the report; the
fields take a finite-element run of their own, which keeps its history.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from validation.drawing import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contact_scene import Scene, Trace
    from fem_solver import FieldState
    from validation.compare.suite import SceneComparison

SCENE = "cycle-v0.002"
TITLE = "Under the surface"
FIG3 = "Fig. 3: surface and pressure (insets) along the cycle; below, pressure of either way, and the crack"
STRIPS = ("von-mises", "stress-zz", "dissipation-rate")
FRAMES = 40
EXPLAINED = (
    "Fields of the finite elements on a section through the axis, in units of the scene. Colours cover "
    "99 % of the area in view (rates: 99.9 %); an arrow on the bar says that values go on, as they do at a "
    "sharp contact edge."
)


@dataclass(frozen=True)
class Picture:
    """A picture ready to be shown; ``name`` is a file name."""

    name: str
    caption: str
    data: bytes

    @property
    def html(self) -> str:
        """An image that is part of the page."""
        kind = "gif" if self.name.endswith(".gif") else "png"
        content = base64.b64encode(self.data).decode("ascii")
        said = escape(self.caption)
        image = f'<div class="wide"><img src="data:image/{kind};base64,{content}" alt="{said}"></div>'
        return f'<figure class="whole">{image}<figcaption>{said}</figcaption></figure>'


@dataclass(frozen=True)
class FieldsSection:
    """What the section shows; ``failure`` says why pictures are missing."""

    fig3: Figure | None
    pictures: tuple[Picture, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    failure: str = ""


LOST = "Energy lost in the branches: densities summed over the body, and the trace's own"
HEAD = ("moment", "time", "penetration", "force", "contact radius", "lost in the body", "in the trace")


def compute(
    pages: list[SceneComparison], progress: Callable[[float], None] = lambda done: None
) -> FieldsSection:
    """Run the finite elements once more and draw; never raises for a machine that cannot draw."""
    from validation.cases import load
    from validation.fields.balance import balance
    from validation.fields.figures.album import Album
    from validation.fields.figures.window import NoRendering
    from validation.fields.request import Request, answer

    case = load(SCENE)
    drawn = fig3([page for page in pages if page.case.name == SCENE], case.scene)
    album = Album(STRIPS, strip=True, animate=True, frames=FRAMES)
    found = answer(case.scene, Request(picked=album.rows), None, lambda done: progress(0.2 * done))
    states = list(found.states())
    progress(0.4)
    trace = found.recording.trace
    named = [state for state in states if state.label]
    rows = []
    for state in named:
        sums = balance(state, trace)
        values = (state.time, state.penetration, state.force, state.contact_radius)
        lost = (sums.dissipated, sums.branch_dissipation)
        rows.append((state.label, *(f"{value:.6g}" for value in (*values, *lost))))
    try:
        pictures = draw(states, trace, case.scene, lambda done: progress(0.4 + 0.6 * done))
    except NoRendering as error:
        return FieldsSection(drawn, (), tuple(rows), str(error))
    return FieldsSection(drawn, tuple(pictures), tuple(rows))


def fig3(pages: list[SceneComparison], scene: Scene) -> Figure | None:
    """Fig. 3 from the runs of a report; ``None`` if one of them is missing."""
    from validation.fields.figures import fig3
    from validation.measure.observables import end_of_approach

    for page in pages:
        traces = [run.trace for name in ("bem", "fem") if (run := page.runs[name]).trace is not None]
        surfaces = [sorted(trace.profiles, key=lambda one: one.time) for trace in traces]
        if len(traces) == 2 and len(surfaces[0]) == len(surfaces[1]) == len(page.case.profile_times):
            turn = float(traces[0].time[end_of_approach(traces[0])])
            return fig3.figure(scene, surfaces[0], surfaces[1], turn)
    return None


def draw(
    states: list[FieldState], trace: Trace, scene: Scene, progress: Callable[[float], None]
) -> list[Picture]:
    """Strips, sections at the largest tension, the body in three dimensions, the animation."""
    from validation.fields.figures import album, animation, revolution, strip
    from validation.fields.figures.quantities import QUANTITIES

    named = [state for state in states if state.label]
    first = QUANTITIES[STRIPS[0]]
    made = []
    for name in STRIPS:
        quantity = QUANTITIES[name]
        drawn = figures.png(strip.figure(named, scene, quantity))
        made.append(Picture(f"fields-strip-{name}.png", f"Key moments: {quantity.plain}", drawn))
    last = named[-1]
    for name in STRIPS[:2]:
        drawn = figures.png(album.one_section(last, scene, QUANTITIES[name]))
        caption = f"At {last.label}, and close to the edge: {QUANTITIES[name].plain}"
        made.append(Picture(f"fields-section-{name}.png", caption, drawn))
    turned = figures.png(revolution.figure(named[min(1, len(named) - 1)], scene, first))
    made.append(Picture("fields-revolution.png", f"In three dimensions: {first.plain}", turned))
    progress(0.3)
    moving = animation.film(states, trace, scene, first, lambda done: progress(0.3 + 0.7 * done))
    made.append(Picture("fields-cycle.gif", f"The whole cycle: {first.plain}", moving))
    return made


def html(section: FieldsSection) -> str:
    """Section of the page."""
    from validation.report.html import table

    first = "<p>No Fig. 3: a run is missing.</p>"
    if section.fig3 is not None:
        drawn = figures.svg(section.fig3, "fields-fig3", escape(FIG3))
        first = f'<figure class="whole">{drawn}<figcaption>{escape(FIG3)}</figcaption></figure>'
    missing = (
        f'<p class="fail">No pictures of fields: {escape(section.failure)}</p>' if section.failure else ""
    )
    shown = "\n".join(picture.html for picture in section.pictures)
    rows = [tuple(map(escape, row)) for row in section.rows]
    return (
        f'<section id="fields"><h2>{TITLE}</h2><p>{escape(EXPLAINED)}</p>{missing}'
        f'<div class="figures">{first}{shown}</div><h3>{LOST}</h3>{table(HEAD, rows)}</section>'
    )


def files(section: FieldsSection) -> dict[str, bytes]:
    """The same pictures by file name."""
    found = {picture.name: picture.data for picture in section.pictures}
    return found if section.fig3 is None else {"fields-fig3.png": figures.png(section.fig3)} | found
