"""Shares of running tasks, told by worker processes: a number for each task in memory they have in common.

There is no lock that a process could die with: a number has one writer, and is written as a whole.
"""

from __future__ import annotations

from collections.abc import MutableSequence
from dataclasses import dataclass
from multiprocessing.context import BaseContext

SLOTS = 1024
"""Tasks whose shares are told at a time; more are carried out, but told by their ends only."""

_told: MutableSequence[float] = []  # in a worker process: the memory that it has in common with its parent


def connect(told: MutableSequence[float]) -> None:
    """In a worker process: tell shares there."""
    global _told
    _told = told


@dataclass(frozen=True)
class ShareTeller:
    """Called in a worker process with the share of its task that is done.

    Parameters
    ----------
    slot : int
        Place of the task's share in the common memory.
    """

    slot: int

    def __call__(self, share: float) -> None:
        _told[self.slot] = share


class ToldShares:
    """Shares as the parent of the worker processes sees them.

    Parameters
    ----------
    context : BaseContext
        That starts the processes.
    """

    def __init__(self, context: BaseContext) -> None:
        self.memory: MutableSequence[float] = context.RawArray("d", SLOTS)
        self._free = list(range(SLOTS))

    def teller(self) -> ShareTeller | None:
        """For a further task; ``None`` if there is no place for its share."""
        if not self._free:
            return None
        slot = self._free.pop()
        self.memory[slot] = 0.0
        return ShareTeller(slot)

    def share(self, teller: ShareTeller) -> float:
        """What a task has told last; 0 before it begins."""
        return self.memory[teller.slot]

    def release(self, teller: ShareTeller) -> None:
        """The task has ended: its place is free."""
        self._free.append(teller.slot)
