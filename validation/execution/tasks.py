"""Independent tasks, and what comes of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any


class TaskEnding(StrEnum):
    """How a task ended."""

    ANSWERED = "answered"
    RAISED = "raised"
    DIED = "died"
    TIMED_OUT = "hung"


@dataclass(frozen=True)
class Task:
    """A function call that depends on no other task.

    Parameters
    ----------
    key : str
        Fingerprint of what is computed (see ``fingerprints``): two tasks with one key have one answer.
    label : str
        For progress.
    function, arguments : callable, tuple
        Picklable where an executor has processes. A value with an attribute ``breakdown`` that is not empty
        counts as a failure: it is not stored, so that the next attempt tries again.
    answer : type or annotation
        Kind of the answer, by which a stored one is read (see ``records``); ``None``: it is not stored.
    expected_seconds : float
        A guess; long tasks are submitted first.
    time_limit : float or None
        Processor time in seconds after which the task is given up; ``None``: never.
    tells_share : bool
        Whether the function takes a keyword ``tell_share``, to be called with the share of itself that is
        done, 0 to 1, or ``None``.
    """

    key: str
    label: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    answer: Any = None
    expected_seconds: float = 1.0
    time_limit: float | None = None
    tells_share: bool = False


@dataclass(frozen=True)
class TaskResult:
    """What came of a task.

    Parameters
    ----------
    task : Task
    value : object
        What the function returned; ``None`` if it did not return.
    failure, details : str
        Why there is no answer, in one line, and the traceback; empty if there is one.
    seconds : float
        Wall time of the call; 0 if its answer was stored before.
    stored : bool
        Whether the answer comes from the store.
    ending : TaskEnding
    """

    task: Task
    value: Any = None
    failure: str = ""
    details: str = ""
    seconds: float = 0.0
    stored: bool = False
    ending: TaskEnding = TaskEnding.ANSWERED


def one_line(error: Exception) -> str:
    """An exception in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")
