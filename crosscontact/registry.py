"""The solvers by name, for the Python API and the command line."""

from __future__ import annotations

from collections.abc import Collection

from contact_scene.errors import SceneError, shown
from validation.solvers import REFERENCE, SOLVERS

__all__ = ["REFERENCE", "chosen", "names"]


def names() -> tuple[str, ...]:
    """Names of the registered solvers, in the order of tables and legends."""
    return tuple(SOLVERS)


def chosen(solvers: Collection[str], key: str) -> tuple[str, ...]:
    """Solvers to compare, in the order of :func:`names`.

    Raises
    ------
    SceneError
        If there is no such solver, the reference is not among them, or nothing else is.
    """
    several = isinstance(solvers, Collection) and not isinstance(solvers, str)
    unknown = [name for name in solvers if name not in names()] if several else [solvers]
    if unknown:
        raise SceneError(key, f"got {shown(unknown[0])}", f"several of {', '.join(names())}")
    if REFERENCE not in solvers or len(set(solvers)) < 2:
        allowed = f"{REFERENCE}, with which the others are compared, and at least one other"
        raise SceneError(key, f"got {', '.join(map(str, solvers)) or 'none'}", allowed)
    return tuple(name for name in names() if name in solvers)
