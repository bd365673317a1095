"""The solvers by name, for the Python API and the command line."""

from __future__ import annotations

import sys
from collections.abc import Collection

from contact_scene.errors import SceneError, shown
from validation.solvers import PEERS, REFERENCE, SOLVERS

__all__ = ["REFERENCE", "chosen", "names", "selectable", "usable"]


def names() -> tuple[str, ...]:
    """Names of the registered solvers, in the order of tables and legends."""
    return tuple(SOLVERS)


def selectable() -> tuple[str, ...]:
    """The same and the peers, which run where they are asked for."""
    return (*SOLVERS, *PEERS)


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
    several = isinstance(solvers, Collection) and not isinstance(solvers, str)
    unknown = [name for name in solvers if name not in selectable()] if several else [solvers]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", f"several of {', '.join(selectable())}")
    if REFERENCE not in solvers or len(set(solvers)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, solvers)) or 'none'}", allowed)
    return tuple(name for name in selectable() if name in solvers)
