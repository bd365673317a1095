"""Answers of the registered solvers in the form of any other, and answers computed again."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_scene import SceneError
from contact_scene.errors import shown
from validation.cases import Case
from validation.exam.answer import read_answer
from validation.exam.export import header_of, trace_text
from validation.exam.scene_json import scene_of
from validation.exam.tags import BY_REASON
from validation.runs.files import write_whole
from validation.runs.pool import TellProgress, run_tasks
from validation.runs.run import Run, run
from validation.runs.solver_tasks import run_of, run_task
from validation.solvers import SOLVERS

ANSWERS = "answers"
"""Folder of these answers, below that of the exam."""


def answer_all(
    folder: Path,
    cases: Sequence[Case],
    solvers: Sequence[str],
    resolutions: Sequence[int | None] = (None,),
    executor: Executor | None = None,
    progress: TellProgress | None = None,
) -> list[Run]:
    """Answer every scene by every solver, and write the answers; returns the runs that broke down.

    ``folder`` is that of the exam; a resolution of ``None`` is the solver's choice. A scene that a solver
    does not take is declined.
    """
    asked = [(case, name, size) for name in solvers for size in resolutions for case in cases]
    tasks = [run_task(case, name, size) for case, name, size in asked]
    failed = []
    for (case, name, size), done in zip(asked, run_tasks(tasks, executor, None, progress), strict=True):
        result = run_of(done)
        place = folder / ANSWERS / f"{name}{'' if size is None else f'-{size}'}" / case.name
        place.mkdir(parents=True, exist_ok=True)
        if result.curves is not None:
            write_whole(place / "trace.csv", trace_text(header_of(case, result, size), result.curves))
        elif result.refused:
            write_whole(place / BY_REASON, f"{name}: {result.failure}\n")
        else:
            failed.append(result)
    return failed


@dataclass(frozen=True)
class Reproduction:
    """A trace computed again from its header; ``largest`` difference over the largest value of a column."""

    rows: int
    rows_again: int
    largest: float

    @property
    def same(self) -> bool:
        """Whether every bit is the same."""
        return self.rows == self.rows_again and self.largest == 0.0


def reproduce(path: Path) -> Reproduction:
    """Compute a trace of a registered solver again, from nothing but its header.

    Raises
    ------
    SceneError
        If the file cannot be read, or its header lacks the scene or a resolution.
    """
    answer, file = read_answer(path, str(path)), str(path)
    header = answer.header
    if answer.problem:
        raise SceneError("", answer.problem, "an answer with its header", file)
    if header.problem is None:
        raise SceneError("header: problem", "is missing", "a trace written by this program", file)
    if header.resolution and not header.resolution.isdecimal():
        raise SceneError("header: resolution", f"got {shown(header.resolution)}", "a number", file)
    if header.code not in SOLVERS:
        raise SceneError("header: code", f"got {shown(header.code)}", f"one of {', '.join(SOLVERS)}", file)
    try:
        scene = scene_of(header.problem)
    except SceneError as error:
        raise error.in_file(f"{path}: header: problem") from None
    resolution = int(header.resolution) if header.resolution else None
    again = run(Case(header.scene or "scene", scene), header.code, resolution)
    if again.curves is None:
        raise SceneError(
            "header", again.ending, "" if again.refused else "a solver and a scene it takes", file
        )
    rows, rows_again = len(answer.columns["time"]), len(again.curves)
    largest = np.inf
    if rows == rows_again:
        pairs = [(column, getattr(again.curves, name)) for name, column in answer.columns.items()]
        largest = max(float(np.abs(a - b).max()) / (float(np.abs(b).max()) or 1.0) for a, b in pairs)
    return Reproduction(rows, rows_again, largest)
