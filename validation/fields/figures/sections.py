"""A field on a section through the axis: drawn by PyVista, framed and labelled by matplotlib.

Field, indenter, contact edge and process zone are those of :mod:`geometry`; the colours of a picture and of
its colour bar come from one table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from validation.fields.figures import rendering
from validation.fields.figures.colours import ColourRange, ValueKind, colours
from validation.fields.figures.geometry import BodySection, View, near_edge, whole
from validation.fields.figures.quantities import Quantity

if TYPE_CHECKING:
    import pyvista
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

PIXELS = 900
"""Width of a rendered picture."""
INDENTER, MARK, ZONE = "#c9ccd1", "#000000", "#e6007e"
LENGTH_UNIT = "(scene units of length)"
SMALL = 8.0
"""Size of the smallest text, points."""


@dataclass(frozen=True)
class Alike:
    """What sections of several states have in common.

    Parameters
    ----------
    scale, edge_scale : float
        Magnification of displacements, and that close to the edge.
    view : View
        Of the contact as a whole.
    colours, edge_colours : ColourRange
        In that view, and close to the edge.
    """

    scale: float
    edge_scale: float
    view: View
    colours: ColourRange
    edge_colours: ColourRange


def shared_colours(quantity: Quantity, sections: list[BodySection], views: list[View]) -> ColourRange:
    """One range of colours for all sections, from the values in view."""
    values, weights = [], []
    for section, view in zip(sections, views, strict=True):
        in_view = section.within(view)
        values.append(quantity.values(section.state)[in_view])
        weights.append(section.areas[in_view])
    return colours(quantity.kind, values, weights)


def figure(
    section: BodySection,
    at_edge: BodySection,
    quantity: Quantity,
    zone: float,
    title: str,
    common: Alike | None = None,
) -> Figure:
    """The contact as a whole, and beside it its right-hand edge with colours of its own.

    Parameters
    ----------
    section, at_edge : BodySection
        The same state, displacements magnified for each of the two views.
    quantity : Quantity
    zone : float
        Process-zone length, or the length that takes its place; the width of the second view follows it.
    title : str
    common : Alike or None
        View and colours of all sections of a run; ``None``: of this one.

    Returns
    -------
    Figure

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    from matplotlib.figure import Figure as New

    pair = (section, at_edge)
    first = whole(section.state.contact_radius) if common is None else common.view
    views = [first, near_edge(at_edge, zone)]
    ranges = [shared_colours(quantity, [one], [view]) for one, view in zip(pair, views, strict=True)]
    if common is not None:
        ranges = [common.colours, common.edge_colours]
    panel_figure = New(figsize=(10.6, 3.9), layout="compressed")
    panels = panel_figure.subplots(1, 2, width_ratios=(views[0].aspect, views[1].aspect))
    for axes, one, view, colour_range in zip(panels, pair, views, ranges, strict=True):
        draw(axes, one, view, quantity, colour_range)
        axes.set_xlabel(f"r, mirrored {LENGTH_UNIT}", fontsize=SMALL + 1)
        bar(panel_figure, [axes], quantity, colour_range, label=axes is panels[1])
    panels[0].set_ylabel(f"z {LENGTH_UNIT}", fontsize=SMALL + 1)
    panels[0].set_title(f"{title}\ndisplacements {times(section.scale)}", fontsize=SMALL + 1)
    panels[1].set_title(f"at the contact edge\n{times(at_edge.scale)}", fontsize=SMALL + 1)
    panels[0].add_patch(_frame(near_edge(section, zone)))
    key(panels[0], section)
    return panel_figure


def draw(axes: Axes, section: BodySection, view: View, quantity: Quantity, colour_range: ColourRange) -> None:
    """Draw field, indenter, surface and marks of one view.

    Parameters
    ----------
    axes : Axes
    section : BodySection
    view : View
    quantity : Quantity
    colour_range : ColourRange

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    size = (PIXELS, max(2, round(PIXELS / view.aspect)))
    image = rendering.picture(lambda plotter: add_field(plotter, section, view, quantity, colour_range), size)
    axes.imshow(image, extent=view.extent, aspect="equal", interpolation="lanczos", zorder=0)
    body, surface = both_sides(section.indenter), both_sides(section.surface)
    ceiling = max(view.top, float(body[:, 1].max()))
    axes.fill_between(body[:, 0], body[:, 1], ceiling, color=INDENTER, linewidth=0.0, zorder=2)
    axes.plot(*body.T, color=MARK, linewidth=0.8, zorder=3, gid="indenter")
    axes.plot(*surface.T, color=MARK, linewidth=0.8, zorder=3, gid="surface")
    for mirror in np.array([[1.0, 1.0], [-1.0, 1.0]]):
        if section.zone.size:
            line = section.zone * mirror
            axes.plot(*line.T, color=ZONE, linewidth=2.5, zorder=4, solid_capstyle="butt", gid="zone")
        edge = section.edge * mirror
        axes.plot(*edge, "v", color=MARK, markersize=5, zorder=5, gid="edge")
    axes.set(xlim=(view.left, view.right), ylim=(view.bottom, view.top))
    axes.tick_params(labelsize=SMALL)
    axes.ticklabel_format(style="sci", scilimits=(-3, 4), useOffset=False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.get_offset_text().set_fontsize(SMALL)


def key(axes: Axes, section: BodySection) -> None:
    """What the marks mean, in a corner of the body."""
    axes.plot([], [], "v", color=MARK, markersize=5, label="contact edge")
    if section.zone.size:
        axes.plot([], [], color=ZONE, linewidth=2.5, label="process zone")
    legend = axes.legend(loc="lower left", fontsize=SMALL, framealpha=0.85, edgecolor="none", ncols=2)
    legend.set_zorder(6)


def times(scale: float) -> str:
    """A magnification in words."""
    return "true to scale" if scale == 1.0 else f"drawn {scale:g} times as large"


def bar(
    figure: Figure,
    panels: list[Axes],
    quantity: Quantity,
    colour_range: ColourRange,
    label: bool = True,
    **options: Any,
) -> None:
    """A colour bar next to the panels.

    Parameters
    ----------
    figure : Figure
    panels : list of Axes
    quantity : Quantity
    colour_range : ColourRange
    label : bool
        Whether name and unit stand at the bar.
    **options
        Of ``Figure.colorbar``.
    """
    from matplotlib.cm import ScalarMappable

    table = ScalarMappable(colour_range.norm, colour_range.map)
    colour_bar: Any = figure.colorbar(
        table, ax=panels, extend=colour_range.extend, **({"pad": 0.02} | options)
    )
    if label:
        colour_bar.set_label(quantity.label, fontsize=SMALL + 1)
    colour_bar.ax.tick_params(labelsize=SMALL)
    if quantity.kind is not ValueKind.DECADES:
        colour_bar.formatter.set_powerlimits((-2, 3))
        colour_bar.ax.yaxis.get_offset_text().set_fontsize(SMALL)


def add_field(
    plotter: Any, section: BodySection, view: View, quantity: Quantity, colour_range: ColourRange
) -> None:
    """Put the coloured body into a window, the camera on the view.

    Parameters
    ----------
    plotter : pyvista.Plotter
    section : BodySection
    view : View
    quantity : Quantity
    colour_range : ColourRange
    """
    plotter.add_mesh(
        mirrored(section, quantity, colour_range),
        scalars="shade",
        cmap=colour_range.map,
        clim=(0.0, 1.0),
        lighting=False,
        show_scalar_bar=False,
        name="body",
    )
    middle = np.array([0.5 * (view.left + view.right), 0.5 * (view.bottom + view.top)])
    height = view.top - view.bottom
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point = (*middle, 0.0)
    camera.position = (*middle, 10.0 * height)
    camera.up = (0.0, 1.0, 0.0)
    camera.parallel_scale = 0.5 * height
    plotter.reset_camera_clipping_range()


def mirrored(section: BodySection, quantity: Quantity, colour_range: ColourRange) -> pyvista.PolyData:
    """The deformed body on both sides of the axis, with the field (``quantity.name``) and its ``shade``."""
    import pyvista

    count = len(section.moved)
    points = np.zeros((2 * count, 3))
    points[:count, :2] = section.moved
    points[count:, :2] = section.moved * (-1.0, 1.0)
    faces = np.vstack([section.state.triangles, section.state.triangles[:, ::-1] + count])
    mesh = pyvista.PolyData.from_regular_faces(points, faces)
    values = np.tile(quantity.values(section.state), 2)
    mesh.point_data[quantity.name] = values
    mesh.point_data["shade"] = colour_range.shade(values)
    return mesh


def both_sides(line: Array) -> Array:
    """A line from the axis outwards, with its mirror image before it; shape (2 k - 1, 2)."""
    return np.vstack([line[:0:-1] * (-1.0, 1.0), line])


def _frame(view: View) -> Any:
    from matplotlib.patches import Rectangle

    size = view.right - view.left, view.top - view.bottom
    return Rectangle((view.left, view.bottom), *size, fill=False, edgecolor=MARK, linewidth=0.7, zorder=6)
