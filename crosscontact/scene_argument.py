"""The scene that a function of the Python interface is given: itself, a built-in one by name, or a file."""

from __future__ import annotations

import os

from contact_scene import Scene, SceneError
from contact_scene.errors import shown
from validation import cases

A_SCENE = "a Scene, the name of a built-in scene, or a scene file"
"""What is allowed, in words."""


def case_of(scene: Scene | str | os.PathLike[str]) -> cases.Case:
    """The scene with its check values, if it is a built-in one by name.

    Raises
    ------
    SceneError
        If it is nothing of these, or the file holds none.
    """
    if isinstance(scene, Scene):
        return cases.Case(scene.title or "scene", scene)
    if isinstance(scene, (str, os.PathLike)):
        return cases.load(os.fspath(scene))
    raise SceneError("scene", f"got {shown(scene)}", A_SCENE)
