"""SIGINT (Ctrl-C) and SIGTERM: both interrupt, and a run that is watched ends with its step."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def interrupting() -> Iterator[None]:
    """Either signal raises ``KeyboardInterrupt``."""
    with _handled(_interrupt):
        yield


class Patience:
    """Waits for the end of a step where ``patient()`` says so; a second signal interrupts at once."""

    def __init__(self) -> None:
        self.asked = False
        self.patient: Callable[[], bool] = lambda: False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.asked or not self.patient():
            _interrupt(number, frame)
        self.asked = True

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Both signals come here."""
        with _handled(self):
            yield


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():  # where no handler may be set
        yield
        return
    heeded = [number for number in _SIGNALS if signal.getsignal(number) not in (signal.SIG_IGN, None)]
    before = {number: signal.signal(number, handler) for number in heeded}
    try:
        yield
    finally:
        for number, old in before.items():
            signal.signal(number, old)
