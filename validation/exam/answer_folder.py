"""What lies in a folder that is judged: scenes, answers to them, and what codes decline.

``exam.json`` lists the scenes; without it they are the built-in ones that are answered. An answer is any file
``trace.csv`` or ``trace-SOMETHING.csv``; its scene is named in its header or by its folder.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact_scene import SceneError, read_scene
from contact_scene.errors import shown
from contact_scene.files import read_text
from validation.cases import Case, load
from validation.exam.answer import Answer, read_answer
from validation.exam.scene_json import difference, expanded
from validation.exam.tags import BY_REASON, BY_TAG, Declined, read_declined
from validation.runs.files import from_json
from validation.scenes import names

EXAM = "exam.json"
TRACE = re.compile(r"trace(-.*)?\.csv", re.DOTALL)
DEEPEST = 4
"""Folders below the one that is judged that are looked into: code, resolution, suite, scene."""
MOST_FILES = 2000
"""Files that are read: the full suite by fifty codes."""
ARCHIVES = (".zip", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".7z")


@dataclass(frozen=True)
class AnswerFolder:
    """The scenes of an exam, answers to them, what is declined, and remarks on what could not be used."""

    cases: tuple[Case, ...]
    answers: tuple[Answer, ...]
    declined: Declined
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
    if not os.path.isdir(folder):
        raise SceneError("DIR", f"{folder} is no folder", "a folder with answers, see docs/how-to/exam.md")
    remarks: list[str] = []
    answers, declining = [], []
    for path in _files(folder, remarks):
        relative = path.relative_to(folder).as_posix()
        name = "".join(sign if sign.isprintable() else "?" for sign in relative)
        if path.name in (BY_TAG, BY_REASON):
            declining.append((path, name))
            continue
        one = read_answer(path, name)
        named = replace(one.header, scene=one.header.scene or path.parent.name)
        answers.append(replace(one, header=named))
    if (folder / EXAM).exists():
        cases = listed_cases(folder)
    else:
        answered = sorted({one.header.scene for one in answers} & set(names()))
        cases = tuple(replace(load(name), profile_times=()) for name in answered)
    known = {case.name: case for case in cases}
    kept = tuple(_of_this_exam(one, known) for one in answers if one.header.scene in known)
    strange = [one for one in answers if one.header.scene not in known]
    remarks += [f"{one.file}: {shown(one.header.scene)} is no scene of this exam" for one in strange]
    declined = read_declined(declining, cases, remarks)
    if not kept and not declined:
        reason = f" ({remarks[-1]})" if remarks else ""
        allowed = "files SCENE/trace.csv, see docs/how-to/exam.md"
        raise SceneError("DIR", f"{folder} holds no answer{reason}", allowed)
    return AnswerFolder(cases, kept, declined, tuple(remarks))


def _files(folder: Path, remarks: list[str]) -> list[Path]:
    """Traces and what is declined, in alphabetical order; a remark on each kind of thing passed over."""
    files: list[Path] = []
    passed_over: dict[str, str] = {}
    for where, inner, found in os.walk(folder):
        place = Path(where)
        if len(place.relative_to(folder).parts) >= DEEPEST and inner:
            passed_over.setdefault(f"folders more than {DEEPEST} deep are not looked into", inner[0])
            inner.clear()
        inner[:] = sorted(one for one in inner if not one.startswith("."))
        for name in sorted(found):
            wanted = name in (BY_TAG, BY_REASON) or TRACE.fullmatch(name)
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


def _of_this_exam(answer: Answer, cases: dict[str, Case]) -> Answer:
    """The answer; without its columns where its header states another scene than is asked."""
    if answer.header.problem is None or answer.problem:
        return answer
    apart = difference(answer.header.problem, expanded(cases[answer.header.scene].scene))
    problem = f"{answer.file}: answers another scene of this name: {apart}"
    return replace(answer, columns={}, problem=problem) if apart else answer


def listed_cases(folder: Path) -> tuple[Case, ...]:
    """The scenes of an exported exam.

    Raises
    ------
    SceneError
        If its list or a scene cannot be read.
    """
    text = read_text(folder / EXAM)
    try:
        scenes = [entry["name"] for entry in from_json(text)["scenes"]]
    except (ValueError, KeyError, TypeError):
        allowed = "a file written by `crosscontact exam export`"
        raise SceneError("scenes", "is no list of scenes", allowed, str(folder / EXAM)) from None
    return tuple(_case(folder, name) for name in dict.fromkeys(map(_a_name, scenes)))


def _a_name(name: Any) -> str:
    if not isinstance(name, str) or not name or Path(name).name != name:
        raise SceneError("scenes", f"got {shown(name)}", "names of folders", EXAM)
    return name


def _case(folder: Path, name: str) -> Case:
    """The built-in scene, unless the folder states another under that name."""
    case = Case(name, read_scene(folder / name / "scene.toml"))
    built_in = load(name) if name in names() else case
    same = expanded(built_in.scene) == expanded(case.scene)
    return replace(built_in, profile_times=()) if same else case
