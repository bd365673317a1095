"""Progress of many tasks: how many have ended, what share of the work is done, and what time is left.

A task counts by its forecast, and while it runs by the share of itself that it tells: among two hundred tasks
one may be a fifth of the work. Answers of an earlier attempt count as done, but say nothing about the pace.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence

from validation.execution.progress import time_left

TellProgress = Callable[[float, str, str], None]
"""Called with the share of the work that is done, 0 to 1, a line of text (empty where no task has ended), and
the time left in words (empty where too little is known)."""


class TaskProgress:
    """Tells how far tasks are.

    Parameters
    ----------
    expected : sequence of float
        Forecast of each task (s); only their ratios count.
    tell : callable or None
    done_before : int
        Tasks done in earlier calls that the same progress covers.
    total : int or None
        Tasks of all these calls together; ``None``: there are no others. Where there are, what they cost is
        not known, and no time left is told.
    """

    def __init__(
        self,
        expected: Sequence[float],
        tell: TellProgress | None,
        done_before: int = 0,
        total: int | None = None,
    ) -> None:
        self._expected, self._tell, self._done_before = expected, tell, done_before
        self._total = done_before + len(expected) if total is None else total
        self._count, self._work = 0, sum(expected)
        self._done = self._taken_over = 0.0
        self._running: dict[int, float] = {}
        self._began = time.monotonic()

    def take_over(self, task: int) -> None:
        """The answer of a task comes from an earlier attempt."""
        self._count += 1
        self._taken_over += self._expected[task]

    def finish(self, task: int, text: str) -> None:
        """A task has ended, as the text says."""
        self._running.pop(task, None)
        self._count += 1
        self._done += self._expected[task]
        self.tell(text)

    def update(self, shares: Mapping[int, float]) -> None:
        """Tasks that run have told the shares of them that are done."""
        self._running.update(shares)
        self.tell("")

    def tell(self, text: str) -> None:
        """Tell a line of text, with the number of tasks that have ended; none where shares have moved."""
        if self._tell is None:
            return
        done = self._done + sum(self._expected[task] * share for task, share in self._running.items())
        ours = (self._taken_over + done) / (self._work or 1.0)
        share = (self._done_before + ours * len(self._expected)) / max(self._total, 1)
        left = ""
        if self._total == len(self._expected):
            left = time_left(done / ((self._work - self._taken_over) or 1.0), self._began)
        ended = f"{self._done_before + self._count}/{self._total} {text}{', ' if left else ''}{left}"
        self._tell(share, ended if text else "", left)
