"""Files that appear whole or not at all, strict JSON, and folders known to be writable before long work."""

from __future__ import annotations

import json
import math
import os
import tempfile
from pathlib import Path
from typing import Any

from contact_scene import files
from contact_scene.errors import SceneError


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file atomically, and remove what a program that was killed while writing it left beside it.

    Two writers of one file at a time are excluded by ``folder_lock``.
    """
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
    """What JSON says.

    Raises
    ------
    ValueError
        If it is none, or is nested deeper than can be read.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deep") from None


def json_value(value: Any) -> Any:
    """The same nested data in plain Python types, with ``None`` for NaN and infinity."""
    if isinstance(value, dict):
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


def output_folder(path: str | os.PathLike[str], key: str = "--out") -> Path:
    """Make the folder (and its parents) and try to write into it.

    Raises
    ------
    SceneError
        If it names a file or a link to nowhere, or cannot be written.
    """
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
    except (OSError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError(key, f"{folder} cannot be written: {reason}", allowed) from None
    return folder
