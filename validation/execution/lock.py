"""One command at a time in a folder: what two of them write must not mix.

The lock is the system's own and goes with the process that holds it, however that ends; the file only says
who it is. On systems without such locks, and on file systems that refuse them, nobody is kept out.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from contact_scene.errors import SceneError
from validation.execution.files import output_folder

try:
    import fcntl
except ImportError:  # not a Unix
    fcntl = None  # type: ignore[assignment]

FILE = ".lock"


@contextmanager
def held(out: str | os.PathLike[str], key: str = "--out") -> Iterator[Path]:
    """The folder, made if need be and ours alone for a while; one that stays empty is removed again.

    Raises
    ------
    SceneError
        If the folder cannot be written, or another process holds it.
    """
    missing = not os.path.lexists(out)
    folder = output_folder(out, key)
    path = folder / FILE
    descriptor = _locked(path, folder, key)
    try:
        yield folder
    finally:
        path.unlink(missing_ok=True)
        os.close(descriptor)
        if missing:
            with suppress(OSError):
                folder.rmdir()


def _locked(path: Path, folder: Path, key: str) -> int:
    """Descriptor of the locked file, which is closed to unlock it."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            if fcntl is not None:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(descriptor, 32).decode(errors="replace").strip()
            os.close(descriptor)
            raise SceneError(
                key,
                f"{folder} is in use by another crosscontact{f' (process {holder})' if holder else ''}",
                "another folder, or this one when it is done",
            ) from None
        except OSError:  # a file system without locks
            pass
        with suppress(OSError):
            if os.path.samestat(os.fstat(descriptor), os.stat(path)):  # not one that was just removed
                os.truncate(descriptor, 0)
                os.write(descriptor, f"{os.getpid()}\n".encode())
                return descriptor
        os.close(descriptor)
