"""Files: text read with one-line errors, atomic writing, small tables as CSV."""

from __future__ import annotations

import csv
import errno
import glob
import io
import os
import re
import uuid
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene.errors import SceneError, cell_shown
from contact_scene.separators import check_head, check_row, is_name, is_number, names_in_words
from contact_scene.units import bracketed, check_units
from contact_scene.value_checks import of_class

TOO_LARGE = 10_000_000
"""Bytes; a scene or a table larger than this is a mistake."""
_COMMENTS = 1000
"""Lines among which the header of a table is looked for."""


def as_path(given: Any, key: str = "path", allowed: str = "the path of a file") -> Path:
    """What names a file or a folder, as a path.

    Parameters
    ----------
    given : Any
    key : str
        Name of the argument, for the error.
    allowed : str
        What it may be, in words.

    Returns
    -------
    Path

    Raises
    ------
    SceneError
        If it is none; an empty one, which would be the current folder, too.
    """
    of_class(given, key, (str, os.PathLike), allowed)
    if not os.fspath(given):
        raise SceneError(key, "is empty", allowed)
    return Path(given)


def as_target(given: Any) -> Path:
    """What names a regular file that is there or can be made, as a path.

    Raises
    ------
    SceneError
        If it is no path, that of a folder or a device, or in a folder that is not there or not to be written.
    """
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
    """The text of a regular UTF-8 file of at most ``most`` bytes, line ends as ``\\n``.

    Raises
    ------
    SceneError
        One line naming the file and the reason.
    """
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


def read_rows(text: str, file: str) -> list[tuple[int, list[str]]]:
    """Rows of a CSV as (line number, stripped cells); blank lines and comments (#) are left out.

    Where numbers stand in the first row, a comment above it of as many names is the header, and comes first.
    """
    rows: list[tuple[int, list[str]]] = []
    comments: list[tuple[int, list[str]]] = []
    for line, content in enumerate(text.split("\n"), 1):
        if content.lstrip().startswith("#"):
            if not rows:
                comments.append((line, [cell.strip() for cell in content.lstrip().lstrip("#").split(",")]))
        elif content.strip():
            try:
                cells = next(csv.reader([content], strict=True))
            except csv.Error as error:
                raise SceneError(f"line {line}", f"not CSV: {error}", "comma-separated cells", file) from None
            rows.append((line, [cell.strip() for cell in cells]))
    if not rows:
        raise SceneError("", "the file is empty", "a CSV table", file)
    if all(map(is_number, first := rows[0][1])):
        named = (one for one in comments if len(one[1]) == len(first) and all(map(is_name, one[1])))
        rows[:0] = [one for one in (next(named, None),) if one is not None]
    return rows


def read_pairs(
    file: Path, names: tuple[str, str], others: Sequence[str] = ()
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two columns of numbers from a CSV; comments (#) and one header line are allowed.

    A header may say anything but that the columns stand the other way round, that the second one is what
    ``others`` name, or units that contradict the columns or each other.
    """
    shown_file, allowed = str(file), f"rows of two finite numbers: {names[0]}, {names[1]}"
    text = read_text(file)
    _check_header(text, names, others, shown_file)
    columns = _plain_columns(text)
    if columns is not None:
        return columns
    first: list[float] = []
    second: list[float] = []
    rows, lines = read_rows(text, shown_file), text.split("\n")
    check_head(*rows[0], {*names, *others}, shown_file)
    for index, (line, cells) in enumerate(rows):
        if index == 0 and len(cells) == 2 and not any(is_number(cell) for cell in cells):
            continue
        if len(cells) != 2 or not all(is_number(cell) for cell in cells):
            for number, _ in rows[index : max(index + 1, 2)]:  # a header may have other names
                check_row(number, lines[number - 1], shown_file)
            raise SceneError(f"line {line}", f"got {cell_shown(','.join(cells))}", allowed, shown_file)
        first.append(float(cells[0]))
        second.append(float(cells[1]))
    return tuple(first), tuple(second)


def _check_header(text: str, names: tuple[str, str], others: Sequence[str], file: str) -> None:
    """Refuse a header, or a comment of two names above it, that says of a column what it is not."""
    for number, line in enumerate(text.split("\n", _COMMENTS)[:_COMMENTS], 1):
        comment = line.lstrip().startswith("#")
        cells = line.lstrip().lstrip("#").split(",")
        words = [(re.findall(r"[^\W\d_]+", cell) or [""])[0].lower() for cell in cells]
        named = set(words) <= {*names, *others} or names_in_words([cell.strip() for cell in cells])
        remark = comment and (len(cells) != 2 or not named)
        if remark or not line.strip():
            continue
        swapped = words[0] == names[1] or (words[0] != names[0] and names[0] in words)
        if swapped or any(word in others for word in words):
            raise SceneError(
                f"line {number}", f"got {cell_shown(line)}", f"the columns {', '.join(names)}", file
            )
        check_units(zip(names, map(bracketed, cells), strict=False), f"line {number}", file)
        if not comment:
            return


def _plain_columns(text: str) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """Two columns of bare numbers below at most one header, read at once; ``None`` for any other text."""
    head, _, rest = text.partition("\n")
    cells = head.split(",")
    headed = len(cells) == 2 and not any(is_number(cell) for cell in cells)
    body = rest if headed else text
    if "#" in text or '"' in text or not body.strip():
        return None
    try:
        first, second = np.loadtxt(io.StringIO(body), delimiter=",", ndmin=2, unpack=True)
    except ValueError:
        return None
    return tuple(first.tolist()), tuple(second.tolist())


def write_pairs(path: Path, names: Sequence[str], first: Iterable[float], second: Iterable[float]) -> None:
    """Write two columns of numbers with all their digits, under a header.

    Parameters
    ----------
    path : Path
    names : sequence of str
        Of the two columns.
    first, second : iterable of float
        Of the same length.
    """
    rows = [",".join(names)] + [f"{a!r},{b!r}" for a, b in zip(first, second, strict=True)]
    write_whole(path, "\n".join(rows) + "\n")
