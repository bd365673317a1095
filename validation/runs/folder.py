"""The folder that a command writes to: whose results it holds, one command at a time, files that are whole.

A folder belongs to what was first written to it: a hidden file says which kind of results it holds, and by
hashes which question they answer. Other results are refused, so that nothing is mixed or written over.
"""

from __future__ import annotations

import json
import math
import os
import socket
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from filelock import BaseFileLock, FileLock, Timeout

from contact_scene import Scene, files
from contact_scene.errors import SceneError
from validation.runs.provenance import hashed

CLAIM = ".crosscontact.json"
"""What a folder holds: kind, and hashes of the parts of its question."""
LOCK_FILE = ".lock"
WAIT = 0.2
"""Seconds to wait for a holder that is about to leave."""
MARKER_WAIT = 3.0
"""The same where the file is the lock: ``filelock`` takes a damaged one over after two seconds without a
change."""
RESULTS = (
    *("scene.toml", "summary.json", "trace.csv", "moments.json", "index.html", "report.json", "study.json"),
    *("stability.json", "exam.json", "fit.json", "sweep.nc", "runs.sqlite"),
)
"""Files that commands write, which in a folder that no command has claimed are not to be replaced."""


def claim(
    folder: Path, kind: str, question: Mapping[str, str], key: str = "--out", fresh: bool = False
) -> None:
    """Take a folder for results of a kind ("a report") on a question; refuse one that holds any other.

    The question is given by hashes of its parts, each by what it is called ("scene small"); one that has all
    parts of the earlier one takes its place. ``fresh`` takes the folder whatever it holds. ``key`` is the
    option that named it, or the argument, which knows no ``--fresh``.
    """
    holds = "" if fresh else _held_by_others(folder, kind, question)
    if holds:
        allowed = "another folder, or --fresh to replace what it holds"
        allowed = allowed if key.startswith("--") else "another folder"
        raise SceneError(key, f"{folder} is not empty: it holds {holds}", allowed)
    write_whole(folder / CLAIM, to_json({"kind": kind, "question": question}))


def scene_question(*scenes: tuple[str, Scene], **parts: str) -> dict[str, str]:
    """The question about scenes, each by its name; of another title a scene is the same."""
    return parts | {f"scene{name and ' '}{name}": hashed(replace(scene, title="")) for name, scene in scenes}


def _held_by_others(folder: Path, kind: str, question: Mapping[str, str]) -> str:
    """What a folder holds that is not of this kind, or not on this question; empty if nothing."""
    there = {entry.name for entry in folder.iterdir() if not entry.name.startswith(".")}
    if not there:
        return ""
    try:
        stated = from_json(files.read_text(folder / CLAIM))
        other, asked = str(stated["kind"]), dict(stated["question"])
    except (SceneError, ValueError, TypeError, KeyError):
        return ", ".join(name for name in RESULTS if name in there)
    if other != kind:
        return other
    differing = [name for name, value in asked.items() if question.get(name) != value]
    return f"{kind} (other {', '.join(differing)})" if differing else ""


def output_folder(path: str | os.PathLike[str], key: str = "--out") -> Path:
    """The folder, made with its parents if need be; ``SceneError`` if it cannot be, or cannot be written."""
    folder = Path(path)
    allowed = "a folder that exists or can be made, and can be written to"
    try:
        if not os.fspath(path):  # it would be the current folder
            raise SceneError(key, "is empty", allowed)
        if folder.exists() and not folder.is_dir():
            raise SceneError(key, f"{folder} is a file", allowed)
        for place in (folder, *folder.parents):
            if place.is_symlink() and not place.exists():
                nowhere = f"{place} is a link to {place.readlink()}, which does not exist"
                raise SceneError(key, nowhere, allowed)
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except SceneError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(key, f"{folder} cannot be written: {reason}", allowed) from None
    return folder


@contextmanager
def locked_folder(out: str | os.PathLike[str], key: str = "--out") -> Iterator[Path]:
    """The folder, made if need be, for this process alone; one that was made and stays empty is removed.

    A lock of the kernel on a file that names its holder: it ends with the holder, however that ends, and
    whatever the file says. On a file system without such locks the file itself is the lock; then one of a
    process that has gone is taken over if it is of this host, and one that cannot be read after two seconds.
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
        if [entry.name for entry in folder.iterdir()] == [CLAIM]:
            (folder / CLAIM).unlink()
        folder.rmdir()


def _hold(folder: Path, key: str, held: ExitStack) -> None:
    """Hold the folder until the stack is closed."""
    file, problem = folder / LOCK_FILE, f"{folder} is in use by another crosscontact"
    allowed = "another folder, or this one when it is done"
    lock = FileLock(file, poll_interval=WAIT / 4.0)
    try:
        _acquire(lock)
    except Timeout:
        with suppress(OSError, ValueError):
            process, host, *_ = file.read_text(encoding="utf-8").splitlines()
            if process.isdecimal() and host.isprintable():
                problem += f" (process {process} on {host.partition('?')[0]})"
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


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file atomically, and remove what a program that was killed while writing it left beside it."""
    files.remove_partial(path)
    files.write_whole(path, content)


def move_whole(stage: Path, folder: Path) -> None:
    """Move all files of a folder to another one on the same disk, each in one step."""
    for file in sorted(stage.iterdir()):
        try:
            with file.open("rb") as stream:
                os.fsync(stream.fileno())
        except OSError as error:  # a full disk is told by its number alone
            raise OSError(error.errno, error.strerror, str(folder / file.name)) from None
        file.replace(folder / file.name)


def to_json(value: Any) -> str:
    """Strict JSON, two spaces; what is not finite becomes null."""
    return json.dumps(json_value(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def from_json(text: str) -> Any:
    """What JSON says; ``ValueError`` if it is none, or nested deeper than can be read."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deep") from None


def json_value(value: Any) -> Any:
    """The same nested data in plain Python types, with ``None`` for NaN and infinity."""
    if isinstance(value, Mapping):
        return {str(key): json_value(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_value(entry) for entry in value]
    if value is None or isinstance(value, (bool, str, int)):
        return value
    if hasattr(value, "tolist"):
        return json_value(value.tolist())
    return float(value) if math.isfinite(value) else None


def in_words(count: float) -> str:
    """A number of bytes, in kB, MB or GB."""
    unit, scale = next(((u, s) for u, s in (("GB", 1e9), ("MB", 1e6)) if count >= s), ("kB", 1e3))
    return f"{count / scale:.0f} {unit}" if count >= 9.95 * scale else f"{count / scale:.1f} {unit}"
