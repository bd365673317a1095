"""One command at a time in a folder: what two of them write must not mix.

A lock of the kernel on a file that names its holder: it ends with the holder, however that ends, and whatever
the file says. On a file system without such locks the file itself is the lock; then one of a process that has
gone is taken over if it is of this host, and one that cannot be read after two seconds.
"""

from __future__ import annotations

import os
import socket
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from filelock import BaseFileLock, FileLock, Timeout

from contact_scene.errors import SceneError
from validation.runs.files import output_folder

LOCK_FILE = ".lock"
WAIT = 0.2
"""Seconds to wait for a holder that is about to leave."""
MARKER_WAIT = 3.0
"""The same where the file is the lock: ``filelock`` takes a damaged one over after two seconds without a
change."""


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
    with ExitStack() as held:
        if created:
            held.callback(_remove_if_empty, folder)
        _hold(folder, key, held)
        yield folder


def _remove_if_empty(folder: Path) -> None:
    with suppress(OSError):
        folder.rmdir()


def _hold(folder: Path, key: str, held: ExitStack) -> None:
    """Hold the folder until the stack is closed."""
    file, problem = folder / LOCK_FILE, f"{folder} is in use by another crosscontact"
    allowed = "another folder, or this one when it is done"
    lock = FileLock(file, poll_interval=WAIT / 4.0)
    try:
        _acquire(lock)
    except Timeout:
        problem += _holder(file)
        if _is_marker(lock):
            allowed += f"; if that has ended, remove {file}"
        raise SceneError(key, problem, allowed) from None
    except OSError as error:
        raise OSError(error.errno, f"no lock: {error.strerror}", str(file)) from None
    held.callback(_release, lock)


def _acquire(lock: BaseFileLock) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that the file is the lock
        try:
            lock.acquire(WAIT)
        except Timeout:
            if not _is_marker(lock):
                raise
            lock.acquire(MARKER_WAIT)
    if not _is_marker(lock):
        with suppress(OSError):  # who holds it is told as far as the disk takes it
            Path(lock.lock_file).write_text(f"{os.getpid()}\n{socket.gethostname()}\n", encoding="utf-8")


def _release(lock: BaseFileLock) -> None:
    if not _is_marker(lock):
        with suppress(OSError):  # while it is locked: one who waits for this file sees that it has gone
            Path(lock.lock_file).unlink()
    lock.release()


def _is_marker(lock: BaseFileLock) -> bool:
    """Whether the file is the lock, for want of one of the kernel: only then ``filelock`` reads it."""
    return hasattr(lock, "pid")


def _holder(file: Path) -> str:
    """Process and host that the file names, in brackets; empty if it names none."""
    with suppress(OSError, ValueError):
        process, host, *_ = file.read_text(encoding="utf-8").splitlines()
        if process.isdecimal() and host.isprintable():
            return f" (process {process} on {host.partition('?')[0]})"
    return ""
