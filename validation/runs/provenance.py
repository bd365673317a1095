"""On what a result rests: fingerprint of a computation, version, machine, and the premises of a report.

Two reports whose premises differ may differ in numbers without anything being wrong; a comparison says so
before it lists them.
"""

from __future__ import annotations

import datetime
import hashlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

from validation.cases import Case
from validation.solvers import solvers

OWN_PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")
NUMERICAL_PACKAGES = ("numpy", "scipy", "scikit-fem", "gmsh")
EVALUATING_FOLDERS = ("report", "claims")
"""Folders of ``validation`` that read runs and change none: editing them leaves fingerprints as they are."""
_PACKAGES = ("crosscontact", "numpy", "scipy", "scikit-fem", "gmsh", "pyvista", "matplotlib")
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def fingerprint(*parts: Any) -> str:
    """Hash that tells apart any two computations, and any two versions of this program."""
    return hashed((version(), parts))


def hashed(value: Any) -> str:
    """Hash that tells apart any two values (see :func:`canonical`), whatever the version."""
    return hashlib.sha256(json.dumps(canonical(value), sort_keys=True).encode()).hexdigest()


def canonical(value: Any) -> Any:
    """Dataclasses, sequences and numbers as JSON that tells any two of them apart.

    Dataclass fields that take no part in a comparison are left out: where a table came from, and what is
    derived from other fields.
    """
    if isinstance(value, float):
        return float(value).hex()
    if is_dataclass(value) and not isinstance(value, type):
        return [
            type(value).__name__,
            {name: canonical(getattr(value, name)) for name in _compared(type(value))},
        ]
    if isinstance(value, (tuple, list)):
        return [canonical(entry) for entry in value]
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


def of_case(case: Case) -> dict[str, Any]:
    """Fingerprints of the parts of a scene, by name, and tolerances by solver and quantity."""
    scene = case.scene
    parts = {part.name: getattr(scene, part.name) for part in fields(scene) if part.name != "title"}
    parts["profile times"] = case.profile_times
    tolerances = {}
    for method in solvers():
        solver = method.name
        names = {"values", "curves", *method.quantity_tolerances, *case.tolerances.get(solver, {})}
        tolerances[solver] = {name: case.tolerance(solver, name) for name in sorted(names)}
    return {"input": {name: hashed(part)[:16] for name, part in parts.items()}, "tolerances": tolerances}


def changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> tuple[str, ...]:
    """What differs between the premises of an earlier report and a new one, each in one line."""
    lines = _version(old, new)
    before = {scene["name"]: scene.get("premises") for scene in old["scenes"]}
    for scene in new["scenes"]:
        name, now = scene["name"], scene["premises"]
        if name in before:
            lines += [f"{name}: {line}" for line in _of_scene(before[name], now)]
    return tuple(lines)


def _version(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    if old.get("program") == new["program"]:
        return []
    stated = old.get("environment")
    was, now = stated if isinstance(stated, dict) else {}, new["environment"]
    packages, present = was.get("packages") or {}, now["packages"]
    moved = [
        f"{name} {packages.get(name, 'missing')} -> {present.get(name, 'missing')}"
        for name in sorted({*packages, *present})
        if packages.get(name) != present.get(name)
    ]
    commits = f"commit {was.get('commit') or 'unknown'} -> {now['commit'] or 'unknown'}"
    return [f"another version of the program or its packages: {', '.join([commits, *moved])}"]


def _of_scene(old: Any, new: Mapping[str, Any]) -> list[str]:
    if not isinstance(old, dict):
        return ["input and tolerances: the earlier report does not say"]
    lines = []
    parts = [name for name, value in new["input"].items() if old["input"].get(name) != value]
    if parts:
        lines.append(f"another input: {', '.join(parts)}")
    for solver, table in new["tolerances"].items():
        before = old["tolerances"].get(solver)
        if before is not None and before != table:
            names = sorted({*before, *table})
            moved = [
                f"{name} {before.get(name)} -> {table.get(name)}"
                for name in names
                if before.get(name) != table.get(name)
            ]
            lines.append(f"other tolerances of {solver}: {', '.join(moved)}")
    return lines
