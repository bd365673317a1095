"""One command at a time in a folder: what two of them write must not mix.

The lock is a file that names its holder. One that a killed process left is taken over.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import SoftFileLock, Timeout

from contact_scene.errors import SceneError
from validation.execution.files import output_folder

LOCK_FILE = ".lock"
WAIT = 0.2
"""Seconds to wait for a folder: enough to find that the holder has gone, and to try again."""


@contextmanager
def locked_folder(out: str | os.PathLike[str], key: str = "--out") -> Iterator[Path]:
    """The folder, made if need be, for this process alone; removed again if it was made and stays empty.

    Raises
    ------
    SceneError
        If the folder cannot be written, or another process holds it.
    """
    created = not os.path.lexists(out)
    folder = output_folder(out, key)
    lock = SoftFileLock(folder / LOCK_FILE, timeout=WAIT)
    try:
        lock.acquire(poll_interval=WAIT / 4.0)
    except Timeout:
        holder = f" (process {lock.pid})" if lock.pid else ""
        raise SceneError(
            key,
            f"{folder} is in use by another crosscontact{holder}",
            "another folder, or this one when it is done",
        ) from None
    try:
        yield folder
    finally:
        lock.release()
        if created:
            with suppress(OSError):
                folder.rmdir()
