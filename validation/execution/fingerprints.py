"""Fingerprints of what is computed: scene, solver, options, the program's own sources and its packages."""

from __future__ import annotations

import hashlib
import json
import platform
import sys
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

OWN_PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
NUMERICAL_PACKAGES = ("numpy", "scipy", "scikit-fem", "gmsh")
EVALUATING_FOLDERS = ("report", "claims")
"""Folders of ``validation`` that read runs and change none: editing them leaves fingerprints as they are."""


def fingerprint(*parts: Any) -> str:
    """Hash that tells apart any two computations, and any two versions of this program."""
    text = json.dumps([version(), canonical(parts)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def canonical(value: Any) -> Any:
    """Dataclasses, sequences and numbers as JSON that tells any two of them apart.

    Dataclass fields that take no part in a comparison are left out: where a table came from, and what is
    derived from other fields.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return [
            type(value).__name__,
            {name: canonical(getattr(value, name)) for name in _compared(type(value))},
        ]
    if isinstance(value, (tuple, list)):
        return [canonical(entry) for entry in value]
    if isinstance(value, float):
        return float(value).hex()
    if value is None or isinstance(value, (str, int)):
        return value
    if hasattr(value, "tobytes"):
        return [str(value.dtype), list(value.shape), value.tobytes().hex()]
    raise TypeError(f"{type(value).__name__} cannot be part of a fingerprint")


@cache
def _compared(kind: type) -> tuple[str, ...]:
    return tuple(entry.name for entry in fields(kind) if entry.compare)


@cache
def version() -> str:
    """Hash of the sources that make the numbers, and of the packages they compute with."""
    from importlib import metadata

    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for package in OWN_PACKAGES:
        for source in sorted((root / package).rglob("*.py")):
            name = source.relative_to(root)
            if len(name.parts) > 2 and name.parts[1] in EVALUATING_FOLDERS:
                continue
            digest.update(name.as_posix().encode() + b"\0" + source.read_bytes() + b"\0")
    for package in NUMERICAL_PACKAGES:
        try:
            digest.update(f"{package} {metadata.version(package)}\n".encode())
        except metadata.PackageNotFoundError:
            digest.update(f"{package} missing\n".encode())
    digest.update(f"{sys.version} {platform.machine()}".encode())
    return digest.hexdigest()
