"""How a long run is watched from outside: kept, told to stop, and gone on with. No numerical method.

A solver asks its watch between attempts at a step, where nothing is half done. Whatever it answers, the run
does not change: looking never alters a number, and a run that goes on from a kept state gives the bits it
would have given without the stop. What a state holds is the solver's own affair.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Watch(Protocol):
    """Looks at a run now and then."""

    @property
    def kept(self) -> Any:
        """State to go on from, of the same scene, options and code; ``None`` to start at the beginning."""
        ...

    def goes_on(self, state: Callable[[], Any]) -> bool:
        """Whether the run is to go on; if not, it ends as interrupted.

        ``state()`` is all that the run has become, and shares what will change: keep a copy of it.
        """
        ...
