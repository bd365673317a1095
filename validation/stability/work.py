"""What a worker process does: one solver on one scene, and the front tracking as truth."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from contact_scene import Scene, SceneError, Trace
from validation.solvers import SOLVERS


@dataclass(frozen=True)
class Job:
    """One run: ``solver`` by name, divisions per process zone, step budget."""

    solver: str
    scene: Scene
    resolution: int
    max_steps: int


@dataclass(frozen=True)
class Answer:
    """What came of a job: a trace, or the words of a refusal; processor time of the run."""

    trace: Trace | None = None
    refusal: str = ""
    seconds: float = 0.0


Perform = Callable[[Job], Answer]


def perform(job: Job) -> Answer:
    """Run the solver; a refusal is an answer, anything else that is raised is a crash."""
    solver = SOLVERS[job.solver]
    solver.load()
    began = time.process_time()
    try:
        trace = solver.solve(job.scene, job.resolution, max_steps=job.max_steps)
    except SceneError as error:
        return Answer(refusal=str(error), seconds=time.process_time() - began)
    return Answer(trace, seconds=time.process_time() - began)
