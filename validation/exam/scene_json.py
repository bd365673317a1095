"""A scene as JSON that needs no reader of ours: every default filled in, every table expanded.

The keys are those of a scene file. A table that a scene file names is a list here: ``radii`` and ``heights``
of a profile, ``times`` and ``values`` of a load step, ``speeds`` and ``works`` of an adhesion that follows
the speed of the edge. ``adhesion``, ``machine`` and ``material.bulk`` are ``null`` where a scene has none.
"""

from __future__ import annotations

import tempfile
import tomllib
from pathlib import Path
from typing import Any

from contact_scene import RateTable, Scene, SceneError, TabulatedProfile, scene_from_dict, write_scene
from contact_scene.edge_rate import RATE_COLUMNS
from contact_scene.errors import shown
from contact_scene.files import write_pairs
from contact_scene.indenter import PROFILE_COLUMNS
from contact_scene.table import Table

DERIVED = "derived"
"""Key of what follows from the rest; left out where a scene is read."""


def expanded(scene: Scene) -> dict[str, Any]:
    """The scene as nested plain data."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.toml"
        write_scene(scene, file)
        data = tomllib.loads(file.read_text("utf-8"))
    if isinstance(scene.indenter, TabulatedProfile):
        points = {"radii": list(scene.indenter.radii), "heights": list(scene.indenter.heights)}
        data["indenter"] = {"shape": scene.indenter.shape} | points
    data["loading"]["steps"] = [
        {
            "kind": step.kind,
            "quantity": step.quantity,
            "interpolation": step.interpolation,
            "times": list(step.times),
            "values": list(step.values),
        }
        if isinstance(step, Table)
        else entry
        for step, entry in zip(scene.loading.steps, data["loading"].get("steps", []), strict=True)
    ]
    data["material"] = {"branches": [], "bulk": None} | data["material"]
    material = scene.material
    data[DERIVED] = {
        "glassy_modulus": material.glassy_modulus,
        "relaxed_plane_modulus": material.relaxed_plane_modulus,
        "glassy_plane_modulus": material.glassy_plane_modulus,
    }
    if scene.adhesion is not None and isinstance(scene.adhesion.rate, RateTable):
        rate = scene.adhesion.rate
        data["adhesion"]["rate"] = {"speeds": list(rate.speeds), "works": list(rate.works)}
    return {"adhesion": None, "machine": None} | data


def difference(stated: Any, asked: Any, key: str = "") -> str:
    """Where scenes in this form differ, in words, as far as both say something; empty where they do not.

    Parameters
    ----------
    stated, asked : dict
        As of :func:`expanded`, or parts of it.
    key : str
        Of these parts in the scene.

    Returns
    -------
    str
    """
    if isinstance(stated, dict) and isinstance(asked, dict):
        names = [name for name in asked if name in stated and name not in (DERIVED, "title")]
        pairs = [(f"{key}.{name}".lstrip("."), stated[name], asked[name]) for name in names]
    elif isinstance(stated, list) and isinstance(asked, list) and len(stated) == len(asked):
        parts = enumerate(zip(stated, asked, strict=True))
        pairs = [(f"{key}.{index}", *both) for index, both in parts]
    else:
        return "" if stated == asked else f"{key} is {shown(stated)} there, {shown(asked)} here"
    return next(filter(None, (difference(one, other, name) for name, one, other in pairs)), "")


def scene_of(data: Any) -> Scene:
    """The scene of such data.

    Raises
    ------
    SceneError
        If the data are those of no scene.
    """
    if not isinstance(data, dict):
        raise SceneError("scene", f"got {shown(data)}", "an object with the keys of a scene file")
    with tempfile.TemporaryDirectory() as folder:
        return scene_from_dict(_with_files(_without_null(data), Path(folder)), folder)


def _with_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The same with its lists as files in a folder, as a scene file has them."""
    data = {key: value for key, value in data.items() if key != DERIVED}
    indenter, loading, adhesion = data.get("indenter"), data.get("loading"), data.get("adhesion")
    try:
        if isinstance(indenter, dict) and "radii" in indenter:
            columns = indenter["radii"], indenter["heights"]
            write_pairs(folder / "profile.csv", PROFILE_COLUMNS, *columns)
            data["indenter"] = {"shape": indenter.get("shape"), "file": "profile.csv"}
        if isinstance(loading, dict) and isinstance(loading.get("steps"), list):
            steps = list(loading["steps"])
            for index, step in enumerate(steps):
                if isinstance(step, dict) and "times" in step:
                    name, quantity = f"{index}.csv", step.get("quantity", "penetration")
                    write_pairs(folder / name, ("time", str(quantity)), step["times"], step["values"])
                    others = {key: value for key, value in step.items() if key not in ("times", "values")}
                    steps[index] = others | {"file": name}
            data["loading"] = {**loading, "steps": steps}
        rate = adhesion.get("rate") if isinstance(adhesion, dict) else None
        if isinstance(adhesion, dict) and isinstance(rate, dict) and "speeds" in rate:
            write_pairs(folder / "rate.csv", RATE_COLUMNS, rate["speeds"], rate["works"])
            data["adhesion"] = {**adhesion, "rate": {"file": "rate.csv"}}
    except (KeyError, TypeError, ValueError):
        raise SceneError("scene", "has a table that is not two lists", "lists of equal length") from None
    return data


def _without_null(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_null(entry) for key, entry in value.items() if entry is not None}
    return [_without_null(entry) for entry in value] if isinstance(value, list) else value
