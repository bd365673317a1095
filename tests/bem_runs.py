"""Scenes of the boundary-element tests, and runs that several tests look at, computed once."""

from __future__ import annotations

from functools import cache

import numpy as np

import bem_solver
from scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere, Step, Trace
from validation import reference

WORK = 1.6e-4 * np.pi
ZONE = 0.013
PULL = 1.5 * np.pi * WORK  # JKR pull-off force
STIFFNESS = 0.75 / (1.0 - 0.5**2)  # E0*
SCALED = np.pi * STIFFNESS  # F = SCALED * F~
ELASTIC = Material(0.75, 0.5)
GLASSY = Material(7.5, 0.5)
ONE = Material(0.75, 0.5, (Branch(6.75, 1.0),))
THREE = Material(0.75, 0.5, (Branch(3.0, 0.1), Branch(2.75, 1.0), Branch(1.0, 8.0)))
STICKY = Adhesion(WORK, ZONE)
SPHERE = Sphere(1.0)


def scene(*steps: Step, start="jump-in", at=0.0, material=ONE, indenter=SPHERE, adhesion=STICKY) -> Scene:
    """A scene, the paper's sphere unless told otherwise."""
    return Scene(material, indenter, Loading(start, at, steps), adhesion)


def cycle(rate: float, depth: float = 0.032, **others) -> Scene:
    """Approach from the jump into contact, and retraction until the contact is lost."""
    return scene(Ramp(depth, rate), Ramp(-0.5, rate), **others)


@cache
def bem(question: Scene, **options) -> Trace:
    """The boundary-element answer."""
    return bem_solver.solve(question, bem_solver.Options(**options))


@cache
def front(question: Scene, resolution: int | None = 10) -> Trace:
    """The front-tracking answer; at this resolution good to about 1e-4."""
    return reference.solve(question, reference.Options(resolution=resolution))


def at_times(trace: Trace, name: str, times: np.ndarray) -> np.ndarray:
    """A column at times inside the run, linear between rows."""
    return np.interp(times, trace.time, trace.columns()[name])


def observed_order(errors: list[float], ratio: float = 2.0) -> float:
    """Order of the last two of a sequence of errors; refinement by ``ratio``."""
    return float(np.log(abs(errors[-2] / errors[-1])) / np.log(ratio))
