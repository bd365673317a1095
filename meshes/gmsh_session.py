"""Loading gmsh, or saying in one line why it cannot be loaded; and using it without leaving traces."""

from __future__ import annotations

import ctypes
import importlib
import logging
import re
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType

#: Debian and Ubuntu packages of the shared libraries that gmsh's wheel expects to find on the system.
SYSTEM_PACKAGES = {
    "libGL.so": "libgl1",
    "libGLU.so": "libglu1-mesa",
    "libX11.so": "libx11-6",
    "libXcursor.so": "libxcursor1",
    "libXext.so": "libxext6",
    "libXfixes.so": "libxfixes3",
    "libXft.so": "libxft2",
    "libXinerama.so": "libxinerama1",
    "libXrender.so": "libxrender1",
    "libfontconfig.so": "libfontconfig1",
    "libgomp.so": "libgomp1",
}

OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.Algorithm": 6,  # frontal Delaunay
    "Mesh.ElementOrder": 1,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.MeshSizeMin": 0,
    "Mesh.MeshSizeMax": 1e22,
    "Mesh.MeshSizeFactor": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.RandomFactor": 1e-9,
    "Mesh.Smoothing": 1,
}

_lock = threading.RLock()  # gmsh has one global state per process
_log = logging.getLogger("crosscontact.meshes")


def find_gmsh() -> ModuleType | None:
    """Import gmsh, or log one warning per process and return None."""
    try:
        return importlib.import_module("gmsh")
    except (ImportError, OSError) as error:
        _warn_once(_reason(error))
        return None


@cache
def _warn_once(reason: str) -> None:
    _log.warning("%s; going on with the structured mesh family", reason)


def _reason(error: Exception) -> str:
    if isinstance(error, ModuleNotFoundError):
        return f"the Python package {error.name} is missing (pip install {error.name})"
    match = re.search(r"(lib[\w.+-]+?\.so)[\w.]*", str(error))
    if match is None:
        return f"gmsh cannot be loaded ({str(error).splitlines()[0] if str(error) else type(error).__name__})"
    package = SYSTEM_PACKAGES.get(match[1])
    advice = f" (apt install {package})" if package else ""
    return f"gmsh cannot be loaded, the system library {match[0]} is missing{advice}"


@contextmanager
def session(gmsh: ModuleType) -> Iterator[None]:
    """Give the body a fresh model and known options; afterwards gmsh is as it was found.

    gmsh is started without its interrupt handler, which only the main thread may install.
    """
    with _lock:
        started = not gmsh.isInitialized()
        if started:
            with _broken_pipes_as_before():
                gmsh.initialize(readConfigFiles=False, interruptible=False)
            previous, model = {}, ""
        else:
            previous = {name: gmsh.option.getNumber(name) for name in OPTIONS}
            model = gmsh.model.getCurrent()
        try:
            for name, value in OPTIONS.items():
                gmsh.option.setNumber(name, value)
            gmsh.model.add("crosscontact half-space")
            yield
        finally:
            if started:
                gmsh.finalize()
            else:
                gmsh.model.remove()
                for name, value in previous.items():
                    gmsh.option.setNumber(name, value)
                if model:
                    gmsh.model.setCurrent(model)


@contextmanager
def _broken_pipes_as_before() -> Iterator[None]:
    """Put back what gmsh's start resets: Python ignores SIGPIPE, which otherwise ends the process in silence.

    Through the C library, because Python lets only the main thread do that, and does not see what gmsh did.
    """
    if not hasattr(signal, "SIGPIPE"):  # not a Unix
        yield
        return
    handler = ctypes.CDLL(None).signal
    handler.argtypes, handler.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_void_p
    before = handler(signal.SIGPIPE, int(signal.SIG_IGN))
    try:
        yield
    finally:
        handler(signal.SIGPIPE, before)
