"""The solvers by name, for the Python API and the command line."""

from __future__ import annotations

import sys
from collections.abc import Collection

from contact_scene.errors import SceneError, shown
from contact_scene.value_checks import several
from validation.solvers import PEERS, REFERENCE, SOLVERS

__all__ = ["REFERENCE", "check", "chosen", "names", "selectable", "usable"]


def names() -> tuple[str, ...]:
    """Names of the registered solvers, in the order of tables and legends."""
    return tuple(SOLVERS)


def selectable() -> tuple[str, ...]:
    """The same and the peers, which run where they are asked for."""
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
    """Solvers to compare, in the order of :func:`names`.

    Raises
    ------
    SceneError
        If there is no such solver, the reference is not among them, or nothing else is.
    """
    allowed = f"several of {', '.join(selectable())}"
    given = several(solvers, key, allowed)
    unknown = [name for name in given if not isinstance(name, str) or name not in selectable()]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", allowed)
    if REFERENCE not in given or len(set(given)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, given)) or 'none'}", allowed)
    return tuple(name for name in selectable() if name in given)
