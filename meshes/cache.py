"""Cache of meshes by their parameters, in memory and on disk.

An entry is written under a temporary name and moved into place, so a concurrent reader sees all of it or
nothing; whatever cannot be read back as the requested mesh is built again. A cache that cannot be
written is no error.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import threading
import zipfile
from collections import OrderedDict
from contextlib import suppress
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from platformdirs import user_cache_path

from meshes.halfspace import half_space
from meshes.mesh import BOUNDARIES, HalfSpaceMesh
from meshes.parameters import MeshParameters

VERSION = 2
"""Raised whenever the same parameters lead to another mesh or the file layout changes."""
IN_MEMORY = 16
"""Meshes in memory; the least recently used one is dropped."""

_memory: OrderedDict[tuple[Path, MeshParameters], HalfSpaceMesh] = OrderedDict()
_lock = threading.Lock()


def cache_directory() -> Path:
    """The user's cache folder of this program, by the conventions of the operating system."""
    return user_cache_path("crosscontact")


def cached(parameters: MeshParameters) -> HalfSpaceMesh:
    """Return `half_space(parameters)`, built at most once while the cache lives."""
    directory = cache_directory()
    key = (directory, parameters)
    with _lock:
        if key in _memory:
            _memory.move_to_end(key)
            return _memory[key]
    mesh = _load(directory / _name(parameters), parameters)
    if mesh is None:
        mesh = half_space(parameters)
        if mesh.parameters == parameters:  # not where gmsh is missing and another family was used
            _store(directory / _name(parameters), mesh)
    with _lock:
        _memory[key] = mesh
        while len(_memory) > IN_MEMORY:
            _memory.popitem(last=False)
    return mesh


def _name(parameters: MeshParameters) -> str:
    generator = ""
    if parameters.family == "gmsh":
        with suppress(metadata.PackageNotFoundError):
            generator = metadata.version("gmsh")
    key = json.dumps([VERSION, generator, asdict(parameters)], sort_keys=True)
    return f"mesh-{hashlib.sha256(key.encode()).hexdigest()[:32]}.npz"


def _load(path: Path, parameters: MeshParameters) -> HalfSpaceMesh | None:
    try:
        with np.load(path, allow_pickle=False) as stored:  # verifies a checksum per array
            if json.loads(str(stored["parameters"])) != asdict(parameters):
                return None
            boundaries = {name: stored[name] for name in BOUNDARIES}
            return HalfSpaceMesh(stored["points"], stored["triangles"], boundaries, parameters)
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
        return None


def _store(path: Path, mesh: HalfSpaceMesh) -> None:
    arrays: dict[str, Any] = {"points": mesh.points, "triangles": mesh.triangles, **mesh.boundaries}
    arrays["parameters"] = json.dumps(asdict(mesh.parameters))
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=path.stem, suffix=".tmp", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as stream:
                np.savez(stream, **arrays)
            os.replace(temporary, path)
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
