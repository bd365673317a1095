"""Invariants of random scenes, the same for every solver; more than a hundred and fifty examples when slow.

Each is a check of :mod:`support.invariants.checks`, which raises ``AssertionError`` where it does not hold.
Invariants of the same arguments are asked of the same examples, so that these are solved once.
"""

from __future__ import annotations

import zlib

import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st
from support.invariants.coarse_solvers import SOLVERS
from support.invariants.table import INVARIANTS, Invariant


def counterexample(solver: str, name: str, examples: int, start: int) -> str:
    """What the smallest random example says that breaks an invariant; empty if none of them does.

    Parameters
    ----------
    solver, name : str
        Of the solver and of the invariant.
    examples : int
        How many are tried, others for every kind of arguments and ``start``.
    start : int

    Returns
    -------
    str
        The example as Hypothesis shows it, and the assertion that fails.
    """
    invariant = INVARIANTS[name]
    first = next(other for other, one in INVARIANTS.items() if one.arguments is invariant.arguments)

    @seed(start + zlib.crc32(first.encode()))
    @settings(max_examples=examples)
    @given(invariant.arguments)
    def body(case: tuple) -> None:
        invariant.check(SOLVERS[solver], *case)

    try:
        body()
    except AssertionError as error:
        return "\n".join((f"{type(error).__name__}: {error}", *getattr(error, "__notes__", ())))
    return ""


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant(solver: str, name: str) -> None:
    assert counterexample(solver, name, INVARIANTS[name].examples, 1) == ""


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant_often(solver: str, name: str) -> None:
    assert counterexample(solver, name, INVARIANTS[name].slow_examples, 2) == ""


def test_a_broken_invariant_is_told_with_its_example(monkeypatch):
    def holds_below_three(solver: object, number: int) -> None:
        assert number < 3, "three is too much"

    broken = Invariant(holds_below_three, st.tuples(st.integers(3, 9)), 1, 1)
    monkeypatch.setitem(INVARIANTS, "broken", broken)
    told = counterexample("reference", "broken", 1, 1)
    assert "three is too much" in told
    assert "case=(3,)" in told
