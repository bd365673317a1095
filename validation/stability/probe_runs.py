"""One solver on the scene of a probe, or the front tracking as its truth: the part that runs in a worker."""

from __future__ import annotations

import time
from dataclasses import dataclass

from contact_scene import Scene, SceneError, Trace


@dataclass(frozen=True)
class ProbeRun:
    """What is run: ``solver`` by name, divisions per process zone, step budget."""

    solver: str
    scene: Scene
    resolution: int
    max_steps: int


@dataclass(frozen=True)
class ProbeAnswer:
    """A trace, or the words of a refusal; processor time of the run in seconds."""

    trace: Trace | None = None
    refusal: str = ""
    seconds: float = 0.0


def solve_probe(run: ProbeRun) -> ProbeAnswer:
    """Run the solver; a refusal is an answer, anything else that is raised is a crash."""
    began = time.process_time()
    try:
        trace = _solve(run)
    except SceneError as error:
        return ProbeAnswer(refusal=str(error), seconds=time.process_time() - began)
    return ProbeAnswer(trace, seconds=time.process_time() - began)


def _solve(run: ProbeRun) -> Trace:
    """The call of a solver: the only place here that knows its parameters."""
    if run.solver == "bem":
        import bem_solver

        return bem_solver.solve(run.scene, bem_solver.Options(run.resolution, max_steps=run.max_steps))
    if run.solver == "fem":
        import fem_solver
        from validation.contact_range import mesh_for

        mesh = mesh_for(run.scene, run.resolution)
        return fem_solver.solve(run.scene, mesh, fem_solver.Options(run.resolution, max_steps=run.max_steps))
    from validation import reference

    return reference.solve(run.scene, reference.Options(run.resolution, max_steps=run.max_steps))
