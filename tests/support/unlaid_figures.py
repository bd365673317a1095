"""Figures of few pixels, without layout and numbers at the axes, for tests that see nothing of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

BARE_AXES = {
    f"{axis}tick.{what}": False
    for axis, places in (("x", ("labelbottom", "minor.bottom")), ("y", ("labelleft", "minor.left")))
    for what in places
}


@contextmanager
def without_layout() -> Iterator[None]:
    """Figures made inside keep the margins that Matplotlib starts with, and number no ticks."""
    savefig = Figure.savefig
    with pytest.MonkeyPatch.context() as patch, rc_context(BARE_AXES):
        patch.setattr(ConstrainedLayoutEngine, "execute", lambda engine, figure: None)
        patch.setattr(Figure, "savefig", lambda *given, **how: savefig(*given, **how | {"dpi": 20}))
        yield
