"""This process: its signals and its memory.

SIGINT (Ctrl-C) and SIGTERM interrupt, and a single run ends with its present step.

By default glibc hands freed memory back to the system as soon as a few arrays of 100 KiB are gone, and gets
it again page by page in the next step: up to a sixth of the time of a long run. How much it keeps follows the
largest block that it has seen freed (M_MMAP_THRESHOLD in mallopt(3)). Without effect in other C libraries.
"""

from __future__ import annotations

import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
STATUS = Path("/proc/self/status")
_raised: list[int] = []
"""Signals that have interrupted the present block; a destructor that one comes in swallows the exception."""
LARGE = 2**25 - 2**16
"""Bytes; glibc ignores freed blocks beyond 32 MiB."""


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


def raise_swallowed() -> None:
    """Interrupt if a signal has, and a destructor or a library's callback has swallowed the exception."""
    if _raised:
        raise KeyboardInterrupt


def caught() -> None:
    """Let tasks begin after an interruption that has been caught; the next signal interrupts them again."""
    _raised.clear()


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
            _raised.append(number)
            raise

    def unraisable(told: sys.UnraisableHookArgs) -> None:  # an interruption is raised again, and told then
        if not (_raised and told.exc_type is KeyboardInterrupt):
            hook(told)

    hook = sys.unraisablehook
    before = {number: signal.signal(number, handle) for number in _not_ignored()}
    sys.unraisablehook = unraisable
    try:
        yield
    except Exception as error:
        if interrupted:  # libraries turn the interruption into errors of their own, as imports of VTK do
            raise KeyboardInterrupt from error
        raise
    finally:
        _raised.clear()
        sys.unraisablehook = hook
        for number, old in before.items():
            signal.signal(number, old)


def keep_freed() -> None:
    """Show the allocator a large block that is freed; its pages are never touched."""
    block = bytes(LARGE)
    del block


def peak_memory() -> int | None:
    """Most bytes that this process has held in memory at a time; ``None`` where the system does not say.

    Not from ``getrusage``: on Linux a process begins there with what its parent held.
    """
    try:
        found = re.search(r"^VmHWM:\s+(\d+) kB$", STATUS.read_text(encoding="ascii"), re.MULTILINE)
    except OSError:
        return None
    return None if found is None else 1024 * int(found[1])
