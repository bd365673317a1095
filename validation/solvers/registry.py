"""All solvers by name: built-in, of other packages, and peers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping
from typing import TYPE_CHECKING

from validation.solvers.base import REFERENCE, Solver
from validation.solvers.peers import PEERS

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


class SolverRegistry(MutableMapping[str, Solver]):
    """Solvers by name.

    A solver is loaded where it is looked up. Those of other packages are listed with the built-in ones. Peers
    are found by name and not listed: they run where somebody asks for them.
    """

    def __init__(self, built_in: Mapping[str, Callable[[], Solver]]) -> None:
        self._built_in = dict(built_in)
        self._solvers: dict[str, Solver] = {}
        self._found: dict[str, EntryPoint] | None = None

    @property
    def _plugins(self) -> dict[str, EntryPoint]:
        """Entry points that are not loaded; a name that is taken counts as built-in."""
        if self._found is None:
            from validation.solvers import plugins

            taken = {*self._built_in, *self._solvers, *PEERS}
            self._found = {name: one for name, one in plugins.discovered().items() if name not in taken}
        return self._found

    def __getitem__(self, name: str) -> Solver:
        method = self._solvers.get(name) or PEERS.get(name)
        if method is None and name in self._built_in:
            method = self._solvers[name] = self._built_in[name]()
        elif method is None:
            from validation.solvers import plugins

            method = self._solvers[name] = plugins.load(self._plugins[name])
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
        """Load the solvers of other packages; those that cannot be are no longer listed.

        Returns
        -------
        list of str
            A line for each of these.
        """
        from validation.solvers import plugins

        told = []
        for name in list(self._plugins):
            try:
                self[name]
            except plugins.UnusableSolver as error:
                told.append(error.problem)
                del self._plugins[name]
        return told

    def origin(self, name: str) -> str:
        """Version of a solver that is no part of this program; else empty."""
        if name in PEERS:
            return PEERS[name].version
        if name not in self._plugins:
            return ""
        from validation.solvers import plugins

        return plugins.version(self._plugins[name])


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
    """The solver of this name.

    Raises
    ------
    KeyError
        If there is none.
    """
    return SOLVERS[name]


def solvers() -> tuple[Solver, ...]:
    """All solvers that can be loaded, in the order of their registration."""
    return tuple(method for name in SOLVERS if (method := SOLVERS.get(name)) is not None)
