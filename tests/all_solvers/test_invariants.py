"""Invariants of random scenes, the same for every solver; more than three hundred examples when slow."""

from __future__ import annotations

import zlib

import pytest
from hypothesis import given, seed, settings
from support.invariants.coarse_solvers import SOLVERS
from support.invariants.table import INVARIANTS


def examine(solver: str, name: str, examples: int, start: int) -> None:
    """Try an invariant on a number of random examples, others for every invariant and ``start``."""
    invariant = INVARIANTS[name]

    @seed(start + zlib.crc32(name.encode()))
    @settings(max_examples=examples)
    @given(invariant.arguments)
    def body(case: tuple) -> None:
        invariant.check(SOLVERS[solver], *case)

    body()


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant(solver: str, name: str) -> None:
    examine(solver, name, INVARIANTS[name].examples, 1)


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariant_often(solver: str, name: str) -> None:
    examine(solver, name, INVARIANTS[name].slow_examples, 2)
