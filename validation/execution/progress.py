"""Progress of long work: a bar on a terminal, plain lines elsewhere. Always on stderr."""

from __future__ import annotations

import sys
import time
from typing import TextIO

from rich.console import Console
from rich.progress import BarColumn, TaskProgressColumn, TextColumn
from rich.progress import Progress as RichProgress

WIDTH = 30
"""Characters of a full bar."""
REDRAW = 0.1
"""Seconds between two drawings of the bar where there is no new text."""


class Progress:
    """Call it with a fraction in 0..1 and, if there is something to report, a line of text.

    On a terminal one line is redrawn; elsewhere a line is written for every text, and without texts at most
    one for every tenth and every second, so that a log stays short.
    """

    def __init__(self, label: str, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._label = label
        console = Console(file=self._stream, highlight=False)
        self._terminal = console.is_terminal and not console.is_dumb_terminal
        self._shown = time.monotonic()
        self._tenth = 0
        columns = (TextColumn("{task.description}", markup=False), BarColumn(WIDTH), TaskProgressColumn())
        self._bar = RichProgress(
            *columns,
            TextColumn("{task.fields[text]}", markup=False),
            console=console,
            auto_refresh=False,
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._task = self._bar.add_task(label, total=1.0, text="")

    def __call__(self, fraction: float, text: str = "") -> None:
        fraction = min(max(fraction, 0.0), 1.0)
        now = time.monotonic()
        if self._terminal:
            if text or now - self._shown >= REDRAW:
                self._bar.start()
                self._bar.update(self._task, completed=fraction, text=text[:40], refresh=True)
                self._shown = now
        elif text:
            self._write(text)
        elif int(10 * fraction) > self._tenth and now - self._shown >= 1.0:
            self._tenth, self._shown = int(10 * fraction), now
            self._write(f"{100 * fraction:.0f} %")

    def close(self) -> None:
        """Remove the bar."""
        if self._terminal:
            self._bar.stop()

    def _write(self, text: str) -> None:
        self._stream.write(f"{self._label}: {text}\n")
        self._stream.flush()
