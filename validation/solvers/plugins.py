"""Solvers of other packages: entry points of the group ``crosscontact.solvers``.

An entry point names a subclass of :class:`~validation.solvers.base.Solver`, or an object of one, whose
``name`` is that of the entry point. To list names loads nothing; a solver is loaded when it is asked for.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from contact_scene import SceneError
from contact_scene.errors import shown
from validation.solvers.base import Solver, exit_is_an_error

GROUP = "crosscontact.solvers"
_ALLOWED = f"an entry point of {GROUP} that names a Solver"


class UnusableSolver(SceneError, KeyError):
    """A solver that cannot be loaded; who looks it up in a mapping finds none."""


def discovered() -> dict[str, EntryPoint]:
    """Entry points by name, in alphabetical order; of two with one name the first package's."""
    found: dict[str, EntryPoint] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, package(entry))):
        found.setdefault(entry.name, entry)
    return found


def package(entry: EntryPoint) -> str:
    """The package an entry point belongs to, with its version."""
    return "a package" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"


def version(entry: EntryPoint) -> str:
    """Version of that package."""
    return "unknown" if entry.dist is None else entry.dist.version


def load(entry: EntryPoint) -> Solver:
    """Load a solver.

    Raises
    ------
    UnusableSolver
        If it cannot be imported, or is none; one line with its package.
    """
    try:
        with exit_is_an_error():
            target = entry.load()
            method = target() if isinstance(target, type) else target
    except Exception as error:
        raise _unusable(entry, f"{type(error).__name__}: {' '.join(str(error).split())}") from error
    if not isinstance(method, Solver):
        raise _unusable(entry, f"{shown(method)} is no Solver")
    if getattr(method, "name", None) != entry.name:
        raise _unusable(entry, f"the solver's own name is {shown(getattr(method, 'name', None))}")
    return method


def _unusable(entry: EntryPoint, reason: str) -> UnusableSolver:
    return UnusableSolver("solver", f'"{entry.name}" of {package(entry)} cannot be used: {reason}', _ALLOWED)
