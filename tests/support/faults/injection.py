"""Faults seeded in memory, one at a time; nothing on disk is touched."""

from __future__ import annotations

import functools
import importlib
import inspect
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np
import pytest

PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")


Broken = Callable[[Callable[..., Any]], Callable[..., Any]]
"""From a true function to a wrong one."""


@dataclass(frozen=True)
class Fault:
    """A wrong version of one function, of a ``solver`` or, ``shared``, of what all share and one shows.

    ``target`` is ``module:function`` or ``module:Class.method``; properties, class and static methods too.
    ``scenes`` are built-in ones that have to show it, the cheapest first; none: those tried with every fault.
    """

    solver: str
    name: str
    target: str
    broken: Broken
    scenes: tuple[str, ...] = ()
    shared: bool = False

    @property
    def key(self) -> str:
        """Name of the test."""
        return f"{'shared' if self.shared else self.solver}: {self.name}"


def table(solver: str, package: str, rows: Iterable[tuple[Any, ...]], shared: bool = False) -> list[Fault]:
    """Faults of a package from rows of name, target within it, wrong version, and names of scenes."""
    return [
        Fault(solver, name, f"{package}.{target}", broken, tuple(scenes), shared)
        for name, target, broken, *scenes in rows
    ]


def gives(change: Callable[[Any], Any]) -> Broken:
    """What the function gives is changed."""
    return lambda true: lambda *given, **named: change(true(*given, **named))


def times(factor: float) -> Broken:
    """The function gives so many times as much."""
    return gives(lambda found: factor * found)


def constant(value: Any) -> Broken:
    """The function gives the same whatever it is asked."""
    return lambda true: lambda *given, **named: value


def takes(**changes: Callable[[Any], Any]) -> Broken:
    """Arguments of the function, by name, are changed before it gets them."""

    def broken(true: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(true)
        if not changes.keys() <= signature.parameters.keys():
            raise TypeError(f"no arguments {', '.join(changes)}")

        def wrong(*given: Any, **named: Any) -> Any:
            asked = signature.bind(*given, **named)
            asked.apply_defaults()
            asked.arguments |= {name: change(asked.arguments[name]) for name, change in changes.items()}
            return true(*asked.args, **asked.kwargs)

        return wrong

    return broken


def changed(**changes: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The same dataclass with some of its fields changed."""
    return lambda one: replace(one, **{name: change(getattr(one, name)) for name, change in changes.items()})


def by(factor: float) -> Callable[[Any], Any]:
    """So many times a number."""
    return lambda number: factor * number


def rest(branches: Any) -> Any:
    """All branches but the first."""
    return branches[1:]


def located(target: str) -> tuple[Any, str]:
    """The module or class that holds the function ``module:function`` or ``module:Class.method``, its name.

    Raises
    ------
    ImportError, AttributeError, KeyError
        If there is no such function.
    """
    module, _, path = target.partition(":")
    owner: Any = importlib.import_module(module)
    *outer, name = path.split(".")
    for part in outer:
        owner = getattr(owner, part)
    vars(owner)[name]
    return owner, name


def _plain(member: Any) -> Callable[..., Any]:
    """The function in a property, class method or static method, or the function itself."""
    match member:
        case property():
            return member.fget  # type: ignore[return-value]
        case functools.cached_property():
            return member.func
        case classmethod() | staticmethod():
            return member.__func__
        case _:
            return member


def stale(faults: Iterable[Fault]) -> list[str]:
    """Faults whose function is gone, or takes what its wrong version does not take; one line each."""
    lines = []
    for fault in faults:
        try:
            owner, name = located(fault.target)
            _bind(_plain(vars(owner)[name]), fault.broken)
        except (ImportError, AttributeError, KeyError, TypeError) as error:
            lines.append(f"{fault.target} ({fault.key}): {type(error).__name__}: {error}")
    return lines


def _bind(true: Callable[..., Any], broken: Callable[..., Any]) -> None:
    """Raise a :class:`TypeError` unless the wrong function takes the arguments of the true one."""
    if not inspect.isfunction(inspect.unwrap(true)):  # of SciPy, not written in Python
        return
    parameters = inspect.signature(true).parameters.values()
    wrong = inspect.signature(broken(true))
    in_order = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    by_name = [p for p in parameters if p.kind is p.KEYWORD_ONLY]
    wrong.bind(*in_order, **{p.name: p for p in by_name})
    needed = [p for p in in_order if p.default is p.empty]
    wrong.bind(*needed, **{p.name: p for p in by_name if p.default is p.empty})


@dataclass
class Calls:
    """How often a wrong function has been called."""

    count: int = 0


def _packages() -> list[ModuleType]:
    """What is loaded of the program."""
    return [module for name, module in sys.modules.items() if name.startswith(PACKAGES)]


def _empty_caches() -> None:
    """Of functions: they may hold what a fault has made of an answer, or the true one that hides it."""
    for module in _packages():
        for value in vars(module).values():
            if isinstance(value, functools._lru_cache_wrapper):
                value.cache_clear()


@contextmanager
def seeded(fault: Fault) -> Iterator[Calls]:
    """Put the wrong function wherever the true one is bound, count its calls, and put the true one back.

    Raises as :func:`stale` lists: a wrong version that does not fit would look like a fault that is caught.
    """
    owner, name = located(fault.target)
    true = vars(owner)[name]
    _bind(_plain(true), fault.broken)
    calls = Calls()

    def counted(function: Callable[..., Any]) -> Callable[..., Any]:
        wrong = fault.broken(function)

        @functools.wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            calls.count += 1
            return wrong(*arguments, **named)

        return call

    match true:
        case property():
            wrong: Any = property(counted(true.fget))
        case functools.cached_property():
            wrong = functools.cached_property(counted(true.func))
            wrong.__set_name__(owner, name)
        case classmethod():
            wrong = classmethod(counted(true.__func__))
        case staticmethod():
            wrong = staticmethod(counted(true.__func__))
        case _:
            wrong = counted(true)
    try:
        with pytest.MonkeyPatch.context() as patch:
            _empty_caches()
            patch.setattr(owner, name, wrong)
            for importer in _packages():
                for alias in [a for a, value in vars(importer).items() if value is true]:
                    patch.setattr(importer, alias, wrong)
            yield calls
    finally:
        for importer in _packages():  # one that was first loaded meanwhile has bound the wrong one
            for alias in [a for a, value in vars(importer).items() if value is wrong]:
                setattr(importer, alias, true)
        _empty_caches()


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Interrupt what takes more processor time by a :class:`TimeoutError`: a wrong search may be endless."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"no end within {seconds:g} processor seconds")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def found_wrong(
    fault: Fault, wrong: Callable[[str, str], list[str]], seconds: float
) -> tuple[int, list[str]]:
    """What ``wrong(solver, scene)`` finds with a fault in its one scene, and how often the fault was called.

    A run that breaks down or takes longer than so many seconds shows the fault, too.
    """
    (name,) = fault.scenes
    with seeded(fault) as calls:
        try:
            with np.errstate(all="ignore"), time_limit(seconds):
                missed = wrong(fault.solver, name)
        except (TimeoutError, ArithmeticError, ValueError) as error:
            missed = [type(error).__name__]
    return calls.count, missed
