"""Files: text read with one-line errors, atomic writing, columns as CSV."""

from __future__ import annotations

import errno
import glob
import os
import uuid
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError
from contact_scene.value_checks import of_class

TOO_LARGE = 10_000_000
"""Bytes; a scene or a table larger than this is a mistake."""


def as_path(given: Any, key: str = "path", allowed: str = "the path of a file") -> Path:
    """What names a file or a folder, as a path; an empty name, which would be the current folder, is an
    error."""
    of_class(given, key, (str, os.PathLike), allowed)
    if not os.fspath(given):
        raise SceneError(key, "is empty", allowed)
    return Path(given)


def as_target(given: Any) -> Path:
    """What names a regular file that is there or can be made, as a path; anything else is an error."""
    target, problem = as_path(given, "path"), ""
    try:
        target.stat()
    except FileNotFoundError:
        if not target.parent.is_dir():
            problem = "is in no folder that exists"
    except (OSError, ValueError) as error:
        problem = f"cannot be written: {getattr(error, 'strerror', None) or error}"
    else:
        if _is_no_file(target):
            problem = "is a folder" if target.is_dir() else "is not a regular file"
    if not problem and not os.access(target.parent, os.W_OK):
        problem = "is in a folder that cannot be written to"
    if problem:
        allowed = "the path of a file, in a folder that exists and can be written to"
        raise SceneError("path", f"{target} {problem}", allowed)
    return target


def _is_no_file(target: Path) -> bool:
    """Whether something else than a regular file stands there, which a new file would take away."""
    return not target.name or (target.exists() and not target.is_file())


def read_text(file: Path, most: int = TOO_LARGE) -> str:
    """The text of a regular UTF-8 file of at most ``most`` bytes, line ends as ``\\n``."""
    name = str(file)
    try:
        if file.exists() and not file.is_file():  # never wait on a pipe or read a device without end
            raise SceneError("", "is not a regular file", "a text file", name)
        with file.open("rb") as stream:
            data = stream.read(most + 1)
        if len(data) > most:
            size = f"{most:,}".replace(",", " ")
            problem = f"is larger than {most // 1_000_000} MB"
            raise SceneError("", problem, f"a scene or a table of at most {size} bytes", name)
        text = data.decode("utf-8-sig")
    except SceneError:
        raise
    except UnicodeDecodeError:
        raise SceneError("", "not a text file (no UTF-8)", "UTF-8 text", name) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError("", f"cannot be read: {reason}", "an existing, readable file", name) from None
    return text.replace("\r\n", "\n")


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a file so that it appears whole or not at all, also when the program is killed; text as UTF-8.

    Raises
    ------
    OSError
        With the name of the file; also where a device or a pipe stands.
    """
    target = Path(path)
    if _is_no_file(target):
        raise OSError(errno.EINVAL, "is not the name of a regular file", str(target))
    partial = target.with_name(f".{target.name}.{uuid.uuid4().hex}.part")
    try:
        with partial.open("xb") as stream:
            stream.write(content.encode("utf-8") if isinstance(content, str) else content)
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(target)
    except OSError as error:
        if error.errno is not None and error.filename is None:  # a full disk is told by its number alone
            error.filename = str(target)
        raise
    finally:
        partial.unlink(missing_ok=True)


def remove_partial(target: Path) -> None:
    """Remove what a program that was killed while it wrote ``target`` left beside it."""
    for partial in target.parent.glob(f".{glob.escape(target.name)}.*.part"):
        partial.unlink(missing_ok=True)


def table_text(columns: Mapping[str, Iterable[float]], head: Iterable[str] = ()) -> str:
    """Columns of numbers with all their digits under their names, and lines above these."""
    rows = zip(*(map(float, column) for column in columns.values()), strict=True)
    return "\n".join([*head, ",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"
