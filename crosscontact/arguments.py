"""What Python API and command line are given: their common arguments, each with its one check.

A check is called with the value and the name of the argument, and returns the value or raises
:class:`~contact_scene.SceneError` in one line. Options of commands are read by :func:`option_type` of the
same check.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from contact_scene import Scene
from contact_scene.errors import SceneError, shown
from contact_scene.files import as_path
from contact_scene.value_checks import Range, not_negative, several, whole_from
from validation import cases
from validation.solvers import PEERS, REFERENCE, SOLVERS

RESOLUTION = whole_from(1)
"""Divisions per process zone (without adhesion: per hundredth of the largest contact radius); a solver may
ask for more."""
COUNT = whole_from(1)
A_SCENE = "a Scene, the name of a built-in scene, or a scene file"


def given(check: Callable[[Any, str], Any], value: Any, key: str) -> Any:
    """The checked value, or ``None`` where none is given."""
    return None if value is None else check(value, key)


def option_type(check: Range) -> Callable[[str], Any]:
    """The type of an option of the command line: the number that a text states, checked."""

    def parse(text: str) -> Any:
        try:
            return check(float(text), "")
        except ValueError:
            raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: {check.words}") from None

    return parse


def names() -> tuple[str, ...]:
    """Names of the registered solvers, in the order of tables and legends."""
    return tuple(SOLVERS)


def selectable() -> tuple[str, ...]:
    """Names of the registered solvers and of the peers, which run where they are asked for."""
    return (*SOLVERS, *PEERS)


def usable() -> tuple[str, ...]:
    """The registered solvers that can be loaded; a line on stderr for each other one."""
    for line in SOLVERS.load_all():
        print(f"crosscontact: solver {line}", file=sys.stderr)
    return tuple(SOLVERS)


def check_solver(name: str, key: str, choices: tuple[str, ...]) -> None:
    """Refuse what is not the name of one of these solvers."""
    if not isinstance(name, str) or name not in choices:
        raise SceneError(key, f"got {shown(name)}", f"one of {', '.join(choices)}")


def chosen(solvers: Collection[str], key: str) -> tuple[str, ...]:
    """Solvers to compare, in the order of :func:`selectable`; the reference and at least one other."""
    allowed = f"several of {', '.join(selectable())}"
    asked = several(solvers, key, allowed)
    unknown = [name for name in asked if not isinstance(name, str) or name not in selectable()]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", allowed)
    if REFERENCE not in asked or len(set(asked)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, asked)) or 'none'}", allowed)
    return tuple(name for name in selectable() if name in asked)


def case_of(scene: Scene | str | os.PathLike[str]) -> cases.Case:
    """The scene with its check values, if it is a built-in one by name."""
    if isinstance(scene, Scene):
        return cases.Case(scene.title or "scene", scene)
    if isinstance(scene, (str, os.PathLike)):
        return cases.load(os.fspath(scene))
    raise SceneError("scene", f"got {shown(scene)}", A_SCENE)


def times(values: Collection[float], key: str) -> tuple[float, ...]:
    """Times of a scene."""
    found = several(values, key, "several times")
    return tuple(not_negative(time, f"{key}[{i}]") for i, time in enumerate(found))


def checked_path(path: str | os.PathLike[str], key: str = "folder") -> Path:
    """A folder, or a file, as a path; an empty one, which would be the current folder, is refused."""
    return as_path(path, key, f"the path of a {'file' if key == 'path' else 'folder'}")
