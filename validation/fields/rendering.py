"""What PyVista draws: the section of a body, flat or turned about the axis, off-screen or in a window.

Points are ``x = r``, ``z`` upwards. VTK itself chooses between a screen, EGL and OSMesa (software, no driver
needed), but without any of them it ends the whole process instead of raising an error: so whether it can draw
is tried once, in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from validation.fields.section import AxialSection, Look

if TYPE_CHECKING:
    import pyvista

Fill = Callable[[Any], None]
"""Puts things into a plotter."""

INDENTER, MARK, ZONE = "#c9ccd1", "#000000", "#e6007e"
CUT = 135.0
"""Angle of the cut faces from the x axis; the quarter around the direction of view is left out."""
TURNS = 72
"""Steps about the axis by which a line is turned into a surface."""
VIEW_DIRECTION = (-1.0, 0.0, 0.55)
CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"
_ATTEMPT_LIMIT = 60.0
"""Seconds for the attempt; software rendering on a busy machine is slow to start."""
_ATTEMPT = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(8, 8))
plotter.add_mesh(pyvista.Plane(), color="black", lighting=False)
assert plotter.screenshot(None, return_img=True).min() < 128
print("drawn with", plotter.render_window.GetClassName())
"""


class NoRendering(OSError):
    """Nothing on this machine lets VTK draw."""


@cache
def check_rendering() -> bool:
    """Whether there is a screen, found out once a process; raises :class:`NoRendering` if VTK cannot draw."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        os.environ.setdefault(CHOICE, "vtkEGLRenderWindow")  # VTK's own first choice warns of the screen
    command = [sys.executable, "-c", _ATTEMPT]
    try:
        tried = subprocess.run(command, capture_output=True, text=True, timeout=_ATTEMPT_LIMIT)
        used = "" if tried.returncode else tried.stdout
    except subprocess.TimeoutExpired:
        used = ""
    if "drawn with" not in used:
        raise NoRendering(
            "PyVista cannot draw on this machine: no screen, and neither EGL nor OSMesa works. Install a "
            "software OpenGL (Debian: libegl1 libgl1-mesa-dri, or libosmesa6); the VTU files need none"
        )
    off_screen_only = os.environ.get("PYVISTA_OFF_SCREEN", "").lower() in ("1", "true")
    return "EGL" not in used and "vtkOSOpenGL" not in used and not off_screen_only


def picture(fill: Fill, size: tuple[int, int]) -> NDArray[np.uint8]:
    """What ``fill`` puts into a window, drawn off-screen on white; shape (height, width, 3)."""
    check_rendering()
    plotter = _plotter(off_screen=True, window_size=size)
    try:
        fill(plotter)
        return np.asarray(plotter.screenshot(None, return_img=True))[:, :, :3].copy()
    finally:
        plotter.close()


def show(fill: Fill, title: str) -> bool:
    """Open an interactive window where there is a screen; return whether there was one."""
    if not check_rendering():
        return False
    plotter = _plotter(off_screen=False, window_size=(1200, 800), title=title)
    try:
        fill(plotter)
        plotter.show()
    finally:
        plotter.close()
    return True


def _plotter(**options: Any) -> Any:
    import pyvista

    plotter: Any = pyvista.Plotter(**options)
    plotter.set_background("white")
    return plotter


def half(cut: AxialSection, look: Look) -> pyvista.PolyData:
    """The right-hand half of the deformed section, with the ``shade`` of the field."""
    import pyvista

    r, z = cut.points.T
    faces: Any = cut.state.triangles
    mesh = pyvista.PolyData.from_regular_faces(np.column_stack([r, 0.0 * r, z]), faces)
    mesh.point_data["shade"] = look.colours.shade(look.quantity.values(cut.state))
    return mesh


def _coloured(look: Look) -> dict[str, Any]:
    style = {"scalars": "shade", "cmap": look.colours.kind.value, "clim": (0.0, 1.0)}
    return style | {"lighting": False, "show_scalar_bar": False}


def add_section(plotter: Any, cut: AxialSection, look: Look) -> None:
    """Put the coloured body on both sides of the axis into a window, the camera on the view."""
    body, view = half(cut, look), look.view(cut)
    for mesh in (body, body.reflect((1.0, 0.0, 0.0))):
        plotter.add_mesh(mesh, **_coloured(look))
    middle, height = 0.5 * np.array([view.left + view.right, view.bottom + view.top]), view.top - view.bottom
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point = (middle[0], 0.0, middle[1])
    camera.position = (middle[0], -10.0 * height, middle[1])
    camera.up = (0.0, 0.0, 1.0)
    camera.parallel_scale = 0.5 * height
    plotter.reset_camera_clipping_range()


def add_body(plotter: Any, cut: AxialSection, look: Look) -> None:
    """Put body of revolution, indenter and marks into a window, a quarter left out to look inside."""
    view = look.view(cut)
    body = half(cut, look).clip("x", origin=(view.right, 0.0, 0.0))
    body = body.clip("-z", origin=(0.0, 0.0, view.bottom))
    around = body.extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )
    plotter.add_mesh(turned(around), **_coloured(look), name="skin")
    rim = [view.right, float(np.interp(view.right, *cut.surface.T))]
    lines = [turned(line([rim])), turned(line([[view.right, body.bounds[4]]]))]
    for angle in (-CUT, CUT):
        plotter.add_mesh(body.rotate_z(angle), **_coloured(look))
        lines.append(around.rotate_z(angle))
    for one in lines:
        drawn = plotter.add_mesh(one, scalars=None, color=MARK, line_width=1.0, lighting=False)
        drawn.mapper.SetResolveCoincidentTopologyToPolygonOffset()  # before the faces they bound
        drawn.mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -4.0)
    beyond = np.vstack([cut.edge, cut.indenter[cut.indenter[:, 0] > cut.edge[0]]])
    shown = beyond[(beyond[:, 0] <= view.right) & (beyond[:, 1] <= view.top)]
    plotter.add_mesh(turned(line(shown)), color=INDENTER, opacity=0.45, smooth_shading=True, name="indenter")
    lift = np.array([0.0, 2e-3 * view.right])  # so that the marks are not half sunk into the surface
    marks = {"edge": (cut.edge, MARK)} | ({"zone": (cut.zone[-1], ZONE)} if cut.zone.size else {})
    for name, (point, colour) in marks.items():
        ring = turned(line([point + lift]))
        plotter.add_mesh(ring, color=colour, line_width=3.0, lighting=False, name=name)
    plotter.camera.parallel_projection = True
    plotter.view_vector(VIEW_DIRECTION, viewup=(0.0, 0.0, 1.0))
    plotter.camera.focal_point = (0.0, 0.0, 0.36 * view.bottom)
    plotter.camera.parallel_scale = 0.82 * view.right
    plotter.reset_camera_clipping_range()


def line(points: Any) -> pyvista.PolyData:
    """Points (r, z) as a line, or a single one."""
    import pyvista

    r, z = np.asarray(points, float).T
    xyz = np.column_stack([r, 0.0 * r, z])
    return pyvista.PolyData(xyz) if len(xyz) == 1 else pyvista.lines_from_points(xyz)


def turned(profile: pyvista.PolyData) -> pyvista.PolyData:
    """The surface that a line sweeps about the axis between the cut faces, or the ring of a point."""
    begun = profile.rotate_z(-CUT)
    return begun.extrude_rotate(resolution=TURNS, angle=2.0 * CUT, capping=False)
