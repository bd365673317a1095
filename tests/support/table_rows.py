"""Rows of a large table as parameters of a test: some among the slow tests, all the others on demand."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

STRIDE = 6
"""Every so many rows one is tried whenever the slow tests are; the marker ``exhaustive`` has the others."""


def sampled(rows: Iterable[Any], stride: int = STRIDE) -> list[Any]:
    """Parameters of a test, marked ``slow`` or ``exhaustive``; a row of several is a tuple."""
    marks = (pytest.mark.slow, pytest.mark.exhaustive)
    each = (row if isinstance(row, tuple) else (row,) for row in rows)
    return [pytest.param(*row, marks=marks[index % stride > 0]) for index, row in enumerate(each)]
