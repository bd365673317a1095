"""The threads of the linear algebra: one during a run, whatever the machine has."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from threadpoolctl import ThreadpoolController


class _LinearAlgebraThreads:
    """Runs that are under way in this process, and the limit they share on the threads of BLAS."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.runs = 0
        self.restore: Callable[[], None] | None = None
        self._libraries: tuple[int, ThreadpoolController] | None = None

    def libraries(self) -> ThreadpoolController:
        """Those that are loaded; to look them up takes milliseconds: again only if a module was imported."""
        modules = len(sys.modules)
        if self._libraries is None or self._libraries[0] != modules:
            self._libraries = (modules, ThreadpoolController())
        return self._libraries[1]


_THREADS = _LinearAlgebraThreads()


@contextmanager
def single_threaded() -> Iterator[None]:
    """Limit BLAS to one thread during a run; also a decorator: ``@single_threaded()``.

    The dense systems of a run are small: further threads wait for each other, at several times the processor
    time, and the last bits of a result would depend on their number. The first of several simultaneous runs
    sets the limit, the last one restores what was there.
    """
    with _THREADS.lock:
        if _THREADS.runs == 0:
            _THREADS.restore = _THREADS.libraries().limit(limits=1, user_api="blas").restore_original_limits
        _THREADS.runs += 1
    try:
        yield
    finally:
        with _THREADS.lock:
            _THREADS.runs -= 1
            if _THREADS.runs == 0 and _THREADS.restore is not None:
                _THREADS.restore()
                _THREADS.restore = None
