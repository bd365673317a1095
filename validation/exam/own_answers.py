"""Answers of the registered solvers in the form of any other, and traces computed again from their header."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError, Trace
from contact_scene.errors import shown
from contact_scene.files import table_text
from validation.cases import Case
from validation.exam.answer import BY_REASON, Header, read_answer
from validation.exam.question import expanded, scene_of
from validation.runs import provenance
from validation.runs.folder import to_json, write_whole
from validation.runs.pool import TellProgress, run_of, run_task, run_tasks
from validation.runs.run import Run, run
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS

ANSWERS = "answers"
"""Folder of these answers, below that of the exam."""
FINER = 2
"""Resolution of the reference that answers are graded against, over its default."""


def reference_resolution(scene: Scene) -> int:
    """Resolution of the reference for answers to a scene."""
    return FINER * SOLVERS[REFERENCE].default_resolution(scene)


def reference_runs(
    cases: Sequence[Case],
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
) -> dict[str, Run]:
    """Runs of the reference at that resolution, with error estimates, by scene."""
    tasks = [run_task(case, REFERENCE, reference_resolution(case.scene), estimate=True) for case in cases]
    return {one.scene: one for one in map(run_of, run_tasks(tasks, executor, store, progress))}


def export_reference(
    folder: Path,
    cases: Sequence[Case],
    executor: Executor | None = None,
    progress: TellProgress | None = None,
) -> list[Run]:
    """Write ``reference.csv`` and ``reference.json`` of every scene with a trace, once all are done."""
    runs = list(reference_runs(cases, executor, progress=progress).values())
    for case, found in zip(cases, runs, strict=True):
        if found.curves is None:
            continue
        resolution = reference_resolution(case.scene)
        write_whole(folder / case.name / "reference.csv", _text(case, found, found.curves, resolution))
        data = {
            "outcome": found.outcome,
            "ends_at": found.curves.outcome.time,
            "measures": {k: v for k, v in found.measures.items() if not k.startswith("counters.")},
            "relative_errors": found.errors,
        }
        write_whole(folder / case.name / "reference.json", to_json(data))
    return runs


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
    results = run_tasks([run_task(*one) for one in asked], executor, None, progress)
    failed = []
    for (case, name, size), result in zip(asked, map(run_of, results), strict=True):
        place = folder / ANSWERS / f"{name}{'' if size is None else f'-{size}'}" / case.name
        place.mkdir(parents=True, exist_ok=True)
        if result.curves is not None:
            write_whole(place / "trace.csv", _text(case, result, result.curves, size))
        elif result.refused:
            write_whole(place / BY_REASON, f"{name}: {result.failure}\n")
        else:
            failed.append(result)
    return failed


def _text(case: Case, run: Run, trace: Trace, resolution: int | None) -> str:
    """A trace of a solver under a header from which alone it can be computed again, with all digits."""
    method, version = SOLVERS[run.solver], SOLVERS.origin(run.solver)
    ending: Any = run.outcome if run.outcome in ("completed", "detached") else ""
    header = Header(
        run.solver,
        version=version or provenance.program_version(),
        author="" if version else "crosscontact",
        resolution="" if resolution is None else str(resolution),
        seconds=max(run.wall_seconds, 1e-6),
        scene=case.name,
        transition=method.transition(resolution),
        outcome=ending,
        problem=expanded(case.scene),
    )
    return table_text({name: getattr(trace, name) for name in method.columns}, header.lines())


def reproduce(path: Path) -> tuple[str, int]:
    """Compute a trace of a registered solver again, from nothing but its header.

    Returns how the rows differ, in words (nothing where every bit is the same), and how many there are.
    ``SceneError`` if the file cannot be read, or its header lacks what it takes.
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
    again = run(Case(header.scene, scene), header.code, int(header.resolution) if header.resolution else None)
    if again.curves is None:
        allowed = "" if again.refused else "a solver and a scene it takes"
        raise SceneError("header", again.ending, allowed, file)
    rows, found = len(answer.columns["time"]), len(again.curves)
    if rows != found:
        return f"{found} row{'s' if found != 1 else ''} instead of {rows}", rows
    pairs = [(column, getattr(again.curves, name)) for name, column in answer.columns.items()]
    largest = max(float(np.abs(a - b).max()) / (float(np.abs(b).max()) or 1.0) for a, b in pairs)
    return f"largest difference {largest:.2g}" if largest else "", rows
