"""All solvers by name: built-in, of other packages, and peers."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from importlib.metadata import EntryPoint

from validation.solvers import plugins
from validation.solvers.base import Solver
from validation.solvers.boundary_elements import BoundaryElements
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.front_tracking import FrontTracking
from validation.solvers.peers import PEERS


class SolverRegistry(MutableMapping[str, Solver]):
    """Solvers by name.

    Those of other packages are listed with the built-in ones and loaded where they are looked up. Peers are
    found by name and not listed: they run where somebody asks for them.
    """

    def __init__(self, *built_in: Solver) -> None:
        self._solvers = {method.name: method for method in built_in}
        self._found: dict[str, EntryPoint] | None = None

    @property
    def _plugins(self) -> dict[str, EntryPoint]:
        """Entry points that are not loaded; a name that is taken counts as built-in."""
        if self._found is None:
            taken = {*self._solvers, *PEERS}
            self._found = {name: one for name, one in plugins.discovered().items() if name not in taken}
        return self._found

    def __getitem__(self, name: str) -> Solver:
        method = self._solvers.get(name) or PEERS.get(name)
        if method is None:
            method = self._solvers[name] = plugins.load(self._plugins[name])
        return method

    def __setitem__(self, name: str, method: Solver) -> None:
        self._solvers[name] = method

    def __delitem__(self, name: str) -> None:
        del self._solvers[name]

    def __contains__(self, name: object) -> bool:
        return name in self._solvers or name in PEERS or name in self._plugins

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys((*self._solvers, *self._plugins)))

    def __len__(self) -> int:
        return len({*self._solvers, *self._plugins})

    def load_all(self) -> list[str]:
        """Load the solvers of other packages; those that cannot be are no longer listed.

        Returns
        -------
        list of str
            A line for each of these.
        """
        told = []
        for name in list(self._plugins):
            try:
                self[name]
            except plugins.UnusableSolver as error:
                told.append(error.problem)
                del self._plugins[name]
        return told

    def usable(self) -> dict[str, Solver]:
        """The listed solvers that can be loaded, by name; nothing is told of the others."""
        loaded = {name: self.get(name) for name in self}
        return {name: method for name, method in loaded.items() if method is not None}

    def origin(self, name: str) -> str:
        """Version of a solver that is no part of this program; else empty."""
        if name in PEERS:
            return PEERS[name].version
        return plugins.version(self._plugins[name]) if name in self._plugins else ""


SOLVERS = SolverRegistry(BoundaryElements(), FiniteElements(), FrontTracking())


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
    """The solver of this name.

    Raises
    ------
    KeyError
        If there is none.
    """
    return SOLVERS[name]


def solvers() -> tuple[Solver, ...]:
    """All solvers, in the order of their registration."""
    return tuple(SOLVERS.values())
