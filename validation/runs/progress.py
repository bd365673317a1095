"""Progress of long work: a bar on a terminal, plain lines elsewhere. Always on stderr.

Work has phases (set-up, solving, drawing, writing), each with a bar of its own. While a phase says nothing,
a thread tells that it goes on, and for how long it has.
"""

from __future__ import annotations

import os
import shutil
import sys
import threading
import time
from contextlib import suppress
from typing import TextIO

from contact_scene.errors import printable

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


class Progress:
    """Call it with a fraction in 0..1 and, if there is something to report, a line of text.

    On a terminal one line is redrawn; elsewhere a line is written for every text, and without texts at most
    one for every tenth and every second, so that a log stays short. ``detail`` goes with the fraction and
    is no line of its own; ``None``: the time left, by the pace of the phase so far.
    """

    def __init__(self, label: str, phase: str = "", stream: TextIO | None = None) -> None:
        # The bar steers a terminal itself, past what keeps other text from doing so.
        self._stream: TextIO = getattr(sys.stderr, "unfiltered", sys.stderr) if stream is None else stream
        self._label, self._phase = printable(label), ""
        self._redraws = self._stream.isatty() and os.environ.get("TERM", "").lower() not in (
            "dumb",
            "unknown",
        )
        self._drawn = 0
        self._shown = self._began = time.monotonic()
        self._tenth, self._fraction, self._detail = 0, 0.0, ""
        self._lock, self._closed = threading.RLock(), threading.Event()
        self._watch: threading.Thread | None = None
        if phase:
            self.phase(phase)

    def phase(self, name: str) -> None:
        """Begin a phase of the work, at a fraction of zero."""
        with self._lock:
            self._phase, self._tenth, self._fraction, self._detail = name, 0, 0.0, ""
            self._began = self._shown = time.monotonic()
        if self._watch is None:
            self._watch = threading.Thread(target=self._keep_telling, daemon=True)
            self._watch.start()

    def __call__(self, fraction: float, text: str = "", detail: str | None = None) -> None:
        with self._lock:
            self._fraction, text = min(max(fraction, 0.0), 1.0), printable(text)
            if detail is None:
                detail = time_left(self._fraction, self._began) if self._phase else ""
            self._detail = detail
            silent = time.monotonic() - self._shown
            if self._redraws:
                if text or silent >= REDRAW:
                    self._redraw(text or detail)
            elif text:
                self._line(text)
            elif int(10 * self._fraction) > self._tenth and silent >= 1.0:
                self._tenth = int(10 * self._fraction)
                self._line(self._state)

    def tell(self) -> None:
        """Say that the phase goes on, if nothing was said for a while."""
        with self._lock:
            now = time.monotonic()
            lasted, silent = now - self._began, now - self._shown
            if self._redraws:
                if silent >= 1.0:
                    self._redraw(self._detail or f"{lasted:.0f} s")
            elif silent >= max(SILENCE, SILENT_SHARE * lasted):
                self._line(f"{self._state}, after {duration(lasted)}")

    def close(self) -> None:
        """Remove the bar."""
        self._closed.set()
        with self._lock:
            if self._drawn:
                self._write(f"\r{'':{self._drawn}}\r")

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *error: object) -> None:
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

    def _redraw(self, text: str) -> None:
        """The bar in place of the one before, cut to the terminal."""
        full = (self._stream.encoding or "ascii").lower().startswith("utf")
        bar = round(WIDTH * self._fraction) * ("\u2501" if full else "-")
        line = f"{self._name} {bar:{WIDTH}} {100 * self._fraction:3.0f} % {text[:TEXT]}"
        line = line[: shutil.get_terminal_size().columns - 1]
        self._write(f"\r{line:{self._drawn}}")
        self._drawn = len(line)

    def _line(self, text: str) -> None:
        self._write(f"{self._name}: {text}\n")

    def _write(self, text: str) -> None:
        """Write to a stream that may be closed, full or without a reader; none of it ends the work."""
        self._shown = time.monotonic()
        with suppress(OSError, ValueError):
            self._stream.write(text)
            self._stream.flush()


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
