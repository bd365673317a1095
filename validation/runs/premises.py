"""What the numbers of a report rest on: input and tolerances of each scene, version of the program.

Two reports whose premises differ may differ in numbers without anything being wrong; a comparison says so
before it lists them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from validation.cases import Case
from validation.runs.provenance import canonical
from validation.solvers import solvers

Premises = Mapping[str, Any]
NOT_RECORDED = "the earlier report does not say"


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
    return {"input": {name: _hash(part) for name, part in parts.items()}, "tolerances": tolerances}


def _hash(part: Any) -> str:
    return hashlib.sha256(json.dumps(canonical(part), sort_keys=True).encode()).hexdigest()[:16]


def changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> tuple[str, ...]:
    """What differs between the premises of two reports, each in one line.

    Parameters
    ----------
    old, new : mapping
        Earlier and present report, both as in ``report.json``.

    Returns
    -------
    tuple of str
    """
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
    told = old.get("environment")
    was, now = told if isinstance(told, dict) else {}, new["environment"]
    packages, present = was.get("packages") or {}, now["packages"]
    moved = [
        f"{name} {packages.get(name, 'missing')} -> {present.get(name, 'missing')}"
        for name in sorted({*packages, *present})
        if packages.get(name) != present.get(name)
    ]
    commits = f"commit {was.get('commit') or 'unknown'} -> {now['commit'] or 'unknown'}"
    return [f"another version of the program or its packages: {', '.join([commits, *moved])}"]


def _of_scene(old: Premises | None, new: Premises) -> list[str]:
    if not isinstance(old, dict):
        return [f"input and tolerances: {NOT_RECORDED}"]
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
