"""Runs of a sweep by the reference's batch solver: many scenes solved together, each a run as of any solver.

It gives rows, pull-off and the end of contact; no energies. What has no answer there, or one that is not
known to a hundredth, is left to the reference.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from contact_scene import Counters, Outcome, OutcomeKind, Scene, SceneError, Trace
from contact_scene.machine import on_machine
from validation.cases import Case
from validation.measure.observables import measure
from validation.measure.scaling import LOSSES, WORKS
from validation.reference import batch
from validation.reference.batch.answers import LARGEST_ERROR
from validation.reference.path.run import NO_STABLE_CONTACT
from validation.runs.run import Run
from validation.solvers import out_of_range, trace_warnings

BATCH = "batch"
"""Name of the batch solver in a plan."""
LEAST_RESOLUTION = 8
COLUMNS = ("time", "penetration", "force", "contact_radius")
ENERGIES = ("stored_energy", "external_work", "dissipated_energy")
"""Columns of a trace that it computes, and those that it does not."""
NOT_GIVEN = (*LOSSES, *WORKS, "loss_share", "peak_cycle_frequency", "pull_off_radius")
"""Measures that it does not give: energies, and a radius that no two resolutions are compared in."""


def check(scene: Scene, at: str) -> None:
    """Refuse a scene that the batch solver does not take; ``at`` says which of a sweep it is."""
    reason = batch.refusal(scene)
    if reason:
        allowed = (
            "a power of the radius, a fixed zone, one ramp away or a cycle of two, "
            "with a hold between them and a force that ends either"
        )
        raise SceneError("solver", f"the batch solver does not take {reason}{at}", allowed)


def given(name: str) -> bool:
    """Whether the batch solver gives a measure."""
    return name not in NOT_GIVEN and not name.startswith("counters.")


def solve_all(cases: Sequence[Case], resolution: int | None, estimate: bool) -> list[Run]:
    """Solve together; of a scene without an answer the run has no trace."""
    begun, spent = time.perf_counter(), time.process_time()
    scenes = [case.scene for case in cases]
    solutions = batch.solve(scenes) if resolution is None else batch.solve(scenes, resolution)
    wall, spent = time.perf_counter() - begun, time.process_time() - spent
    seconds = wall / len(cases), spent / len(cases)
    return [_run(case, one, estimate, *seconds) for case, one in zip(cases, solutions, strict=True)]


def drawn_by(scene: Scene) -> bool:
    """Whether rows of the batch solver show the curves of a scene: few are where an edge rests or turns."""
    adhesion = scene.adhesion
    moves = adhesion is not None and adhesion.closing == adhesion.work and len(scene.loading.steps) == 1
    return moves and not batch.refusal(scene)


def _run(case: Case, found: batch.Solution, estimate: bool, wall: float, spent: float) -> Run:
    outside = out_of_range(case.scene)
    if outside is not None or not found.answered or not found.errors["pull_off_force"] <= LARGEST_ERROR:
        return Run(case.name, BATCH, failure=str(outside or found.reason or "not known to a hundredth"))
    end = float(found.time[-1])
    outcome = Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", end)
    if found.detached:
        outcome = Outcome(OutcomeKind.DETACHED, NO_STABLE_CONTACT, end)
    elif found.reason:  # rows end at one and a half zones, after the pull-off
        outcome = Outcome(OutcomeKind.BELOW_ZONE, found.reason, end, past_extremum=True)
    columns: dict[str, Any] = {name: getattr(found, name) for name in COLUMNS}
    columns |= dict.fromkeys(ENERGIES, np.zeros(len(columns["time"])))
    trace = Trace(BATCH, **columns, outcome=outcome, counters=Counters(steps=len(found.time) - 1))
    trace = on_machine(trace, case.scene.loading.machine)
    named = measure(trace, case.scene, wall).items()
    measures = {
        name: value
        for name, value in named
        if given(name) and not (found.reason and name.startswith("final_"))
    }
    return Run(
        case.name,
        BATCH,
        trace,
        wall_seconds=wall,
        cpu_seconds=spent,
        measures=measures,
        errors={
            name: told for name, told in found.errors.items() if estimate and measures.get(name) is not None
        },
        warnings=trace_warnings(case.scene, trace),
    )
