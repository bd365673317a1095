"""Fields along the cycle of Fig. 3, for a report: surfaces by two solvers, key moments, whole cycle.

The surfaces are those of runs that exist already; the fields take a finite-element run of their own, which
keeps its history.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_scene import Scene, Trace
from validation.cases import Case, load
from validation.drawing.export import png
from validation.fields.balance import balance
from validation.fields.figures import animation, fig3, moment_panels, revolution
from validation.fields.figures.figure_set import FigureSet
from validation.fields.figures.quantities import QUANTITIES
from validation.fields.figures.rendering import NoRendering
from validation.fields.figures.single_section import single_section
from validation.fields.request import FieldRequest, record_fields
from validation.measure.approach import end_of_approach
from validation.runs.run import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_solver import FieldState

SCENE = "cycle-v0.002"
DRAWN = ("von_mises", "stress_zz", "dissipation_rate")
"""Quantities; sections at the largest tension show the first two, the animation the first."""
FRAMES = 40
"""Of the animation."""


@dataclass(frozen=True)
class Image:
    """A PNG or GIF file; ``name`` is its file name."""

    name: str
    caption: str
    data: bytes


@dataclass(frozen=True)
class CycleFields:
    """Figure of the surfaces, images of fields, the energies at the key moments as text.

    ``surfaces`` is ``None`` if a run is missing; ``failure`` says why images are missing.
    """

    surfaces: Figure | None
    images: tuple[Image, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    failure: str = ""


def compute(runs: Mapping[str, Run], progress: Callable[[float], None] = lambda done: None) -> CycleFields:
    """Run the finite elements once more and draw; a machine that cannot draw is no error.

    ``runs`` are those on ``SCENE`` by solver, or none.
    """
    case = load(SCENE)
    surfaces = surface_figure(runs, case)
    figures = FigureSet(DRAWN, moments=True, animate=True, frames=FRAMES)
    recorded = record_fields(
        case.scene, FieldRequest(picked=figures.rows), None, lambda done: progress(0.2 * done)
    )
    states, trace = list(recorded.states()), recorded.recording.trace
    progress(0.4)
    rows = tuple(_energies(state, trace) for state in states if state.label)
    try:
        images = draw(states, trace, case.scene, lambda done: progress(0.4 + 0.6 * done))
    except NoRendering as error:
        return CycleFields(surfaces, (), rows, str(error))
    return CycleFields(surfaces, tuple(images), rows)


def surface_figure(runs: Mapping[str, Run], case: Case) -> Figure | None:
    """Fig. 3 from boundary and finite elements; ``None`` if a run or a surface is missing."""
    traces = [run.trace for name in fig3.TWO_SOLVERS if (run := runs.get(name)) and run.trace is not None]
    surfaces = [sorted(trace.profiles, key=lambda one: one.time) for trace in traces]
    if len(traces) != 2 or {len(one) for one in surfaces} != {len(case.profile_times)}:
        return None
    turn = float(traces[0].time[end_of_approach(traces[0])])
    return fig3.figure(case.scene, surfaces[0], surfaces[1], turn)


def draw(
    states: Sequence[FieldState], trace: Trace, scene: Scene, progress: Callable[[float], None]
) -> list[Image]:
    """Draw the key moments, sections at the largest tension, the body of revolution and the animation.

    Parameters
    ----------
    states : sequence of FieldState
        In order of time; those with a label are the key moments.
    trace : Trace
    scene : Scene
    progress : callable(float)

    Returns
    -------
    list of Image

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    key = [state for state in states if state.label]
    last, first = key[-1], QUANTITIES[DRAWN[0]]
    images = []
    for name in DRAWN:
        data = png(moment_panels.figure(key, scene, QUANTITIES[name]))
        images.append(Image(f"fields-strip-{name}.png", f"Key moments: {QUANTITIES[name].plain}", data))
    for name in DRAWN[:2]:
        data = png(single_section(last, scene, QUANTITIES[name]))
        caption = f"At {last.label}, and close to the edge: {QUANTITIES[name].plain}"
        images.append(Image(f"fields-section-{name}.png", caption, data))
    body = png(revolution.figure(key[min(1, len(key) - 1)], scene, first))
    images.append(Image("fields-revolution.png", f"In three dimensions: {first.plain}", body))
    progress(0.3)
    cycle = animation.film(states, trace, scene, first, lambda done: progress(0.3 + 0.7 * done))
    images.append(Image("fields-cycle.gif", f"The whole cycle: {first.plain}", cycle))
    return images


def _energies(state: FieldState, trace: Trace) -> tuple[str, ...]:
    """Label, time, penetration, force, contact radius; energy lost by the fields and by the trace."""
    sums = balance(state, trace)
    values = (state.time, state.penetration, state.force, state.contact_radius)
    lost = (sums.dissipated, sums.branch_dissipation)
    return (state.label, *("–" if value is None else f"{value:.6g}" for value in (*values, *lost)))
