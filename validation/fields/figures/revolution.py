"""The body in three dimensions: its section turned about the axis, a quarter left out to look inside.

The surface and both cut faces carry the field, the indenter stands above. Heights and displacements are
those of :mod:`geometry`; x and y span the surface, z points upwards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from contact_scene import Scene
from validation.fields.figures import rendering, sections
from validation.fields.figures.colours import ColourRange
from validation.fields.figures.geometry import BodySection, View, magnification, section, whole
from validation.fields.figures.moment_panels import caption
from validation.fields.figures.quantities import Quantity
from validation.fields.figures.sections import INDENTER, MARK, SMALL, ZONE

if TYPE_CHECKING:
    import pyvista
    from matplotlib.figure import Figure

    from fem_solver.fields.states import FieldState

Array = NDArray[np.float64]

ANGLES = np.radians((-135.0, 135.0))
"""Of the two cut faces; the quarter around the direction of view is left out."""
PLANES = 73
"""Copies of the section about the axis, of which the surface of revolution is made."""
SIZE = (1200, 840)
"""Width and height of the rendered picture, pixels."""
VIEW_DIRECTION = (-1.0, 0.0, 0.55)


def figure(
    state: FieldState, scene: Scene, quantity: Quantity, common: sections.Alike | None = None
) -> Figure:
    """The body seen from above, with colour bar and caption.

    Parameters
    ----------
    state : FieldState
    scene : Scene
    quantity : Quantity
    common : Alike or None
        Magnification, view and colours of all pictures; ``None``: of its own.

    Returns
    -------
    Figure

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    from matplotlib.figure import Figure as New

    if common is None:
        cut, view, colour_range = prepared(state, scene, quantity)
    else:
        cut, view, colour_range = section(state, scene, common.scale), common.view, common.colours
    panel_figure = New(figsize=(8.0, 5.0), layout="constrained")
    axes = panel_figure.subplots()
    axes.imshow(rendering.picture(lambda plotter: add(plotter, cut, view, quantity, colour_range), SIZE))
    axes.set_axis_off()
    axes.set_title(f"{caption(state)}\ndisplacements {sections.times(cut.scale)}", fontsize=SMALL + 1)
    axes.plot([], [], color=MARK, linewidth=2.0, label="contact edge")
    if cut.zone.size:
        axes.plot([], [], color=ZONE, linewidth=3.0, label="process zone")
    axes.legend(loc="upper left", fontsize=SMALL, framealpha=0.85, edgecolor="none")
    sections.bar(panel_figure, [axes], quantity, colour_range, shrink=0.8)
    return panel_figure


def interactive(state: FieldState, scene: Scene, quantity: Quantity) -> bool:
    """Open a window with the same; return whether there is a screen to open it on."""
    cut, view, colour_range = prepared(state, scene, quantity)

    def fill(plotter: Any) -> None:
        add(plotter, cut, view, quantity, colour_range)
        plotter.add_text(f"{caption(state)}\n{quantity.plain}", font_size=9, color="black")
        plotter.add_axes(color="black")

    return rendering.show(fill, f"crosscontact: {quantity.plain}")


def prepared(state: FieldState, scene: Scene, quantity: Quantity) -> tuple[BodySection, View, ColourRange]:
    """The section, the part of it that is turned about the axis, and its colours."""
    view = whole(state.contact_radius)
    scale = magnification(float(np.abs(state.displacement).max()), state.contact_radius)
    cut = section(state, scene, scale)
    return cut, view, sections.shared_colours(quantity, [cut], [view])


def add(plotter: Any, cut: BodySection, view: View, quantity: Quantity, colour_range: ColourRange) -> None:
    """Put body, indenter and marks into a window, the camera on them.

    Parameters
    ----------
    plotter : pyvista.Plotter
    cut : BodySection
    view : View
        The part that is turned about the axis.
    quantity : Quantity
    colour_range : ColourRange
    """
    style: dict[str, Any] = {
        "scalars": "shade",
        "cmap": colour_range.map,
        "clim": (0.0, 1.0),
        "show_scalar_bar": False,
    }
    shade = colour_range.shade(quantity.values(cut.state))
    flat = half_section(cut, view, shade)
    for angle in ANGLES:
        plotter.add_mesh(standing(flat, angle), **style, lighting=False)
    for name, (points, shades) in (("top", top(cut, view, shade)), ("side", side(cut, view, shade))):
        skin = turned(points)
        skin.point_data["shade"] = np.tile(shades, PLANES)
        plotter.add_mesh(skin, **style, lighting=False, name=name)
    for line in outlines(cut, view):
        drawn = plotter.add_mesh(line, color=MARK, line_width=1.0, lighting=False)
        drawn.mapper.SetResolveCoincidentTopologyToPolygonOffset()  # before the faces they bound
        drawn.mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -4.0)
    beyond = np.vstack([cut.edge, cut.indenter[cut.indenter[:, 0] > cut.edge[0]]])
    body = beyond[(beyond[:, 0] <= view.right) & (beyond[:, 1] <= view.top)]
    plotter.add_mesh(turned(body), color=INDENTER, opacity=0.45, smooth_shading=True, name="indenter")
    lift = np.array([0.0, 2e-3 * view.right])  # so that the marks are not half sunk into the surface
    plotter.add_mesh(ring(cut.edge + lift), color=MARK, line_width=3.0, lighting=False, name="edge")
    if cut.zone.size:
        plotter.add_mesh(ring(cut.zone[-1] + lift), color=ZONE, line_width=3.0, lighting=False, name="zone")
    plotter.camera.parallel_projection = True
    plotter.view_vector(VIEW_DIRECTION, viewup=(0.0, 0.0, 1.0))
    plotter.camera.focal_point = (0.0, 0.0, 0.36 * view.bottom)
    plotter.camera.parallel_scale = 0.82 * view.right
    plotter.reset_camera_clipping_range()


def outlines(cut: BodySection, view: View) -> list[pyvista.PolyData]:
    """Edges of what is shown: around either cut face, and around the outer side."""
    import pyvista

    x, y = cut.surface.T
    across = np.append(x[x < view.right], view.right)
    skin = np.column_stack([across, np.interp(across, x, y)])
    around = np.vstack([skin, [view.right, view.bottom], [0.0, view.bottom]])
    faces = []
    for angle in ANGLES:
        r, z = around.T
        points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
        faces.append(pyvista.lines_from_points(points, close=True))
    return [*faces, ring(skin[-1]), ring(np.array([view.right, view.bottom]))]


def half_section(cut: BodySection, view: View, shade: Array) -> pyvista.PolyData:
    """The part of the right-hand half in view, cut straight; points (r, z, 0).

    Parameters
    ----------
    cut : BodySection
    view : View
    shade : ndarray, shape (n,)
        0 to 1, at the points of the section.

    Returns
    -------
    pyvista.PolyData
    """
    import pyvista

    points = np.column_stack([cut.moved, np.zeros(len(cut.moved))])
    faces: Any = cut.state.triangles
    mesh = pyvista.PolyData.from_regular_faces(points, faces)
    mesh.point_data["shade"] = shade
    mesh = mesh.clip("x", origin=(view.right, 0.0, 0.0))
    return mesh.clip("-y", origin=(0.0, view.bottom, 0.0))


def standing(flat: pyvista.PolyData, angle: float) -> pyvista.PolyData:
    """The same at an angle about the axis."""
    mesh = flat.copy()
    r, z = flat.points[:, 0], flat.points[:, 1]
    mesh.points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    return mesh


def top(cut: BodySection, view: View, shade: Array) -> tuple[Array, Array]:
    """The deformed surface as far as it is shown, (k, 2), and the shades along it, (k,).

    Parameters
    ----------
    cut, view, shade
        As of :func:`half_section`.

    Returns
    -------
    line : ndarray, shape (k, 2)
    shades : ndarray, shape (k,)
    """
    x, y = cut.surface.T
    across = np.append(x[x < view.right], view.right)
    return np.column_stack([across, np.interp(across, x, y)]), np.interp(across, x, shade[cut.top])


def side(cut: BodySection, view: View, shade: Array) -> tuple[Array, Array]:
    """The outer side of what is shown, from below to the surface, and the shades along it.

    Parameters
    ----------
    cut, view, shade
        As of :func:`half_section`.

    Returns
    -------
    line : ndarray, shape (k, 2)
    shades : ndarray, shape (k,)
    """
    end = np.interp(view.right, *cut.surface.T)
    line = np.column_stack([np.full(60, view.right), np.linspace(view.bottom, end, 60)])
    margin = 0.3 * view.right
    near = (np.abs(cut.moved[:, 0] - view.right) < margin) & (cut.moved[:, 1] > view.bottom - margin)
    shades = LinearNDInterpolator(cut.moved[near], shade[near])(line)
    outside = np.isnan(shades)  # by round-off
    shades[outside] = NearestNDInterpolator(cut.moved[near], shade[near])(line[outside])
    return line, shades


def turned(line: Array) -> pyvista.StructuredGrid:
    """The surface that a line (k, 2) of the half-plane sweeps; points in PLANES copies of the line."""
    import pyvista

    angle = np.linspace(ANGLES[0], ANGLES[1], PLANES)[None, :]
    r, z = line[:, :1], line[:, 1:]
    return pyvista.StructuredGrid(r * np.cos(angle), r * np.sin(angle), z + 0.0 * angle)


def ring(point: Array) -> pyvista.PolyData:
    """The circle that a point (r, z) describes, as far as the body goes."""
    import pyvista

    angle = np.linspace(ANGLES[0], ANGLES[1], PLANES)
    around = np.column_stack([point[0] * np.cos(angle), point[0] * np.sin(angle), np.full(PLANES, point[1])])
    return pyvista.lines_from_points(around)
