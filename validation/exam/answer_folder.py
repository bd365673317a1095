"""What lies in a folder that is judged: scenes, answers to them, and what codes decline.

``exam.json`` lists the scenes; without it they are the built-in ones that are answered. An answer is any file
``trace.csv`` or ``trace-SOMETHING.csv``; its scene is named in its header or by its folder. ``code.toml``,
with ``code`` and ``declines``, a list of tags, says what a code does not do; ``declined.txt`` in the folder
of a scene says why this one is not answered.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact_scene import SceneError, read_scene
from contact_scene.errors import shown
from contact_scene.files import read_text
from validation.cases import Case, load
from validation.exam.answer import Answer, read_answer
from validation.exam.answer_files import answer_files, is_trace
from validation.exam.declining import Declined, read_declined
from validation.exam.scene_json import difference, expanded
from validation.execution.files import from_json
from validation.scenes import names

EXAM = "exam.json"


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
    for path in answer_files(folder, remarks):
        relative = path.relative_to(folder).as_posix()
        name = "".join(sign if sign.isprintable() else "?" for sign in relative)
        if is_trace(path.name):
            answers.append(_placed(read_answer(path, name), path))
        else:
            declining.append((path, name))
    cases = _cases(folder, answers)
    known = {case.name for case in cases}
    asked = {case.name: expanded(case.scene) for case in cases if any(one.header.problem for one in answers)}
    answers = [_of_this_exam(one, asked.get(one.header.scene)) for one in answers]
    for one in answers:
        if one.header.scene not in known:
            remarks.append(f"{one.file}: {shown(one.header.scene)} is no scene of this exam")
    declined = read_declined(declining, cases, remarks)
    kept = tuple(one for one in answers if one.header.scene in known)
    if not kept and not declined:
        reason = f" ({remarks[-1]})" if remarks else ""
        allowed = "files SCENE/trace.csv, see docs/how-to/exam.md"
        raise SceneError("DIR", f"{folder} holds no answer{reason}", allowed)
    return AnswerFolder(cases, kept, declined, tuple(remarks))


def _placed(answer: Answer, path: Path) -> Answer:
    """The answer with the scene of its folder, where its header names none."""
    if answer.header.scene:
        return answer
    return replace(answer, header=replace(answer.header, scene=path.parent.name))


def _of_this_exam(answer: Answer, asked: dict[str, Any] | None) -> Answer:
    """The answer; without its columns where its header states another scene than is asked."""
    if answer.header.problem is None or asked is None:
        return answer
    apart = difference(answer.header.problem, asked)
    problem = f"{answer.file}: answers another scene of this name: {apart}"
    return replace(answer, columns={}, problem=problem) if apart and not answer.problem else answer


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
        data: Any = from_json(read_text(listed))
        scenes = [entry["name"] for entry in data["scenes"]]
    except (ValueError, KeyError, TypeError) as error:
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
