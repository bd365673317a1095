"""Loading gmsh, with a one-line reason where it cannot be loaded, and sessions that restore its state."""

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
"""Debian and Ubuntu packages of the shared libraries that gmsh's wheel loads from the system."""

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
    _log.warning("%s; using the structured mesh family", reason)


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
    """A new model with fixed options; the state of gmsh is restored afterwards.

    gmsh is started without its interrupt handler, which only the main thread may install.
    """
    with _lock:
        started = not gmsh.isInitialized()
        if started:
            with _sigpipe_restored():
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
def _sigpipe_restored() -> Iterator[None]:
    """Restore the handler of SIGPIPE: Python ignores that signal, gmsh makes it end the process.

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
