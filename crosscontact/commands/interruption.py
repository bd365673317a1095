"""What an interrupted command of many runs leaves, said on stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from validation.execution.signals import interrupting
from validation.execution.store import Store


@contextmanager
def telling_what_is_kept(folder: Path | None, store: Store) -> Iterator[None]:
    """Let an interruption pass and say what the same command finds.

    Parameters
    ----------
    folder : Path or None
        Of the command, if it has one.
    store : Store
        Of its finished parts.
    """
    try:
        with interrupting():
            yield
    except KeyboardInterrupt:
        if folder is None:
            words = "without --out DIR nothing is kept"
        elif store.holds_answers:
            words = f"{folder} holds what is done: the same command goes on with it"
        else:
            words = "no run is done: there is nothing to keep"
        print(f"crosscontact: {words}", file=sys.stderr)
        raise


def drop_former(folder: Path | None) -> None:
    """Remove half a run that an earlier version has left in a folder, unread, and say so."""
    former = None if folder is None else folder / "checkpoint"
    if former is not None and former.is_file():
        former.unlink()
        print(f"crosscontact: starting anew: {former} is of an earlier version", file=sys.stderr)
