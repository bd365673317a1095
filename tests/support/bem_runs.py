"""What the boundary-element tests share: runs that several tests look at, computed once."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import bem_solver
from contact_scene import Material, Scene, Trace
from validation.reference import path as reference

STIFFNESS = 0.75 / (1.0 - 0.5**2)  # E0*
SCALED = np.pi * STIFFNESS  # F = SCALED * F~
GLASSY = Material(7.5, 0.5)


def bem(question: Scene, **options) -> Trace:
    """The boundary-element answer."""
    options = {"resolution": bem_solver.Options().divisions} | options
    return _bem(question, tuple(sorted(options.items())))


def front(question: Scene, resolution: int | None = 10) -> Trace:
    """The front-tracking answer; at this resolution good to about 1e-4."""
    return _front(question, resolution)


@cache
def _bem(question: Scene, options: tuple[tuple[str, Any], ...]) -> Trace:
    return bem_solver.solve(question, bem_solver.Options(**dict(options)))


@cache
def _front(question: Scene, resolution: int | None) -> Trace:
    return reference.solve(question, reference.Options(resolution=resolution))


def at_times(trace: Trace, name: str, times: np.ndarray) -> np.ndarray:
    """A column at times inside the run, linear between rows."""
    return np.interp(times, trace.time, trace.columns()[name])


def observed_order(errors: list[float], ratio: float = 2.0) -> float:
    """Order of the last two of a sequence of errors; refinement by ``ratio``."""
    return float(np.log(abs(errors[-2] / errors[-1])) / np.log(ratio))
