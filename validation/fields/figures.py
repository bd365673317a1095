"""Figures of fields: PyVista draws the body, Matplotlib what is around it; which of them a run gets.

A folder holds ``sections/QUANTITY_NNNNNN.png``, one a state, ``strip_QUANTITY.png``, the key moments,
``cycle_QUANTITY.gif``, the whole run, and ``revolution_QUANTITY_NNNNNN.png``, the body in three dimensions.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene, Trace
from validation.drawing.figure import APPROACH, RETRACTION, drawing, png
from validation.fields import rendering
from validation.fields.moments import in_contact, key_moments
from validation.fields.quantities import QUANTITIES, Quantity, ValueKind
from validation.fields.rendering import INDENTER, MARK, ZONE, NoRendering
from validation.fields.section import AxialSection, Look, look_at, looks
from validation.measure.events import end_of_approach
from validation.measure.scaling import unit_name
from validation.runs.folder import in_words, write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL.Image import Image

    from fem_solver import FieldState

USUAL = ("von_mises", "stress_zz", "dissipation_rate")
"""Quantities drawn where none is named."""
FRAMES = 60
"""Of an animation."""
FRAME, LAST = 120, 1500
"""Durations of a frame of it and of the last one, milliseconds."""
DOTS = 90
"""Resolution of a frame, dots per inch."""
PIXELS, BODY_PIXELS = 900, (1200, 840)
"""Width of a rendered section; width and height of a body of revolution."""
SMALL = 8.0
"""Size of the smallest text, points; that of axes and titles is larger by one."""
Progress = Callable[[float], None]


def draw(axes: Axes, cut: AxialSection, look: Look) -> None:
    """Draw field, indenter, surface and marks of a section."""
    view = look.view(cut)
    size = (PIXELS, max(2, round(PIXELS / view.aspect)))
    image = rendering.picture(lambda plotter: rendering.add_section(plotter, cut, look), size)
    extent = view.left, view.right, view.bottom, view.top
    axes.imshow(image, extent=extent, aspect="equal", interpolation="lanczos", zorder=0)
    body, surface = _both_sides(cut.indenter), _both_sides(cut.surface)
    ceiling = max(view.top, float(body[:, 1].max()))
    axes.fill_between(body[:, 0], body[:, 1], ceiling, color=INDENTER, linewidth=0.0, zorder=2)
    axes.plot(*body.T, color=MARK, linewidth=0.8, zorder=3, gid="indenter")
    axes.plot(*surface.T, color=MARK, linewidth=0.8, zorder=3, gid="surface")
    if cut.thickness < -view.bottom:
        axes.axhspan(view.bottom, -cut.thickness, color=INDENTER, linewidth=0.0, zorder=2)
        axes.axhline(-cut.thickness, color=MARK, linewidth=0.8, zorder=3, gid="base")
    for mirror in np.array([[1.0, 1.0], [-1.0, 1.0]]):
        if cut.zone.size:
            line = cut.zone * mirror
            axes.plot(*line.T, color=ZONE, linewidth=2.5, zorder=4, solid_capstyle="butt", gid="zone")
        axes.plot(*cut.edge * mirror, "v", color=MARK, markersize=5, zorder=5, gid="edge")
    axes.set(xlim=(view.left, view.right), ylim=(view.bottom, view.top))
    axes.set_xlabel(f"r, mirrored ({unit_name(cut.scene, 'penetration')})", fontsize=SMALL + 1)
    axes.set_ylabel(f"z ({unit_name(cut.scene, 'penetration')})", fontsize=SMALL + 1)
    _number(axes, (-3, 4))


def _both_sides(line: Any) -> Any:
    """A line from the axis outwards, with its mirror image before it; shape (2 k - 1, 2)."""
    return np.vstack([line[:0:-1] * (-1.0, 1.0), line])


def _number(axes: Axes, powers: tuple[int, int]) -> None:
    axes.tick_params(labelsize=SMALL)
    axes.ticklabel_format(style="sci", scilimits=powers, useOffset=False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.get_offset_text().set_fontsize(SMALL)


def _key(axes: Axes, with_zone: bool, **place: Any) -> None:
    """What the marks mean, in a corner of the body."""
    edge: dict[str, Any] = {"marker": "v", "markersize": 5, "linestyle": "none"}
    axes.plot([], [], color=MARK, label="contact edge", **(edge if axes.axison else {"linewidth": 2.0}))
    if with_zone:
        axes.plot([], [], color=ZONE, linewidth=2.5, label="process zone")
    axes.legend(fontsize=SMALL, framealpha=0.85, edgecolor="none", **place).set_zorder(6)


def _bar(figure: Figure, panels: Sequence[Axes], look: Look, named: bool = True, **options: Any) -> None:
    """A colour bar next to the panels; ``named``: quantity and unit stand at it."""
    from matplotlib.cm import ScalarMappable

    table = ScalarMappable(look.colours.norm, look.colours.kind.value)
    options |= {"pad": 0.02, "extend": look.colours.extend}
    bar: Any = figure.colorbar(table, ax=list(panels), **options)
    if named:
        bar.set_label(look.quantity.label, fontsize=SMALL + 1)
    bar.ax.tick_params(labelsize=SMALL)
    if look.quantity.kind is not ValueKind.DECADES:
        bar.formatter.set_powerlimits((-2, 3))
        bar.ax.yaxis.get_offset_text().set_fontsize(SMALL)


def caption(state: FieldState) -> str:
    """A state in words: time, penetration, force, in the units of the scene."""
    name = f"{state.label}: " if state.label else ""
    text = f"{name}t = {state.time:.4g}, Δ = {state.penetration:.3g}, F = {state.force:.3g}"
    return text.replace("-0", "−0").replace("= -", "= −")


def _times(scale: float) -> str:
    """A magnification in words."""
    return "true to scale" if scale == 1.0 else f"drawn {scale:g} times as large"


def section(state: FieldState, scene: Scene, pair: tuple[Look, Look]) -> Figure:
    """The contact as a whole, and beside it its right-hand edge with colours of its own."""
    from matplotlib.patches import Rectangle

    cuts = [AxialSection(state, scene, look.scale) for look in pair]
    ratios = [look.view(cut).aspect for look, cut in zip(pair, cuts, strict=True)]
    figure, (left, right) = drawing((10.6, 3.9), 1, 2, layout="compressed", width_ratios=ratios)
    for axes, cut, look in zip((left, right), cuts, pair, strict=True):
        draw(axes, cut, look)
        _bar(figure, [axes], look, named=axes is right)
    right.set_ylabel("")
    left.set_title(f"{caption(state)}\ndisplacements {_times(cuts[0].scale)}", fontsize=SMALL + 1)
    right.set_title(f"at the contact edge\n{_times(cuts[1].scale)}", fontsize=SMALL + 1)
    close = pair[1].view(cuts[0])
    corner, width, height = (close.left, close.bottom), close.right - close.left, close.top - close.bottom
    left.add_patch(Rectangle(corner, width, height, fill=False, edgecolor=MARK, linewidth=0.7, zorder=6))
    _key(left, bool(cuts[0].zone.size), loc="lower left", ncols=2)
    return figure


def panels(states: Sequence[FieldState], scene: Scene, quantity: Quantity) -> Figure:
    """A field at several moments, two in a row: same view, same colours, same magnification."""
    look, rows = look_at(states, scene, quantity), (len(states) + 1) // 2
    shared: dict[str, Any] = {"sharex": True, "sharey": True, "squeeze": False}
    figure, grid = drawing((10.0, 0.6 + 2.85 * rows), rows, 2, layout="compressed", **shared)
    for axes, state in zip(grid.flat, states, strict=False):
        draw(axes, AxialSection(state, scene, look.scale), look)
        axes.label_outer()
        axes.set_title(caption(state), fontsize=SMALL + 1)
    for axes in grid.flat[len(states) :]:
        axes.set_axis_off()
    _key(grid[0, 0], scene.is_adhesive, loc="lower left", ncols=2)
    figure.suptitle(f"displacements {_times(look.scale)}", fontsize=SMALL + 1)
    _bar(figure, list(grid.flat), look)
    return figure


def body(state: FieldState, scene: Scene, look: Look) -> Figure:
    """The body of revolution seen from above, with colour bar and caption."""
    cut = AxialSection(state, scene, look.scale)
    figure, axes = drawing((8.0, 5.0))
    axes.imshow(rendering.picture(lambda plotter: rendering.add_body(plotter, cut, look), BODY_PIXELS))
    axes.set_axis_off()
    axes.set_title(f"{caption(state)}\ndisplacements {_times(cut.scale)}", fontsize=SMALL + 1)
    _key(axes, bool(cut.zone.size), loc="upper left")
    _bar(figure, [axes], look, shrink=0.8)
    return figure


def interactive(state: FieldState, scene: Scene, quantity: Quantity) -> bool:
    """Open a window with the same; return whether there is a screen to open it on."""
    look = look_at([state], scene, quantity)

    def fill(plotter: Any) -> None:
        rendering.add_body(plotter, AxialSection(state, scene, look.scale), look)
        plotter.add_text(f"{caption(state)}\n{quantity.plain}", font_size=9, color="black")
        plotter.add_axes(color="black")

    return rendering.show(fill, f"crosscontact: {quantity.plain}")


def frames(states: Sequence[FieldState], trace: Trace, scene: Scene, quantity: Quantity) -> Iterator[Figure]:
    """The section of each state, and beside it where on the force curve it stands."""
    look, turn = look_at(states, scene, quantity), end_of_approach(trace)
    rows = slice(None, len(trace) - int(trace.contact_radius[-1] == 0.0))
    depth, force = trace.penetration[rows], trace.force[rows]
    for state in states:
        figure, (left, right) = drawing((9.6, 3.7), 1, 2, width_ratios=(2.3, 1.0))
        engine: Any = figure.get_layout_engine()
        engine.set(w_pad=0.1)  # inches, between the colour bar and the curve
        cut = AxialSection(state, scene, look.scale)
        draw(left, cut, look)
        left.set_title(f"{caption(state)}\ndisplacements {_times(look.scale)}", fontsize=SMALL + 1)
        _key(left, bool(cut.zone.size), loc="lower left", ncols=2)
        _bar(figure, [left], look, shrink=0.8)
        style: dict[str, Any] = {"linewidth": 1.2}
        right.plot(depth[: turn + 1], force[: turn + 1], "--", color=APPROACH, label="approach", **style)
        right.plot(depth[turn:], force[turn:], color=RETRACTION, label="retraction", **style)
        right.axhline(0.0, color=MARK, linewidth=0.5)
        right.plot(state.penetration, state.force, "o", color=MARK, markersize=6, gid="state")
        right.set_xlabel(f"penetration ({unit_name(scene, 'penetration')})", fontsize=SMALL + 1)
        right.set_ylabel(f"force ({unit_name(scene, 'force')})", fontsize=SMALL + 1)
        _number(right, (-2, 3))
        right.legend(loc="upper left", frameon=False, fontsize=SMALL)
        yield figure


def film(
    states: Sequence[FieldState],
    trace: Trace,
    scene: Scene,
    quantity: Quantity,
    progress: Progress = lambda done: None,
) -> bytes:
    """All states as an animated GIF.

    Pillow writes it, so that no video library is needed. All frames share one table of 256 colours made for
    them, so that nothing flickers.
    """
    from PIL import Image as New

    pictures: list[Image] = []
    for count, figure in enumerate(frames(states, trace, scene, quantity), 1):
        pictures.append(New.open(io.BytesIO(png(figure, DOTS))).convert("RGB"))
        progress(count / len(states))
    table = _palette(quantity.kind.value)
    flat = [picture.quantize(palette=table, dither=New.Dither.NONE) for picture in pictures]
    stream = io.BytesIO()
    durations = [FRAME] * (len(flat) - 1) + [LAST]
    flat[0].save(stream, format="GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0)
    return stream.getvalue()


def _palette(name: str) -> Image:
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


@dataclass(frozen=True)
class FigureSet:
    """What is to be drawn of a run.

    ``quantities`` are names in ``QUANTITIES``; animation, body of revolution and window show the first.
    ``moments``: the key moments side by side; ``animate``: the whole run in so many ``frames``; ``revolve``:
    the body in three dimensions, of every state that gets a section; ``show``: the last state in a window,
    where there is a screen; ``alike``: one look for all sections and bodies of revolution of the run.
    """

    quantities: tuple[str, ...] = USUAL
    moments: bool = False
    animate: bool = False
    revolve: bool = False
    show: bool = False
    alike: bool = False
    frames: int = FRAMES

    @property
    def chooses_moments(self) -> bool:
        """Whether the figures choose moments of their own."""
        return self.moments or self.animate

    def rows(self, trace: Trace, scene: Scene) -> dict[int, str]:
        """Rows of a trace whose fields the figures need, and their labels."""
        moving = dict.fromkeys(in_contact(trace, self.frames), "") if self.animate else {}
        key = key_moments(trace, scene) if self.moments else {}
        return dict(sorted((moving | key).items()))

    def draw(
        self,
        folder: Path,
        states: Sequence[FieldState],
        trace: Trace,
        scene: Scene,
        progress: Progress,
        requested: Collection[int] = (),
    ) -> list[str]:
        """Draw states in order of time; returns in words what was drawn, or why not.

        Rows ``requested`` get a section although the animation shows them. Raises :class:`NoRendering` if VTK
        cannot draw here, and more was requested than the sections drawn by default.
        """
        touching = [state for state in states if state.contact_radius > 0.0]
        moving = set(in_contact(trace, self.frames)) if self.animate else set()
        key = key_moments(trace, scene) if self.moments else {}
        quantities = [QUANTITIES[name] for name in self.quantities]
        first, frames = quantities[0], [state for state in touching if state.row in moving]
        drawings = self._sections(
            [one for one in touching if one.label or one.row in requested or one.row not in moving], scene
        )
        named = [state for state in touching if state.row in key]
        for one in quantities if named else ():
            drawings.append((f"strip_{one.name}.png", partial(panels, named, scene, one)))
        count, total, lines = 0, len(drawings) + len(frames), []

        def written(name: str, data: bytes) -> str:
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, data)
            return f"drawn: {path} ({in_words(len(data))})"

        try:
            for count, (name, drawn) in enumerate(drawings, 1):
                lines.append(written(name, png(drawn())))
                progress(count / total)
            if frames:
                rest: Progress = lambda done: progress((count + done * len(frames)) / total)  # noqa: E731
                lines.append(written(f"cycle_{first.name}.gif", film(frames, trace, scene, first, rest)))
            if self.show and touching and not interactive(touching[-1], scene, first):
                lines.append("no window: there is no screen")
        except NoRendering as error:
            if self.chooses_moments or self.revolve or self.show:
                raise
            return [f"no figures: {error}"]
        return lines

    def _sections(self, states: Sequence[FieldState], scene: Scene) -> list[tuple[str, Callable[[], Figure]]]:
        """Sections of states one by one, and bodies of revolution, by the names of their files."""
        quantities = [QUANTITIES[name] for name in self.quantities]
        common = {one: looks(states, scene, one) for one in quantities} if self.alike and states else {}
        drawings: list[tuple[str, Callable[[], Figure]]] = []
        for state in states:
            for one in quantities:
                pair = common.get(one) or looks([state], scene, one)
                name = f"{one.name}_{state.row:06d}.png"
                drawings.append((f"sections/{name}", partial(section, state, scene, pair)))
                if self.revolve and one is quantities[0]:
                    drawings.append((f"revolution/{name}", partial(body, state, scene, pair[0])))
        return drawings
