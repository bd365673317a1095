"""Runs of the boundary elements and of the reference that several tests look at, computed once."""

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


def bem(question: Scene, resolution: int | None = None, **options) -> Trace:
    """The answer of the boundary elements, at their default resolution if none is given."""
    return _bem(question, resolution or bem_solver.Options().divisions, tuple(sorted(options.items())))


def front(question: Scene, resolution: int | None = 10, **options) -> Trace:
    """The answer of the reference; at this resolution good to about 1e-4."""
    return _front(question, resolution, tuple(sorted(options.items())))


@cache
def _bem(question: Scene, resolution: int, options: tuple[tuple[str, Any], ...]) -> Trace:
    return bem_solver.solve(question, bem_solver.Options(resolution, **dict(options)))


@cache
def _front(question: Scene, resolution: int | None, options: tuple[tuple[str, Any], ...]) -> Trace:
    return reference.solve(question, reference.Options(resolution=resolution, **dict(options)))


def at_times(trace: Trace, name: str, times: np.ndarray) -> np.ndarray:
    """A column at times inside the run, linear between rows."""
    return np.interp(times, trace.time, trace.columns()[name])


def observed_order(errors: list[float], ratio: float = 2.0) -> float:
    """Order of the last two of a sequence of errors; refinement by ``ratio``."""
    return float(np.log(abs(errors[-2] / errors[-1])) / np.log(ratio))
