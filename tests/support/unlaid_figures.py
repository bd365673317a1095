"""Figures without constrained layout, half the time of drawing, for tests that look at no positions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure


@contextmanager
def without_layout() -> Iterator[None]:
    """Figures made inside keep the margins that Matplotlib starts with."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "set_layout_engine", lambda *arguments, **named: None)
        yield
