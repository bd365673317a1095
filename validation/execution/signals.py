"""SIGINT (Ctrl-C) and SIGTERM: both interrupt, and a single run ends with its present step."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def interrupting() -> Iterator[None]:
    """Either signal raises ``KeyboardInterrupt``, whatever it has become by the end of the block."""
    with _handled(_interrupt):
        yield


def handle_outside(code: int | None = None) -> None:
    """In a process of our own: either signal interrupts, or, given an exit code, ends the process with it.

    What stands before a command and after it, where the system would end the process by the signal.
    """
    for number in _not_ignored():
        signal.signal(number, _interrupt if code is None else lambda *_: os._exit(code))


@contextmanager
def deferred() -> Iterator[None]:
    """Either signal waits for the end of the block, which could not be interrupted cleanly."""
    caught: list[int] = []
    try:
        with _handled(lambda number, frame: caught.append(number)):
            yield
    finally:
        if caught:
            signal.raise_signal(caught[0])


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Threads begun in the block, and the processes that they start, are not interrupted by Ctrl-C."""
    if not hasattr(signal, "pthread_sigmask"):  # not a Unix
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class GracefulStop:
    """Signal handler that has a run end with its present step.

    Before the first step, and at a second signal, it interrupts at once.
    """

    def __init__(self) -> None:
        self.requested = self._stepping = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.requested or not self._stepping:
            _interrupt(number, frame)
        self.requested = True

    def monitor(self) -> bool:
        """Whether the run is to continue, asked by it between two steps."""
        self._stepping = True
        return not self.requested

    @contextmanager
    def handling_signals(self) -> Iterator[None]:
        """Handle both signals here."""
        with _handled(self):
            yield


def _not_ignored() -> list[signal.Signals]:
    return [number for number in _SIGNALS if signal.getsignal(number) not in (signal.SIG_IGN, None)]


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():  # where no handler may be set
        yield
        return
    interrupted = False

    def handle(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        try:
            handler(number, frame)
        except KeyboardInterrupt:
            interrupted = True
            raise

    before = {number: signal.signal(number, handle) for number in _not_ignored()}
    try:
        yield
    except Exception as error:
        if interrupted:  # libraries turn the interruption into errors of their own, as imports of VTK do
            raise KeyboardInterrupt from error
        raise
    finally:
        for number, old in before.items():
            signal.signal(number, old)
