"""What Python API and command line are given: solvers by name, a scene, a resolution, a path."""

from __future__ import annotations

import os
import sys
from collections.abc import Collection
from pathlib import Path

from contact_scene import Scene
from contact_scene.errors import SceneError, shown
from contact_scene.files import as_path
from contact_scene.run_control import whole_number
from contact_scene.value_checks import several
from validation import cases
from validation.solvers import PEERS, REFERENCE, SOLVERS

SMALLEST_RESOLUTION = 4
"""Divisions per process zone (without adhesion: per hundredth of the largest contact radius); below it the
stress beside the contact edge is not resolved."""
A_SCENE = "a Scene, the name of a built-in scene, or a scene file"
"""What is allowed for a scene, in words."""


def names() -> tuple[str, ...]:
    """Names of the registered solvers, in the order of tables and legends."""
    return tuple(SOLVERS)


def selectable() -> tuple[str, ...]:
    """Names of the registered solvers and of the peers, which run where they are asked for."""
    return (*SOLVERS, *PEERS)


def check(name: str, key: str, choices: tuple[str, ...]) -> None:
    """Refuse what is not the name of one of these solvers, by the name of its argument."""
    if not isinstance(name, str) or name not in choices:
        raise SceneError(key, f"got {shown(name)}", f"one of {', '.join(choices)}")


def usable() -> tuple[str, ...]:
    """The registered solvers that can be loaded; a line on stderr for each other one."""
    for line in SOLVERS.load_all():
        print(f"crosscontact: solver {line}", file=sys.stderr)
    return tuple(SOLVERS)


def chosen(solvers: Collection[str], key: str) -> tuple[str, ...]:
    """Solvers to compare, in the order of :func:`selectable`; the reference and at least one other."""
    allowed = f"several of {', '.join(selectable())}"
    given = several(solvers, key, allowed)
    unknown = [name for name in given if not isinstance(name, str) or name not in selectable()]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", allowed)
    if REFERENCE not in given or len(set(given)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, given)) or 'none'}", allowed)
    return tuple(name for name in selectable() if name in given)


def case_of(scene: Scene | str | os.PathLike[str]) -> cases.Case:
    """The scene with its check values, if it is a built-in one by name."""
    if isinstance(scene, Scene):
        return cases.Case(scene.title or "scene", scene)
    if isinstance(scene, (str, os.PathLike)):
        return cases.load(os.fspath(scene))
    raise SceneError("scene", f"got {shown(scene)}", A_SCENE)


def checked_resolution(resolution: int | None) -> int | None:
    """A resolution that resolves the stress beside the contact edge; ``None``: the solver's choice."""
    return None if resolution is None else whole_number(resolution, "resolution", SMALLEST_RESOLUTION)


def checked_path(given: str | os.PathLike[str], key: str = "folder") -> Path:
    """A folder, or a file, as a path; an empty one, which would be the current folder, is refused."""
    return as_path(given, key, f"the path of a {'file' if key == 'path' else 'folder'}")
