"""Progress of long work: a bar on a terminal, plain lines elsewhere. Always on stderr.

Work has phases (set-up, solving, drawing, writing), each with a bar of its own. While a phase says nothing,
a thread tells that it goes on, and for how long it has.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from contextlib import suppress
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

from contact_scene.errors import printable

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

WIDTH = 30
"""Characters of a full bar."""
TEXT = 60
"""Characters of the text beside the bar, at most."""
REDRAW = 0.1
"""Seconds between two drawings of the bar where there is no new text."""
SILENCE = 10.0
"""Seconds without a line after which a phase is said to go on, where there is no terminal."""
SILENT_SHARE = 0.1
"""The same over the time since the phase began, so that the log of a long run stays short."""
AFTER = 1.0
"""Seconds of a phase before which a rate says nothing."""
LEAST_SHARE = 0.05
"""Share of the work that has to be done before the time left is told: of less, what was waited for
at the begin would be taken for the pace of more than twenty times as much."""
GONE = (OSError, ValueError)
"""What a stream raises that is closed, full or without a reader. None of it ends the work."""


class Progress:
    """Call it with a fraction in 0..1 and, if there is something to report, a line of text.

    On a terminal one line is redrawn; elsewhere a line is written for every text, and without texts at most
    one for every tenth and every second, so that a log stays short. ``detail`` goes with the fraction and
    is no line of its own; ``None``: the time left, by the pace of the phase so far.
    """

    def __init__(self, label: str, stream: TextIO | None = None) -> None:
        # The bar steers a terminal itself, past what keeps other text from doing so.
        self._stream: TextIO = getattr(sys.stderr, "unfiltered", sys.stderr) if stream is None else stream
        self._label = printable(label)
        self._bar = _bar(self._stream)
        self._shown = self._began = time.monotonic()
        self._tenth = 0
        self._fraction, self._detail = 0.0, ""
        if self._bar is not None:
            self._bar.add_task(label, total=1.0, text="")
        self._phase = ""
        self._lock = threading.RLock()
        self._closed = threading.Event()
        self._watch: threading.Thread | None = None

    def phase(self, name: str) -> None:
        """Begin a phase of the work, at a fraction of zero."""
        with self._lock:
            self._phase, self._tenth, self._fraction, self._detail = name, 0, 0.0, ""
            self._began = self._shown = time.monotonic()
            if self._bar is not None:
                self._bar.update(self._bar.task_ids[0], description=self._name, completed=0.0, text="")
        if self._watch is None:
            self._watch = threading.Thread(target=self._keep_telling, daemon=True)
            self._watch.start()

    def __call__(self, fraction: float, text: str = "", detail: str | None = None) -> None:
        with self._lock:
            self._fraction, text = min(max(fraction, 0.0), 1.0), printable(text)
            if detail is None:
                detail = time_left(self._fraction, self._began) if self._phase else ""
            self._detail = detail
            now = time.monotonic()
            if self._bar is not None:
                if text or now - self._shown >= REDRAW:
                    self._redraw(self._bar, text or detail, now)
            elif text:
                self._write(text, now)
            elif int(10 * self._fraction) > self._tenth and now - self._shown >= 1.0:
                self._tenth = int(10 * self._fraction)
                self._write(self._state, now)

    def tell(self) -> None:
        """Say that the phase goes on, if nothing was said for a while."""
        with self._lock:
            now = time.monotonic()
            lasted = now - self._began
            if self._bar is not None:
                if now - self._shown >= 1.0:
                    self._redraw(self._bar, self._detail or f"{lasted:.0f} s", now)
            elif now - self._shown >= max(SILENCE, SILENT_SHARE * lasted):
                self._write(f"{self._state}, after {duration(lasted)}", now)

    def close(self) -> None:
        """Remove the bar."""
        self._closed.set()
        with self._lock:
            if self._bar is not None:
                with suppress(*GONE):
                    self._bar.stop()

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def _name(self) -> str:
        return f"{self._label}: {self._phase}" if self._phase else self._label

    @property
    def _state(self) -> str:
        percent = f"{100 * self._fraction:.0f} %"
        return f"{percent}: {self._detail}" if self._detail else percent

    def _keep_telling(self) -> None:
        while not self._closed.wait(1.0):
            self.tell()

    def _redraw(self, bar: Bar, text: str, now: float) -> None:
        self._shown = now
        with suppress(*GONE):
            bar.start()
            bar.update(bar.task_ids[0], completed=self._fraction, text=text[:TEXT], refresh=True)

    def _write(self, text: str, now: float) -> None:
        self._shown = now
        with suppress(*GONE):
            self._stream.write(f"{self._name}: {text}\n")
            self._stream.flush()


def _bar(stream: TextIO) -> Bar | None:
    """A bar of one line, where a terminal can draw it again."""
    if not stream.isatty() or os.environ.get("TERM", "").lower() in ("dumb", "unknown"):
        return None
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(WIDTH),
        TaskProgressColumn(),
        TextColumn("{task.fields[text]}", markup=False),
        console=Console(file=stream, highlight=False),
        auto_refresh=False,
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )


class StepProgress:
    """Progress of a run by the share of its loading that is done: what a solver calls after every step.

    ``after`` is the phase that begins with the end of the run.
    """

    def __init__(self, progress: Progress, after: str) -> None:
        self._progress, self._after = progress, after
        self._steps, self._began = 0, 0.0

    def __call__(self, share: float) -> None:
        if self._steps == 0:
            self._progress.phase("solving")
            self._began = time.monotonic()
        self._steps += 1
        left = time_left(share, self._began)
        self._progress(share, detail=", ".join(filter(None, (f"{self._steps} steps", left))))
        if share >= 1.0:
            self._progress.phase(self._after)


def time_left(done: float, began: float) -> str:
    """About how long work that began at a time of the clock still takes, a share of it being done, in words.

    Empty while that share, or the time it took, is too small to tell.
    """
    lasted = time.monotonic() - began
    if lasted < AFTER or not LEAST_SHARE <= done < 1.0:
        return ""
    return f"about {duration(lasted * (1.0 - done) / done)} left"


def duration(seconds: float) -> str:
    """Seconds in words: seconds, minutes or hours."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5970.0 else f"{seconds / 3600.0:.1f} h"
