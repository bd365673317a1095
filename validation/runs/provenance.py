"""On what a result was computed: fingerprint of a computation, sources, packages, machine, commit."""

from __future__ import annotations

import datetime
import hashlib
import json
import os
import platform
import subprocess
import sys
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

OWN_PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
NUMERICAL_PACKAGES = ("numpy", "scipy", "scikit-fem", "gmsh")
EVALUATING_FOLDERS = ("report", "claims")
"""Folders of ``validation`` that read runs and change none: editing them leaves fingerprints as they are."""
_PACKAGES = ("crosscontact", "numpy", "scipy", "scikit-fem", "gmsh", "meshio", "pyvista", "matplotlib")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


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

    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for package in OWN_PACKAGES:
        for source in sorted((root / package).rglob("*.py")):
            name = source.relative_to(root)
            if len(name.parts) > 2 and name.parts[1] in EVALUATING_FOLDERS:
                continue
            digest.update(name.as_posix().encode() + b"\0" + source.read_bytes() + b"\0")
    for package in NUMERICAL_PACKAGES:
        digest.update(f"{package} {_installed(package) or 'missing'}\n".encode())
    digest.update(f"{sys.version} {platform.machine()}".encode())
    return digest.hexdigest()


def stamp() -> dict[str, object]:
    """Everything a reader needs to judge run times and to repeat a run."""
    return {
        "time": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "packages": {name: version for name in _PACKAGES if (version := _installed(name))},
        "machine": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "cores": os.cpu_count(),
        "threads": {name: os.environ.get(name, "unset") for name in _THREADS},
        "commit": _commit(),
    }


def program_version() -> str:
    """Version of this program, as it is installed."""
    return _installed("crosscontact") or "unknown"


def _installed(package: str) -> str | None:
    from importlib import metadata

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"


def _commit() -> str | None:
    """The checkout's commit, with a mark if it was changed; ``None`` where this file is in no checkout."""
    tracked = _git("ls-files", "--error-unmatch", Path(__file__).name)
    return _git("describe", "--always", "--dirty", "--abbrev=10") if tracked else None


def _git(*arguments: str) -> str | None:
    try:
        result = subprocess.run(
            ["git", *arguments], cwd=Path(__file__).parent, capture_output=True, text=True, timeout=10
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return result.stdout.strip() or None if result.returncode == 0 else None
