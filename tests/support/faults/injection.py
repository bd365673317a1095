"""Faults seeded into the solvers in memory, one at a time; nothing on disk is touched."""

from __future__ import annotations

import functools
import importlib
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import pytest

PACKAGES = ("bem_solver", "fem_solver", "validation.reference")


@dataclass(frozen=True)
class Fault:
    """A wrong version of one function.

    Parameters
    ----------
    solver : str
        Which solver suffers.
    name : str
        What is wrong, in words.
    target : str
        ``module:function`` or ``module:Class.method``; properties, class and static methods too.
    broken : callable
        From the true function to the wrong one.
    """

    solver: str
    name: str
    target: str
    broken: Callable[[Callable[..., Any]], Callable[..., Any]]

    @property
    def key(self) -> str:
        """Name of the test."""
        return f"{self.solver}: {self.name}"


def registry(solver: str, package: str) -> tuple[list[Fault], Callable[..., Any]]:
    """The faults of a solver, empty at first, and the decorator that adds one.

    ``@fault(name, target)`` of a function from the true function to the wrong one; ``target`` is relative to
    ``package``, as in ``module:Class.method``.
    """
    faults: list[Fault] = []

    def fault(name: str, target: str) -> Callable[..., Any]:
        def register(broken: Callable[..., Any]) -> Callable[..., Any]:
            faults.append(Fault(solver, name, f"{package}.{target}", broken))
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


def missing(faults: Iterable[Fault]) -> list[str]:
    """Faults whose function no longer exists under the name they state, one line each."""
    lines = []
    for fault in faults:
        try:
            located(fault.target)
        except (ImportError, AttributeError, KeyError) as error:
            lines.append(f"{fault.target} ({fault.key}): {type(error).__name__}: {error}")
    return lines


@dataclass
class Calls:
    """How often a wrong function has been called."""

    count: int = 0


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
        case classmethod():
            wrong = classmethod(counted(true.__func__))
        case staticmethod():
            wrong = staticmethod(counted(true.__func__))
        case _:
            wrong = counted(true)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(owner, name, wrong)
        for importer in [m for n, m in sys.modules.items() if n.startswith(PACKAGES)]:
            for alias in [a for a, value in vars(importer).items() if value is true]:
                patch.setattr(importer, alias, wrong)
        yield calls


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
