"""A process that answers one question at a time and can be killed if it takes too long.

A pool cannot give up on one of its processes without losing all of them, and a run that hangs must be told
from one that works; hence one pipe to one process, started anew after it died or was killed.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from validation.execution.processes import begin

PATIENCE = 10.0  # clock over processor time, at most
LOOK = 0.5  # seconds between two looks at what a process has spent


class Fate(StrEnum):
    """What became of a question."""

    ANSWERED = "answered"
    RAISED = "raised"
    DIED = "died"
    HUNG = "hung"


@dataclass(frozen=True)
class Reply:
    """``value`` if answered; else what was raised, in one line and in full, or how the process ended."""

    fate: Fate
    value: Any = None
    said: str = ""
    details: str = ""


class Retired(RuntimeError):
    """Asked after, or stopped by, :meth:`Worker.retire`."""


class Worker:
    """One process, started when it is first asked something; asked by one thread, retired by any."""

    def __init__(self) -> None:
        self._retired = False
        self._lock = threading.Lock()
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def ask(self, function: Callable[[Any], Any], argument: Any, seconds: float) -> Reply:
        """``function(argument)`` in the process; both must be picklable.

        Given up after ``seconds`` of processor time, which a busy machine does not change, and in any case
        after ``PATIENCE`` times as long by the clock: what sleeps or waits uses none.
        """
        pipe = self._pipe or self._start()
        try:
            pipe.send((function, argument))
            if not self._answers(pipe, seconds):
                self.close()
                return Reply(Fate.HUNG, said=f"no answer within {seconds:g} s; killed")
            return pipe.recv()
        except (EOFError, OSError):
            code = self._exit_code()
            self.close()
            if self._retired:
                raise Retired from None
            return Reply(Fate.DIED, said=f"the process ended with code {code}")

    def _answers(self, pipe: Connection, seconds: float) -> bool:
        began, before = time.monotonic(), self._spent()
        while not pipe.poll(min(seconds, LOOK)):
            clock = time.monotonic() - began
            if clock >= PATIENCE * seconds or self._spent() - before >= seconds:
                return False
        return True

    def _spent(self) -> float:
        """Processor time of the process; what the clock says where the system does not tell."""
        pid = None if self._process is None else self._process.pid
        try:
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        except (OSError, ValueError, IndexError, AttributeError):
            return time.monotonic()

    def retire(self) -> None:
        """End the process for good, whatever it is doing; who waits for its answer gets :class:`Retired`."""
        with self._lock:
            self._retired = True
            if self._process is not None:
                self._process.kill()

    def close(self) -> None:
        """End the process; the next question starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None

    def _start(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        with self._lock:
            if self._retired:
                raise Retired
            self._pipe, other = context.Pipe()
            self._process = context.Process(target=_serve, args=(other,), daemon=True)
            self._process.start()
        other.close()
        return self._pipe

    def _exit_code(self) -> int | None:
        if self._process is None:
            return None
        self._process.join(10.0)
        return self._process.exitcode


def _serve(pipe: Connection) -> None:
    """Answer until the other end is closed; interrupts are the parent's business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    begin()
    while True:
        try:
            function, argument = pipe.recv()
        except EOFError:
            return
        try:
            reply = Reply(Fate.ANSWERED, function(argument))
        except Exception as error:
            said = f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")
            reply = Reply(Fate.RAISED, said=said, details=traceback.format_exc())
        pipe.send(reply)
