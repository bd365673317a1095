"""A whole cycle as an animated GIF: the section, and where on the force curve it stands.

Pillow writes the file; it comes with matplotlib, so that no video library is needed. All frames share view,
magnification and colours, and one table of 256 colours made for them, so that nothing flickers.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene, Trace
from validation.drawing.styles import APPROACH, RETRACTION
from validation.fields.figures import sections
from validation.fields.figures.colours import ColourRange
from validation.fields.figures.geometry import BodySection, View
from validation.fields.figures.moment_panels import caption, sections_alike
from validation.fields.figures.quantities import Quantity
from validation.fields.figures.sections import INDENTER, LENGTH_UNIT, MARK, SMALL, ZONE
from validation.measure.approach import end_of_approach

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL.Image import Image

    from fem_solver.fields.states import FieldState

FRAME, LAST = 120, 1500
"""Durations of a frame and of the last one, milliseconds."""
DOTS = 90
"""Resolution of a frame, dots per inch."""


def film(
    states: Sequence[FieldState],
    trace: Trace,
    scene: Scene,
    quantity: Quantity,
    progress: Callable[[float], None] = lambda done: None,
) -> bytes:
    """Draw all states as an animation.

    Parameters
    ----------
    states : sequence of FieldState
        In order of time.
    trace : Trace
    scene : Scene
    quantity : Quantity
    progress : callable(float)

    Returns
    -------
    bytes
        A GIF file.

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    from PIL import Image as New

    pictures: list[Image] = []
    for count, figure in enumerate(frames(states, trace, scene, quantity), 1):
        pictures.append(New.open(io.BytesIO(_png(figure))).convert("RGB"))
        progress(count / len(states))
    table = palette(quantity.kind.value)
    flat = [picture.quantize(palette=table, dither=New.Dither.NONE) for picture in pictures]
    stream = io.BytesIO()
    durations = [FRAME] * (len(flat) - 1) + [LAST]
    flat[0].save(stream, format="GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0)
    return stream.getvalue()


def frames(states: Sequence[FieldState], trace: Trace, scene: Scene, quantity: Quantity) -> Iterator[Figure]:
    """One figure a state.

    Parameters
    ----------
    states, trace, scene, quantity
        As of :func:`film`.

    Yields
    ------
    Figure
    """
    cut, view, colour_range = sections_alike(states, scene, quantity)
    return (_frame(section, view, quantity, colour_range, trace) for section in cut)


def _frame(
    section: BodySection, view: View, quantity: Quantity, colour_range: ColourRange, trace: Trace
) -> Figure:
    """The section of one state, and where on the force curve it stands.

    Parameters
    ----------
    section : BodySection
    view : View
    quantity : Quantity
    colour_range : ColourRange
    trace : Trace

    Returns
    -------
    Figure
    """
    from matplotlib.figure import Figure as New

    frame = New(figsize=(9.6, 3.7), layout="constrained")
    engine: Any = frame.get_layout_engine()
    engine.set(w_pad=0.1)  # inches, between the colour bar and the curve
    left, right = frame.subplots(1, 2, width_ratios=(2.3, 1.0))
    sections.draw(left, section, view, quantity, colour_range)
    left.set_title(
        f"{caption(section.state)}\ndisplacements {sections.times(section.scale)}", fontsize=SMALL + 1
    )
    left.set_xlabel(f"r, mirrored {LENGTH_UNIT}", fontsize=SMALL + 1)
    left.set_ylabel(f"z {LENGTH_UNIT}", fontsize=SMALL + 1)
    sections.key(left, section)
    sections.bar(frame, [left], quantity, colour_range, shrink=0.8)
    _curve(right, trace, end_of_approach(trace), section.state)
    return frame


def _png(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DOTS, facecolor="white")
    return stream.getvalue()


def _curve(axes: Axes, trace: Trace, turn: int, state: FieldState) -> None:
    """Force over penetration, the state marked on it."""
    rows = slice(None, len(trace) - int(trace.contact_radius[-1] == 0.0))
    depth, force = trace.penetration[rows], trace.force[rows]
    axes.plot(depth[: turn + 1], force[: turn + 1], "--", color=APPROACH, linewidth=1.2, label="approach")
    axes.plot(depth[turn:], force[turn:], color=RETRACTION, linewidth=1.2, label="retraction")
    axes.axhline(0.0, color=MARK, linewidth=0.5)
    axes.plot(state.penetration, state.force, "o", color=MARK, markersize=6, gid="state")
    axes.set_xlabel("penetration (length)", fontsize=SMALL + 1)
    axes.set_ylabel("force (scene units of force)", fontsize=SMALL + 1)
    axes.tick_params(labelsize=SMALL)
    axes.ticklabel_format(style="sci", scilimits=(-2, 3), useOffset=False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.get_offset_text().set_fontsize(SMALL)
    axes.legend(loc="upper left", frameon=False, fontsize=SMALL)


def palette(name: str) -> Image:
    """The table of 256 colours: those of a map, greys, and those of the lines towards white."""
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb
    from PIL import Image as New

    greys = np.linspace(0.0, 1.0, 28)[:, None].repeat(3, axis=1)
    pale = np.linspace(0.0, 0.75, 8)[:, None]
    lines = [np.array(to_rgb(c)) * (1.0 - pale) + pale for c in (ZONE, APPROACH, RETRACTION)]
    fixed = np.vstack([greys, *lines, [to_rgb(INDENTER)]])
    field = colormaps[name](np.linspace(0.0, 1.0, 256 - len(fixed)))[:, :3]
    table = New.new("P", (1, 1))
    table.putpalette(np.rint(255.0 * np.vstack([field, fixed])).astype(np.uint8).ravel().tolist())
    return table
