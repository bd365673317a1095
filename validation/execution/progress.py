"""Progress of long work: a bar on a terminal, plain lines elsewhere. Always on stderr."""

from __future__ import annotations

import sys
import time
from typing import TextIO

WIDTH = 30


class Progress:
    """Call it with a fraction in 0..1 and, if there is something to tell, a line of text.

    On a terminal one line is redrawn; elsewhere a line is written for every text, and without texts at most
    one for every tenth and every second, so that a log stays short.
    """

    def __init__(self, label: str, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._label = label
        self._terminal = self._stream.isatty()
        self._shown = time.monotonic()
        self._tenth = 0
        self._drawn = False

    def __call__(self, fraction: float, text: str = "") -> None:
        fraction = min(max(fraction, 0.0), 1.0)
        now = time.monotonic()
        if self._terminal:
            if text or now - self._shown >= 0.1:
                self._draw(fraction, text)
                self._shown = now
        elif text:
            self._write(f"{self._label}: {text}\n")
        elif int(10 * fraction) > self._tenth and now - self._shown >= 1.0:
            self._tenth, self._shown = int(10 * fraction), now
            self._write(f"{self._label}: {100 * fraction:.0f} %\n")

    def close(self) -> None:
        """Remove the bar."""
        if self._drawn:
            self._write("\r\x1b[K")
            self._drawn = False

    def _draw(self, fraction: float, text: str) -> None:
        full = round(WIDTH * fraction)
        bar = "█" * full + "·" * (WIDTH - full)
        try:
            bar.encode(self._stream.encoding or "ascii")
        except UnicodeEncodeError:
            bar = "#" * full + "." * (WIDTH - full)
        self._write(f"\r\x1b[K{self._label} {bar} {100 * fraction:3.0f} % {text[:40]}")
        self._drawn = True

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()
