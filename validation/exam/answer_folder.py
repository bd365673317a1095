"""What lies in a folder that is judged: scenes, answers to them, and what codes decline.

``exam.json`` lists the scenes; without it they are the built-in ones that are answered. An answer is any file
``trace.csv`` or ``trace-SOMETHING.csv``; its scene is named in its header or by its folder. ``code.toml``,
with ``code`` and ``declines``, a list of tags, says what a code does not do; ``declined.txt`` in the folder
of a scene says why this one is not answered.
"""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact_scene import SceneError, read_scene
from contact_scene.errors import shown
from contact_scene.files import read_text
from validation.cases import Case, load
from validation.exam.answer import Answer, read_answer
from validation.exam.scene_json import expanded
from validation.exam.tags import POSSIBLE, tags
from validation.scenes import names

EXAM = "exam.json"
CODE = "code.toml"
DECLINED = "declined.txt"
DEEPEST = 4
"""Folders below the one that is judged that are looked into: code, resolution, suite, scene."""
MOST_FILES = 2000
"""Files that are read: the full suite by fifty codes."""


@dataclass(frozen=True)
class AnswerFolder:
    """Everything found.

    Parameters
    ----------
    cases : tuple of Case
        The scenes of the exam.
    answers : tuple of Answer
        Their headers name the scene.
    declined : mapping of (str, str) to str
        Why a code (first) does not answer a scene (second).
    remarks : tuple of str
        What could not be used, one line each.
    """

    cases: tuple[Case, ...]
    answers: tuple[Answer, ...]
    declined: dict[tuple[str, str], str]
    remarks: tuple[str, ...]

    @property
    def codes(self) -> tuple[str, ...]:
        """Codes that answer or decline, in alphabetical order."""
        found = {answer.header.code for answer in self.answers} | {code for code, _ in self.declined}
        return tuple(sorted(found, key=lambda name: (name.lower(), name)))


def read_folder(folder: Path) -> AnswerFolder:
    """Everything in a folder.

    Raises
    ------
    SceneError
        If it is no folder, its list of scenes cannot be read, or nothing in it is an answer.
    """
    if not folder.is_dir():
        raise SceneError("DIR", f"{folder} is no folder", "a folder with answers, see docs/how-to/exam.md")
    files = list(_files(folder))
    remarks: list[str] = []
    if len(files) > MOST_FILES:
        remarks.append(f"{folder}: only the first {MOST_FILES} of {len(files)} files are read")
    answers, declined_tags, reasons = [], [], []
    for path in files[:MOST_FILES]:
        name = path.relative_to(folder).as_posix()
        if path.name == CODE:
            declined_tags.append((path, name))
        elif path.name == DECLINED:
            reasons.append((path, name))
        else:
            answers.append(_placed(read_answer(path, name), path))
    cases = _cases(folder, answers)
    known = {case.name for case in cases}
    for one in answers:
        if one.header.scene not in known:
            remarks.append(f"{one.file}: {shown(one.header.scene)} is no scene of this exam")
    declined: dict[tuple[str, str], str] = {}
    for path, name in declined_tags:
        declined |= _declined_by_tag(path, name, cases, remarks)
    for path, name in reasons:
        declined |= _declined_by_reason(path, name, known, remarks)
    kept = tuple(one for one in answers if one.header.scene in known)
    if not kept and not declined:
        raise SceneError("DIR", f"{folder} holds no answer", "files SCENE/trace.csv, see docs/how-to/exam.md")
    return AnswerFolder(cases, kept, declined, tuple(remarks))


def _files(folder: Path) -> Iterator[Path]:
    """Files that may belong to an exam, links not followed."""
    for where, inner, names_here in os.walk(folder):
        depth = len(Path(where).relative_to(folder).parts)
        inner[:] = sorted(one for one in inner if not one.startswith(".")) if depth < DEEPEST else []
        for name in sorted(names_here):
            path = Path(where) / name
            is_trace = name == "trace.csv" or (name.startswith("trace-") and name.endswith(".csv"))
            if (is_trace or name in (CODE, DECLINED)) and not path.is_symlink():
                yield path


def _placed(answer: Answer, path: Path) -> Answer:
    """The answer with the scene of its folder, where its header names none."""
    if answer.header.scene:
        return answer
    return replace(answer, header=replace(answer.header, scene=path.parent.name))


def _cases(folder: Path, answers: list[Answer]) -> tuple[Case, ...]:
    if (folder / EXAM).exists():
        return listed_cases(folder)
    answered = sorted({one.header.scene for one in answers} & set(names()))
    return tuple(replace(load(name), profile_times=()) for name in answered)


def listed_cases(folder: Path) -> tuple[Case, ...]:
    """The scenes of an exported exam.

    Raises
    ------
    SceneError
        If its list or a scene cannot be read.
    """
    listed = folder / EXAM
    try:
        data: Any = json.loads(read_text(listed))
        scenes = [entry["name"] for entry in data["scenes"]]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        if isinstance(error, SceneError):
            raise
        allowed = "a file written by `crosscontact exam export`"
        raise SceneError("scenes", "is no list of scenes", allowed, str(listed)) from None
    return tuple(_case(folder, name) for name in dict.fromkeys(scenes))


def _case(folder: Path, name: Any) -> Case:
    """The built-in scene, unless the folder states another under that name."""
    if not isinstance(name, str) or not name or Path(name).name != name:
        raise SceneError("scenes", f"got {shown(name)}", "names of folders", str(folder / EXAM))
    scene = read_scene(folder / name / "scene.toml")
    if name in names():
        built_in = load(name)
        if expanded(built_in.scene) == expanded(scene):
            return replace(built_in, profile_times=())
    return Case(name, scene)


def _declined_by_tag(
    path: Path, name: str, cases: tuple[Case, ...], remarks: list[str]
) -> dict[tuple[str, str], str]:
    """Scenes that a ``code.toml`` declines, each with the tags for which."""
    try:
        data = tomllib.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        remarks.append(f"{name}: not a TOML file: {' '.join(str(error).split())[:200]}")
        return {}
    code, declines = data.get("code"), data.get("declines", [])
    if not isinstance(code, str) or not isinstance(declines, list):
        remarks.append(f"{name}: code and declines; allowed: a name, and a list of tags")
        return {}
    known = POSSIBLE.union(*(tags(case.scene) for case in cases))
    odd = [tag for tag in declines if tag not in known]
    if odd:
        remarks.append(
            f"{name}: {shown(odd[0])} is no tag of a scene here; allowed: {', '.join(sorted(known))}"
        )
    declined = {}
    for case in cases:
        common = [tag for tag in tags(case.scene) if tag in declines]
        if common:
            declined[code[:40], case.name] = f"by tag: {', '.join(common)}"
    return declined


def _declined_by_reason(
    path: Path, name: str, known: set[str], remarks: list[str]
) -> dict[tuple[str, str], str]:
    """The scene that a ``declined.txt`` declines: ``CODE: reason``."""
    scene = path.parent.name
    try:
        code, colon, reason = read_text(path).partition(":")
    except SceneError as error:
        remarks.append(str(error).replace(str(path), name))
        return {}
    if scene not in known or not colon or not 1 <= len(code.strip()) <= 40:
        remarks.append(f"{name}: allowed: a line CODE: REASON in the folder of a scene")
        return {}
    return {(code.strip(), scene): " ".join(reason.split())[:200]}
