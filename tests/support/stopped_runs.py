"""Monitors that stop a run after so many calls, and comparisons to the last bit."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import fields

import numpy as np

from contact_scene import OutcomeKind, RunMonitor, Trace
from validation.execution import checked_pickle


class Stop:
    """Stops a run at its ``after``-th look (``None``: never) and keeps it as a file would."""

    def __init__(self, after: int | None = None, data: bytes | None = None) -> None:
        self.looks, self.data = 0, b""
        self._after = after
        self.start_state = None if data is None else checked_pickle.loads(data)

    def continue_set_up(self) -> bool:
        return True

    def continue_run(self, state: Callable[[], object]) -> bool:
        self.looks += 1
        if self.looks != self._after:
            return True
        self.data = checked_pickle.dumps(state())
        return False


def in_parts(run: Callable[[RunMonitor], Trace], strides: Iterable[int]) -> tuple[list[Trace], Trace]:
    """The run, stopped again and again after the given numbers of looks: what it left there, and its end."""
    left: list[Trace] = []
    data = None
    for stride in strides:
        stop = Stop(stride, data)
        trace = run(stop)
        if trace.outcome.kind is not OutcomeKind.INTERRUPTED:
            return left, trace
        left.append(trace)
        data = stop.data
    return left, run(Stop(None, data))


def assert_same(found: Trace, wanted: Trace) -> None:
    """All but the run time, to the last bit."""
    assert found.outcome == wanted.outcome
    assert found.counters == wanted.counters
    assert found.events == wanted.events
    assert_same_columns(found, wanted)
    assert len(found.profiles) == len(wanted.profiles)
    for one, other in zip(found.profiles, wanted.profiles, strict=True):
        for entry in fields(one):
            assert np.array_equal(getattr(one, entry.name), getattr(other, entry.name)), entry.name


def assert_same_columns(found: Trace, wanted: Trace) -> None:
    """All columns, to the last bit."""
    columns = wanted.columns()
    assert list(found.columns()) == list(columns)
    for name, column in found.columns().items():
        assert column.tobytes() == columns[name].tobytes(), name


def assert_beginning(part: Trace, whole: Trace) -> None:
    """An interrupted run has the rows of the whole one up to where it was stopped."""
    assert part.outcome.kind is OutcomeKind.INTERRUPTED
    assert not part.outcome.finished
    assert part.outcome.time == part.time[-1]
    for name in ("time", "penetration", "force", "contact_radius", "stored_energy"):
        mine, theirs = part.columns()[name], whole.columns()[name]
        assert mine.tobytes() == theirs[: len(mine)].tobytes(), name
