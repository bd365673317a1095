"""The files of a folder that may belong to an exam."""

from __future__ import annotations

import os
from pathlib import Path

from contact_scene.errors import shown
from validation.exam.declining import CODE, DECLINED

DEEPEST = 4
"""Folders below the one that is judged that are looked into: code, resolution, suite, scene."""
MOST_FILES = 2000
"""Files that are read: the full suite by fifty codes."""
ARCHIVES = (".zip", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".7z")


def answer_files(folder: Path, remarks: list[str]) -> list[Path]:
    """Traces and what is declined, in alphabetical order, links not followed.

    Parameters
    ----------
    folder : Path
    remarks : list of str
        A line for each kind of thing that is passed over is added.

    Returns
    -------
    list of Path
    """
    files: list[Path] = []
    passed_over: dict[str, str] = {}
    for where, inner, names in os.walk(folder):
        place = Path(where)
        if len(place.relative_to(folder).parts) >= DEEPEST and inner:
            passed_over.setdefault(f"folders more than {DEEPEST} deep are not looked into", inner[0])
            inner.clear()
        inner[:] = sorted(one for one in inner if not one.startswith("."))
        for name in sorted(names):
            wanted = name in (CODE, DECLINED) or is_trace(name)
            if wanted and (place / name).is_symlink():
                passed_over.setdefault("symbolic links are not followed", name)
            elif wanted:
                files.append(place / name)
            elif name.lower().endswith(ARCHIVES):
                passed_over.setdefault("archives are not unpacked", name)
    remarks += [f"{shown(name)}: {reason}" for reason, name in passed_over.items()]
    if len(files) > MOST_FILES:
        remarks.append(f"only the first {MOST_FILES} of {len(files)} files are read")
    return files[:MOST_FILES]


def is_trace(name: str) -> bool:
    """Whether a file of this name is an answer."""
    return name == "trace.csv" or (name.startswith("trace-") and name.endswith(".csv"))
