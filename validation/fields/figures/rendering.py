"""Rendering with PyVista: on a screen, else off-screen, else an error that names what is missing.

Without a usable OpenGL, VTK ends the whole process instead of raising an error. Whether it can draw is
therefore tried once in a process of its own, which also finds out which of VTK's windows works without a
warning: the one with a screen, that of EGL, or that of OSMesa (software, no driver needed).
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"
OFF_SCREEN_WINDOWS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")
ATTEMPT_LIMIT = 60.0
"""Seconds for the attempt; software rendering on a busy machine is slow to start."""
_ATTEMPT = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(8, 8))
plotter.add_mesh(pyvista.Plane(), color="black", lighting=False)
assert plotter.screenshot(None, return_img=True).min() < 128
print("drawn with", plotter.render_window.GetClassName())
"""


Fill = Callable[[Any], None]
"""Puts things into a plotter."""


class NoRendering(OSError):
    """Nothing on this machine lets VTK draw."""


@dataclass(frozen=True)
class RenderingWindow:
    """How VTK draws here: ``window`` to ask for (empty: its own choice), and whether there is a screen."""

    window: str
    screen: bool


@cache
def rendering_window() -> RenderingWindow:
    """Find out how to draw, once a process.

    Raises
    ------
    NoRendering
        If no way works.
    """
    for window in _candidates():
        used = _attempt(window)
        if used is not None:
            screen = "EGL" not in used and "vtkOSOpenGL" not in used
            return RenderingWindow(window, screen and not _off_screen_only())
    raise NoRendering(
        "PyVista cannot draw on this machine: no screen, and neither EGL nor OSMesa works. Install a "
        "software OpenGL (Debian: libegl1 libgl1-mesa-dri, or libosmesa6); the VTU files need none"
    )


def _candidates() -> tuple[str, ...]:
    """Windows to try, in order; on Linux without a screen VTK's own choice would warn of the missing one."""
    if os.environ.get(CHOICE):
        return (os.environ[CHOICE],)
    if not sys.platform.startswith("linux"):
        return ("",)
    return ("", *OFF_SCREEN_WINDOWS) if os.environ.get("DISPLAY") else OFF_SCREEN_WINDOWS


def _off_screen_only() -> bool:
    return os.environ.get("PYVISTA_OFF_SCREEN", "").lower() in ("1", "true")


def _attempt(window: str) -> str | None:
    """The window another process drew with, in its words; ``None`` if it did not survive."""
    chosen = {CHOICE: window} if window else {}
    try:
        tried = subprocess.run(
            [sys.executable, "-c", _ATTEMPT],
            env=os.environ | chosen,
            capture_output=True,
            text=True,
            timeout=ATTEMPT_LIMIT,
        )
    except subprocess.TimeoutExpired:
        return None
    return tried.stdout if tried.returncode == 0 and "drawn with" in tried.stdout else None


def picture(fill: Fill, size: tuple[int, int]) -> NDArray[np.uint8]:
    """What ``fill`` puts into a window, drawn off-screen on white; shape (height, width, 3).

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    plotter = _plotter(rendering_window(), off_screen=True, window_size=size)
    try:
        fill(plotter)
        return np.asarray(plotter.screenshot(None, return_img=True))[:, :, :3].copy()
    finally:
        plotter.close()


def show(fill: Fill, title: str) -> bool:
    """Open an interactive window where there is a screen; return whether there was one."""
    rendering = rendering_window()
    if not rendering.screen:
        return False
    plotter = _plotter(rendering, off_screen=False, window_size=(1200, 800), title=title)
    try:
        fill(plotter)
        plotter.show()
    finally:
        plotter.close()
    return True


def _plotter(rendering: RenderingWindow, **options: Any) -> Any:
    if rendering.window:
        os.environ[CHOICE] = rendering.window
    import pyvista

    plotter: Any = pyvista.Plotter(**options)
    plotter.set_background("white")
    return plotter
