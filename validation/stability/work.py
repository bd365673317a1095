"""What a worker process does: one solver on one scene, and the front tracking as truth."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from contact_scene import Scene, SceneError, Trace


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
    solve = _SOLVE[job.solver]()
    began = time.process_time()
    try:
        trace = solve(job)
    except SceneError as error:
        return Answer(refusal=str(error), seconds=time.process_time() - began)
    return Answer(trace, seconds=time.process_time() - began)


def _bem() -> Callable[[Job], Trace]:
    from bem_solver import Options, solve

    return lambda job: solve(job.scene, Options(job.resolution, max_steps=job.max_steps))


def _fem() -> Callable[[Job], Trace]:
    from fem_solver import Options, solve
    from validation.solvers.finite_elements import mesh_for

    def call(job: Job) -> Trace:
        mesh = mesh_for(job.scene, job.resolution)
        return solve(job.scene, mesh, Options(job.resolution, max_steps=job.max_steps))

    return call


def _reference() -> Callable[[Job], Trace]:
    from validation.reference import Options, solve

    return lambda job: solve(job.scene, Options(job.resolution, max_steps=job.max_steps))


_SOLVE: dict[str, Callable[[], Callable[[Job], Trace]]] = {"bem": _bem, "fem": _fem, "reference": _reference}
