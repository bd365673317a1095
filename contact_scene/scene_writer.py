"""Scenes written as TOML, so that reading gives the same scene back; tables go into CSV files beside it."""

from __future__ import annotations

import os
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import tomli_w

from contact_scene.adhesion import Adhesion
from contact_scene.edge_rate import RATE_COLUMNS, RateTable
from contact_scene.files import as_target, write_pairs, write_whole
from contact_scene.indenter import PROFILE_COLUMNS, TabulatedProfile
from contact_scene.material import BulkRelaxation, Material
from contact_scene.scene import Scene
from contact_scene.table import Table
from contact_scene.value_checks import a_string, of_class


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene as TOML (tables of profiles and loading go into CSV files beside it).

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.
    """
    of_class(scene, "scene", Scene, "a Scene")
    target = as_target(path)
    data: dict[str, Any] = {"title": scene.title, "material": _material_table(scene.material)}
    if isinstance(scene.indenter, TabulatedProfile):
        name = f"{target.stem}-profile.csv"
        write_pairs(target.with_name(name), PROFILE_COLUMNS, scene.indenter.radii, scene.indenter.heights)
        data["indenter"] = {"shape": TabulatedProfile.shape, "file": name}
    else:
        data["indenter"] = {"shape": scene.indenter.shape} | asdict(scene.indenter)  # type: ignore[call-overload]
    if scene.adhesion is not None:
        data["adhesion"] = _adhesion_table(scene.adhesion, target)
    if scene.machine is not None:
        data["machine"] = asdict(scene.machine)
    steps = []
    for index, step in enumerate(scene.loading.steps):
        if isinstance(step, Table):
            name = f"{target.stem}-loading-{index}.csv"
            write_pairs(target.with_name(name), ("time", step.quantity), step.times, step.values)
            said = {"quantity": step.quantity, "interpolation": step.interpolation}
            defaults = {f.name: f.default for f in fields(Table)}
            differing = {key: value for key, value in said.items() if value != defaults[key]}
            steps.append({"kind": step.kind, "file": name} | differing)
        else:
            entries = asdict(step)  # type: ignore[call-overload]
            steps.append({"kind": step.kind} | {k: v for k, v in entries.items() if v is not None})
    data["loading"] = {"start": scene.loading.start, "penetration": scene.loading.penetration, "steps": steps}
    write_whole(target, tomli_w.dumps(data))


def write_material(material: Material, path: str | os.PathLike[str], remark: str = "") -> None:
    """Write the table ``[material]`` of a scene file as TOML, below the lines of ``remark`` as comments.

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.
    """
    of_class(material, "material", Material, "a Material")
    comments = "".join(f"# {line}\n" for line in a_string(remark, "remark").splitlines())
    write_whole(
        as_target(path),
        comments + tomli_w.dumps({"material": _material_table(material)}),
    )


def _material_table(material: Material) -> dict[str, Any]:
    table: dict[str, Any] = {"modulus": material.modulus, "poisson": material.poisson}
    if material.branches:
        table["branches"] = [asdict(branch) for branch in material.branches]
    if isinstance(material.bulk, BulkRelaxation):
        bulk: dict[str, Any] = {} if material.bulk.modulus is None else {"modulus": material.bulk.modulus}
        table["bulk"] = bulk | {"branches": [asdict(branch) for branch in material.bulk.branches]}
    elif material.bulk is not None:
        table["bulk"] = material.bulk
    return table


def _adhesion_table(adhesion: Adhesion, target: Path) -> dict[str, Any]:
    table = {key: value for key, value in asdict(adhesion).items() if value is not None}
    if adhesion.stress is not None:
        del table["zone"]
    if isinstance(adhesion.rate, RateTable):
        name = f"{target.stem}-rate.csv"
        write_pairs(target.with_name(name), RATE_COLUMNS, adhesion.rate.speeds, adhesion.rate.works)
        table["rate"] = {"file": name}
    return table
