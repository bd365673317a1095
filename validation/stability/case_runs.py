"""One solver on the scene of a case: the part of the matrix that runs in worker processes."""

from __future__ import annotations

import time
from dataclasses import dataclass

from contact_scene import Scene, SceneError, Trace
from validation.solvers import SOLVERS


@dataclass(frozen=True)
class CaseRun:
    """One run: solver by name, scene, divisions per process zone, step budget."""

    solver: str
    scene: Scene
    resolution: int
    max_steps: int


@dataclass(frozen=True)
class CaseAnswer:
    """A trace, or the words of a refusal; processor time of the run in seconds."""

    trace: Trace | None = None
    refusal: str = ""
    seconds: float = 0.0


def solve_case(run: CaseRun) -> CaseAnswer:
    """Run the solver; a refusal is an answer, anything else that is raised is a crash."""
    solver = SOLVERS[run.solver]
    solver.load()
    begin = time.process_time()
    try:
        trace = solver.solve(run.scene, run.resolution, max_steps=run.max_steps)
    except SceneError as error:
        return CaseAnswer(refusal=str(error), seconds=time.process_time() - begin)
    return CaseAnswer(trace, seconds=time.process_time() - begin)
