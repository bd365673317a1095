"""Faults seeded in memory, one at a time; nothing on disk is touched."""

from __future__ import annotations

import functools
import importlib
import inspect
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
import pytest

PACKAGES = ("contact_scene", "bem_solver", "fem_solver", "meshes", "validation")


@dataclass(frozen=True)
class Fault:
    """A wrong version of one function.

    Parameters
    ----------
    solver : str
        Which solver suffers; of what all solvers share, the one it is shown with.
    name : str
        What is wrong, in words.
    target : str
        ``module:function`` or ``module:Class.method``; properties, class and static methods too.
    broken : callable
        From the true function to the wrong one.
    scenes : tuple of str
        Built-in scenes that have to show it, the cheapest first; none: those every fault is tried on.
    shared : bool
        Whether it sits in what all solvers share, so that none of them can serve as a reference.
    """

    solver: str
    name: str
    target: str
    broken: Callable[[Callable[..., Any]], Callable[..., Any]]
    scenes: tuple[str, ...] = ()
    shared: bool = False

    @property
    def key(self) -> str:
        """Name of the test."""
        return f"{'shared' if self.shared else self.solver}: {self.name}"


def registry(
    solver: str, package: str, faults: list[Fault] | None = None, shared: bool = False
) -> tuple[list[Fault], Callable[..., Any]]:
    """The faults of a solver, empty at first, and the decorator that adds one.

    ``@fault(name, target, scenes)`` of a function from the true function to the wrong one; ``target`` is
    relative to ``package``, as in ``module:Class.method``; ``scenes`` may be left out.

    Parameters
    ----------
    solver : str
        Which solver suffers, or shows what all share.
    package : str
        Where its functions are.
    faults : list of Fault, optional
        To be added to.
    shared : bool
        Whether all solvers share the function.

    Returns
    -------
    faults : list of Fault
    fault : callable
        The decorator.
    """
    faults = [] if faults is None else faults

    def fault(name: str, target: str, scenes: tuple[str, ...] = ()) -> Callable[..., Any]:
        def register(broken: Callable[..., Any]) -> Callable[..., Any]:
            faults.append(Fault(solver, name, f"{package}.{target}", broken, scenes, shared))
            return broken

        return register

    return faults, fault


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
    """Faults whose function is gone, or takes what its wrong version does not take; one line each.

    The latter would break every run down, which looks like a fault that is caught.
    """
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
    """Put the wrong function wherever the true one is bound, count its calls, and put the true one back."""
    owner, name = located(fault.target)
    true = vars(owner)[name]
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
