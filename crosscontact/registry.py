"""The solvers by name, for the Python API and the command line."""

from __future__ import annotations

import sys
from collections.abc import Collection, Set

from contact_scene.errors import SceneError, as_tuple, shown
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
    allowed = f"several of {', '.join(selectable())}"
    several = tuple(solvers) if isinstance(solvers, Set) else as_tuple(solvers, key, allowed)
    unknown = [name for name in several if not isinstance(name, str) or name not in selectable()]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", allowed)
    if REFERENCE not in several or len(set(several)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, several)) or 'none'}", allowed)
    return tuple(name for name in selectable() if name in several)
