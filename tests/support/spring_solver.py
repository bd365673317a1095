"""A stand-in for the solvers: a spring of the given stiffness follows every ramp, then lets go."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from support.synthetic_traces import by_hand

from contact_scene import Counters, Outcome, OutcomeKind, Scene, Trace
from validation.solvers import SOLVERS, RunOptions, Solver

SCENE = """
title = "A small scene"
[material]
modulus = 0.75
poisson = 0.5
[indenter]
shape = "sphere"
radius = 1.0
[adhesion]
work = 5e-4
zone = 0.013
[loading]
start = "jump-in"
penetration = 0.0
[[loading.steps]]
kind = "ramp"
to = 0.03
rate = 0.01
[[loading.steps]]
kind = "ramp"
to = -0.01
rate = 0.01
"""


def small_scene(folder: Path) -> str:
    """``SCENE`` as the file ``small.toml`` in a folder."""
    file = folder / "small.toml"
    file.write_text(SCENE)
    return str(file)


BUILT_IN = dict(SOLVERS)
TAKEN_OVER = (
    "order",
    "tolerance",
    "curve_tolerance",
    "quantity_tolerances",
    "estimates_errors",
    "skipped_work",
    "curve_style",
    "marker",
    "css_variable",
)


@dataclass
class FunctionSolver(Solver):
    """A solver whose ``solve`` is a function; everything else is that of the built-in solver it replaces."""

    function: Callable[..., Trace]
    name: str = "bem"
    title: str = "a function"

    def __post_init__(self) -> None:
        for attribute in TAKEN_OVER:
            setattr(self, attribute, getattr(BUILT_IN.get(self.name, Solver), attribute))

    def _solve(self, scene: Scene, resolution: int | None, options: RunOptions) -> Trace:
        """Call the function; the trace is signed by the name of this solver."""
        return dataclasses.replace(self.function(scene, resolution, **vars(options)), solver=self.name)


@dataclass
class StudiedSolver(FunctionSolver):
    """The same with all the settings that a ladder may change."""

    step_resolution: int | None = None
    step: float | None = None
    grading: float | None = None
    domain_ratio: float | None = None
    far_field: bool = True


def spring(
    stiffness: float = 1.0, kind: OutcomeKind = OutcomeKind.DETACHED, poison: bool = False
) -> Callable[..., Trace]:
    """A function that solves nothing: force in proportion to penetration."""

    def solve(scene: Scene, resolution=None, *, progress=None, **options) -> Trace:
        time, depth = [0.0], [scene.loading.penetration]
        for step in scene.loading.steps:
            segment = step.segment(time[-1], depth[-1], 0.0)
            for at in np.linspace(segment.start, segment.end, 20)[1:]:
                time.append(float(at))
                depth.append(segment.value(float(at)))
        if progress is not None:
            progress(0.5)
        d = np.array(depth)
        force, energy = stiffness * d, 0.5 * stiffness * d**2
        if poison:
            force[-1] = np.nan
        rows = {"penetration": d, "force": force, "stored_energy": energy, "external_work": energy}
        outcome = Outcome(kind, "as told", time[-1])
        return by_hand(time, contact_radius=0.2, outcome=outcome, counters=Counters(steps=len(d)), **rows)

    return solve


def stoppable(whole: Callable[..., Trace]) -> Callable[..., Trace]:
    """A function that gives the rows of another one by one, asking the monitor before each."""

    def solve(scene: Scene, resolution=None, *, monitor=None, **options) -> Trace:
        trace = whole(scene, resolution, **options)
        for row in range(len(trace)):
            if monitor is not None and not monitor():
                part = {name: column[: max(row, 1)] for name, column in trace.columns().items()}
                outcome = Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", float(part["time"][-1]))
                return dataclasses.replace(trace, **part, outcome=outcome)
        return trace

    return solve


def fake(
    stiffness: float = 1.0, kind: OutcomeKind = OutcomeKind.DETACHED, poison: bool = False
) -> FunctionSolver:
    """A solver, to be put into ``validation.solvers.SOLVERS``."""
    return FunctionSolver(spring(stiffness, kind, poison))


def named(name: str, method: FunctionSolver) -> FunctionSolver:
    """The same solver in place of the built-in one of this name."""
    return dataclasses.replace(method, name=name)
