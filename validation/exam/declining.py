"""What a code declines: by tag in ``code.toml``, or a single scene with a reason in ``declined.txt``."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from contact_scene import SceneError
from contact_scene.errors import shown
from contact_scene.files import read_text
from validation.cases import Case
from validation.exam.header import A_CODE, is_code
from validation.exam.tags import POSSIBLE, tags

CODE = "code.toml"
DECLINED = "declined.txt"
LONGEST_REASON = 200
"""Characters of a reason: it becomes a line of a report."""

Declined = dict[tuple[str, str], str]
"""Why a code (first) does not answer a scene (second)."""


def read_declined(files: Iterable[tuple[Path, str]], cases: Sequence[Case], remarks: list[str]) -> Declined:
    """All that is declined in some files.

    Parameters
    ----------
    files : iterable of (Path, str)
        Each with its name in messages.
    cases : sequence of Case
        The scenes of the exam.
    remarks : list of str
        A line for each file that cannot be used is added.

    Returns
    -------
    dict
    """
    declined: Declined = {}
    for path, name in files:
        try:
            by_tag = path.name == CODE
            declined |= _by_tag(path, name, cases, remarks) if by_tag else _by_reason(path, name, cases)
        except SceneError as error:
            remarks.append(str(error.in_file(name)).replace(str(path), name))
    return declined


def _by_tag(path: Path, name: str, cases: Sequence[Case], remarks: list[str]) -> Declined:
    """Scenes that a ``code.toml`` declines, each with the tags for which."""
    data: dict[str, Any] = {}
    try:
        data = tomllib.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError("", f"not a TOML file: {error}", "code and declines", name) from None
    code, declines = data.get("code"), data.get("declines", [])
    if not isinstance(code, str) or not is_code(code):
        raise SceneError("code", f"got {shown(code)}", A_CODE, name)
    if not isinstance(declines, list) or not all(isinstance(tag, str) for tag in declines):
        raise SceneError("declines", f"got {shown(declines)}", "a list of tags", name)
    known = POSSIBLE.union(*(tags(case.scene) for case in cases))
    odd = [tag for tag in declines if tag not in known]
    if odd:
        allowed = ", ".join(sorted(known))
        remarks.append(f"{name}: {shown(odd[0])} is no tag of a scene here; allowed: {allowed}")
    common = {case.name: [tag for tag in tags(case.scene) if tag in declines] for case in cases}
    return {(code, scene): f"by tag: {', '.join(found)}" for scene, found in common.items() if found}


def _by_reason(path: Path, name: str, cases: Sequence[Case]) -> Declined:
    """The scene that a ``declined.txt`` declines: ``CODE: reason``."""
    code, colon, reason = read_text(path).partition(":")
    if not colon or not is_code(code.strip()) or path.parent.name not in {case.name for case in cases}:
        raise SceneError("", "declines no scene", "a line CODE: REASON in the folder of a scene", name)
    return {(code.strip(), path.parent.name): " ".join(reason.split())[:LONGEST_REASON]}
