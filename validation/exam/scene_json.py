"""A scene as JSON that needs no reader of ours: every default filled in, every table expanded.

The keys are those of a scene file. A table that a scene file names is a list here: ``radii`` and ``heights``
of a profile, ``times`` and ``values`` of a load step, ``speeds`` and ``works`` of an adhesion that follows
the speed of the edge. ``adhesion``, ``machine`` and ``material.bulk`` are ``null`` where a scene has none.
"""

from __future__ import annotations

from typing import Any

from contact_scene import Scene, SceneError, scene_from_dict
from contact_scene.errors import shown
from contact_scene.scene import scene_table

DERIVED = "derived"
"""Key of what follows from the rest; left out where a scene is read."""


def expanded(scene: Scene) -> dict[str, Any]:
    """The scene as nested plain data."""
    data, material = scene_table(scene), scene.material
    data["material"] = {"bulk": None} | data["material"]
    data[DERIVED] = {
        "glassy_modulus": material.glassy_modulus,
        "relaxed_plane_modulus": material.relaxed_plane_modulus,
        "glassy_plane_modulus": material.glassy_plane_modulus,
    }
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
    """The scene of such data; an error where they are those of no scene."""
    if not isinstance(data, dict):
        raise SceneError("scene", f"got {shown(data)}", "an object with the keys of a scene file")
    return scene_from_dict(_without_null({key: value for key, value in data.items() if key != DERIVED}))


def _without_null(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_null(entry) for key, entry in value.items() if entry is not None}
    return [_without_null(entry) for entry in value] if isinstance(value, list) else value
