"""All solvers by name: built-in, of other packages, and peers.

A solver of another package is an entry point of the group ``crosscontact.solvers`` that names a subclass of
:class:`~validation.solvers.base.Solver`, or an object of one, whose ``name`` is that of the entry point. To
list names loads nothing; a solver is loaded where it is looked up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping
from typing import TYPE_CHECKING

from contact_scene import SceneError
from contact_scene.errors import shown
from validation.solvers.base import REFERENCE, Solver, exit_is_an_error
from validation.solvers.peers import PEERS

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "crosscontact.solvers"


class UnusableSolver(SceneError, KeyError):
    """A solver that cannot be loaded; who looks it up in a mapping finds none."""


class SolverRegistry(MutableMapping[str, Solver]):
    """Solvers by name; those of other packages are listed with the built-in ones.

    Peers are found by name and not listed: they run where somebody asks for them.
    """

    def __init__(self, built_in: Mapping[str, Callable[[], Solver]]) -> None:
        self._built_in = dict(built_in)
        self._solvers: dict[str, Solver] = {}
        self._found: dict[str, EntryPoint] | None = None

    @property
    def _plugins(self) -> dict[str, EntryPoint]:
        """Entry points by name; one whose name is taken, by the first package of two too, counts for none."""
        if self._found is None:
            taken = {*self._built_in, *self._solvers, *PEERS}
            self._found = {}
            for entry in sorted(_entries(), key=lambda entry: (entry.name, _package(entry))):
                if entry.name not in taken:
                    self._found.setdefault(entry.name, entry)
        return self._found

    def __getitem__(self, name: str) -> Solver:
        method = self._solvers.get(name) or PEERS.get(name)
        if method is None:
            built_in = self._built_in.get(name)
            method = built_in() if built_in is not None else load(self._plugins[name])
            self._solvers[name] = method
        return method

    def __setitem__(self, name: str, method: Solver) -> None:
        self._solvers[name] = method

    def __delitem__(self, name: str) -> None:
        if self._built_in.pop(name, None) is None or name in self._solvers:
            del self._solvers[name]

    def __contains__(self, name: object) -> bool:
        return name in self._built_in or name in self._solvers or name in PEERS or name in self._plugins

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys((*self._built_in, *self._solvers, *self._plugins)))

    def __len__(self) -> int:
        return len(tuple(iter(self)))

    def load_all(self) -> list[str]:
        """Load the solvers of other packages; a line for each that cannot be, which is no longer listed."""
        told = []
        for name in list(self._plugins):
            try:
                self[name]
            except UnusableSolver as error:
                told.append(error.problem)
                del self._plugins[name]
        return told

    def origin(self, name: str) -> str:
        """Version of a solver that is no part of this program; else empty."""
        if name in PEERS:
            return PEERS[name].version
        entry = self._plugins.get(name)
        if entry is None:
            return ""
        return "unknown" if entry.dist is None else entry.dist.version


def load(entry: EntryPoint) -> Solver:
    """Load the solver of an entry point; ``UnusableSolver``, one line with its package, if there is none."""
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
    problem = f'"{entry.name}" of {_package(entry)} cannot be used: {reason}'
    return UnusableSolver("solver", problem, f"an entry point of {GROUP} that names a Solver")


def _package(entry: EntryPoint) -> str:
    """The package an entry point belongs to, with its version."""
    return "a package" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"


def _entries() -> tuple[EntryPoint, ...]:
    from importlib.metadata import entry_points

    return tuple(entry_points(group=GROUP))


def _bem() -> Solver:
    from validation.solvers.boundary_elements import BoundaryElements

    return BoundaryElements()


def _fem() -> Solver:
    from validation.solvers.finite_elements import FiniteElements

    return FiniteElements()


def _reference() -> Solver:
    from validation.solvers.front_tracking import FrontTracking

    return FrontTracking()


SOLVERS = SolverRegistry({"bem": _bem, "fem": _fem, REFERENCE: _reference})


def register(method: Solver) -> None:
    """Add a solver; commands and reports run it after those registered before.

    Raises
    ------
    ValueError
        If there is a solver of this name.
    """
    if method.name in SOLVERS:
        raise ValueError(f'there is a solver named "{method.name}" already')
    SOLVERS[method.name] = method


def unregister(name: str) -> None:
    """Remove a solver."""
    del SOLVERS[name]


def solver(name: str) -> Solver:
    """The solver of this name; ``KeyError`` if there is none."""
    return SOLVERS[name]


def solvers() -> tuple[Solver, ...]:
    """All solvers that can be loaded, in the order of their registration."""
    return tuple(method for name in SOLVERS if (method := SOLVERS.get(name)) is not None)
