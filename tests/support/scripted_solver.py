"""A stand-in for the solvers of the matrix: does what the title of the scene says, in worker processes."""

from __future__ import annotations

import os
import time
from dataclasses import replace

import numpy as np
from support.synthetic_traces import by_hand

from contact_scene import Counters, OutcomeKind, Scene, SceneError, Trace
from validation.stability.cases import PLAIN, StabilityCase, Tolerance
from validation.stability.expected import ClosedForm, Value
from validation.stability.matrix import CaseAnswer, CaseRun

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


def act(run: CaseRun) -> CaseAnswer:
    """What the title says."""
    title = run.scene.title
    if title == "refuses":
        return CaseAnswer(refusal=str(SceneError("adhesion.zone", "is too long")))
    if title == "raises":
        raise ZeroDivisionError("division by\nzero")
    if title == "dies":
        os._exit(7)
    if title == "waits":
        time.sleep(600.0)
    while title == "hangs":
        pass
    if title == "gives up":
        return CaseAnswer(trace(kind=OutcomeKind.STEP_BUDGET))
    if title == "not a number":
        return CaseAnswer(trace(float("nan")))
    if title == "a little off":
        return CaseAnswer(trace(FORCE * (1.0 + 5e-4)))
    if title == "wrong":
        return CaseAnswer(trace(FORCE * 1.01))
    if title == "ends otherwise":
        return CaseAnswer(trace(kind=OutcomeKind.DETACHED))
    if title == "by resolution":
        return CaseAnswer(trace(FORCE * (1.0 + 0.1 / run.resolution**2)))
    return CaseAnswer(trace())


def never(run: CaseRun) -> CaseAnswer:
    """Must not be asked."""
    raise AssertionError(run.scene.title)
