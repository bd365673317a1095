"""Invariants of random scenes, the same for every solver; more than a hundred and fifty examples when slow.

Each is a check of :mod:`support.invariants.checks`, which raises ``AssertionError`` where it does not hold.
Invariants of the same arguments are asked of the same examples, so that these are solved once.
"""

from __future__ import annotations

import zlib

import pytest
from hypothesis import given, seed, settings
from support.invariants.coarse_solvers import SOLVERS
from support.invariants.table import INVARIANTS


def holding(solver: str, name: str, examples: int, start: int) -> int:
    """For how many random examples it holds, others for every kind of arguments and ``start``."""
    invariant, held = INVARIANTS[name], []
    first = next(other for other, one in INVARIANTS.items() if one.arguments is invariant.arguments)

    @seed(start + zlib.crc32(first.encode()))
    @settings(max_examples=examples)
    @given(invariant.arguments)
    def body(case: tuple) -> None:
        invariant.check(SOLVERS[solver], *case)
        held.append(case)

    body()
    return len(held)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant(solver: str, name: str) -> None:
    assert holding(solver, name, INVARIANTS[name].examples, 1) >= INVARIANTS[name].examples


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant_often(solver: str, name: str) -> None:
    assert holding(solver, name, INVARIANTS[name].slow_examples, 2) >= INVARIANTS[name].slow_examples
