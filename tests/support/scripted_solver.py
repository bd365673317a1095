"""A stand-in for the solvers of the matrix: does what the title of the scene says, in worker processes."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from support.synthetic_traces import by_hand

from contact_scene import Counters, OutcomeKind, Scene, Trace
from validation.cases import Case
from validation.measure.observables import measure
from validation.runs.pool import Task
from validation.runs.provenance import fingerprint
from validation.runs.run import Run
from validation.stability.cases import PLAIN, StabilityCase, Tolerance
from validation.stability.expected import ClosedForm, Value

FORCE = 2.0
TIGHT = Tolerance({}, "made up", other=1e-3)
EXPECTED = ClosedForm((Value("final_force", FORCE),), "made up")


def scene(title: str) -> Scene:
    """A scene whose title tells the fake what to do."""
    return replace(PLAIN, title=title)


def case(title: str, expected=EXPECTED, **more) -> StabilityCase:
    """A case on that scene."""
    return StabilityCase(title, scene(title), expected, TIGHT, axis="made up", **{"seconds": 20.0, **more})


def trace(force: float = FORCE, kind: OutcomeKind = OutcomeKind.COMPLETED, steps: int = 3) -> Trace:
    """A press by one radius, without any energy."""
    time = np.linspace(0.0, 1.0, steps + 1)
    rows = {"penetration": 0.01 * time, "force": force * time, "contact_radius": 0.1}
    return by_hand(time, kind, counters=Counters(steps=steps, rejected_steps=1), **rows)


ENDS = {
    "refuses": {"failure": "adhesion.zone: is too long", "refused": True},
    "breaks down": {"failure": "ZeroDivisionError: division by zero"},
    "gives up": {"trace": trace(kind=OutcomeKind.STEP_BUDGET)},
    "a little off": {"trace": trace(FORCE * (1.0 + 5e-4))},
    "wrong": {"trace": trace(FORCE * 1.01)},
    "ends otherwise": {"trace": trace(kind=OutcomeKind.DETACHED)},
}
"""What a title says of the run; any other is right."""


def answered(found: Trace, solver: str = "bem") -> Run:
    """A run with this trace."""
    return Run("made up", solver, found, measures=measure(found, PLAIN, 0.0))


def act(case: Case, solver: str, resolution: int) -> Run:
    """What the title of the scene says."""
    title = case.scene.title
    if title == "dies":
        os._exit(7)
    if title == "waits":
        time.sleep(600.0)
    while title == "hangs":
        pass
    told = ENDS.get(title, {"trace": trace()})
    if title == "by resolution":
        told = {"trace": trace(FORCE * (1.0 + 0.1 / resolution**2))}
    return answered(told["trace"], solver) if "trace" in told else Run("made up", solver, **told)


def never(case: Case, solver: str, resolution: int) -> Run:
    """Must not be asked."""
    return Run("made up", solver, failure=f"asked again: {case.scene.title}")


def acted(case: Case, solver: str, resolution: int, by: Callable[..., Run] = act, **budget) -> Task:
    """The task of a run by the fake."""
    key = fingerprint("made up", case.scene, solver, resolution)
    return Task(key, case.name, by, (case, solver, resolution), Run, budget["time_limit"])
