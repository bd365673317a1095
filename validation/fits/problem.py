"""Residuals of several curves at a point of a search, and their derivatives by differences of runs.

The background (level, drift, tilt, drag, a wave) is linear: it costs no run, and every point of the search
has the one that makes its residuals least (Golub and Pereyra, SIAM J. Numer. Anal. 10, 413, 1973). The time
offset is a shift of the same run. All other derivatives are differences of runs, which share no work and may
be carried out side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene import SceneError
from validation.fits.contact import Array
from validation.fits.model import NO_CONTACT, CurveModel, FitRun, Prediction, least_squares, run_of
from validation.fits.parameters import CONTACT_POINT, TIME_OFFSET, FitSettings, Unknowns
from validation.runs.pool import Task, TaskResult, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store

KEPT_RUNS = 2000
"""Runs kept in memory, some kB each: those of the last iterations."""


@dataclass(frozen=True)
class Point:
    """A point of the search: runs at the rows of the curves, residuals (R,) with the background that makes
    them least, its parts as columns over the noise (R, Q), and how much there is of each (Q,)."""

    predictions: list[Prediction]
    residuals: Array
    compared: NDArray[np.bool_]
    columns: Array
    background: Array


@dataclass
class FitProblem:
    """Residuals and derivatives of curves, and last those of a regularisation; ``tolerance`` is that of time
    steps where no resolution is asked for, ``step`` that of differences, ``runs`` what was carried out."""

    models: Sequence[CurveModel]
    unknowns: Unknowns
    settings: FitSettings
    executor: Executor | None = None
    store: Store = field(default_factory=Store)
    tolerance: float | None = None
    step: float = 1e-3
    runs: int = 0
    on_run: Callable[[], None] = lambda: None
    _kept: dict[str, FitRun] = field(default_factory=dict)

    def __post_init__(self) -> None:
        predicted = [model.prediction(NO_CONTACT, None) for model in self.models]
        sizes = [one.residuals.size for one in predicted]
        ends = np.cumsum([0, *sizes, self._bending(self.unknowns.start).size]).tolist()
        self._rows, self.size = [slice(*both) for both in pairwise(ends[:-1])], ends[-1]
        self.force_rows = [
            slice(rows.start, rows.start + int(model.kept.sum()))
            for rows, model in zip(self._rows, self.models, strict=True)
        ]
        self.background = [model.background(self.settings.free) for model in self.models]
        self.parts = [(curve, name) for curve, own in enumerate(self.background) for name in own]
        self.columns = np.zeros((self.size, len(self.parts)))
        for place, (curve, name) in enumerate(self.parts):
            model = self.models[curve]
            values = self.background[curve][name][model.kept] / model.allowed
            self.columns[self.force_rows[curve], place] = values

    def residuals(self, x: Array) -> Array:
        """Residuals at a point of the search, shape (R,)."""
        return self.at(x).residuals

    def at(self, x: Array) -> Point:
        """A point of the search."""
        predicted, bending = self.predictions(list(enumerate(self._values(x)))), self._bending(x)
        compared = np.concatenate([*(one.hold for one in predicted), np.ones(bending.size, bool)])
        raw = np.concatenate([*(one.residuals for one in predicted), bending])
        raw, columns = np.where(compared, raw, 0.0), np.where(compared[:, None], self.columns, 0.0)
        background = -least_squares(columns, raw)
        return Point(predicted, raw + columns @ background, compared, columns, background)

    def jacobian(self, x: Array) -> Array:
        """Derivatives by the numbers of the search, the background following, shape (R, P)."""
        slopes, columns = self.derivatives(x), self.at(x).columns
        return slopes - columns @ least_squares(columns, slopes)

    def derivatives(self, x: Array) -> Array:
        """Derivatives by the numbers of the search with the background held, shape (R, P)."""
        calls = list(enumerate(self._values(x)))
        curves, bending, high = range(len(calls)), self._bending(x), self.unknowns.bounds[1]
        moves: list[tuple[int, int, float]] = []  # parameter, curve, step
        result = np.zeros((self.size, len(self.unknowns)))
        for place, one in enumerate(self.unknowns.found):
            moved = x.copy()
            step = self.step if x[place] + self.step <= high[place] else -self.step
            moved[place] += step
            result[self.size - bending.size :, place] = (self._bending(moved) - bending) / step
            for curve in curves if one.curve is None else (one.curve,):
                moves.append((place, curve, step))
                calls.append((curve, self.unknowns.values(moved, curve)))
        predicted = self.predictions(calls)
        for (place, curve, step), other in zip(moves, predicted[len(curves) :], strict=True):
            now = predicted[curve]
            change = (other.residuals - now.residuals) / step
            result[self._rows[curve], place] = np.where(now.hold_with(other), change, 0.0)
        return result

    def predictions(self, points: Sequence[tuple[int, Mapping[str, float]]]) -> list[Prediction]:
        """Predictions for curves, each with its numbers by path; equal runs are done once."""
        settings = self.settings
        asked_of = settings.solver, settings.resolution, self.tolerance, settings.max_steps
        asked: list[tuple[str, float | None]] = []  # key of the run, or why there is none; start of its clock
        tasks: dict[str, Task] = {}
        for curve, values in points:
            key, begin = "", None
            try:
                of_scene = {path: value for path, value in values.items() if "." in path}
                found = self.models[curve].scene_of(of_scene, values.get(CONTACT_POINT, 0.0))
                if found is not None:
                    key, begin = fingerprint("fit", found[0], *asked_of), found[1]
                    if key not in self._kept:
                        tasks[key] = Task(key, f"curve {curve + 1}", run_of, (found[0], *asked_of), FitRun)
            except SceneError as error:  # a corner of the search that no scene may have
                key = str(error)
            asked.append((key, begin))
        executor = self.executor if len(tasks) > 1 else None
        run_tasks(tasks.values(), executor, self.store, on_result=self._keep)
        made = []
        for (curve, values), (key, begin) in zip(points, asked, strict=True):
            run = replace(NO_CONTACT, failure=key) if begin is None else self._kept[key]
            made.append(self.models[curve].prediction(run, begin, values.get(TIME_OFFSET, 0.0)))
        while len(self._kept) > KEPT_RUNS:
            del self._kept[next(iter(self._kept))]
        return made

    def _keep(self, result: TaskResult) -> None:
        self._kept[result.task.key] = result.value or replace(NO_CONTACT, failure=result.failure)
        self.runs += 1
        self.on_run()

    def check_first_guess(self) -> None:
        """Raise what the solver refuses of the first guess, from which no search could then set out."""
        self.at(self.unknowns.start)
        for run in self._kept.values():
            if run.refused:
                reason, _, allowed = run.failure.partition("; allowed: ")
                problem = f"{self.settings.solver} does not take the first guess: {reason}"
                raise SceneError("solver", problem, allowed)

    def fitted_force(self, index: int, point: Point) -> Array:
        """Force as the instrument would record it, shape (N,)."""
        force = point.predictions[index].force.copy()
        for (curve, part), size in zip(self.parts, point.background, strict=True):
            if curve == index:
                force += size * self.background[index][part]
        return force

    def _values(self, x: Array) -> list[dict[str, float]]:
        return [self.unknowns.values(x, index) for index in range(len(self.models))]

    def _bending(self, x: Array) -> Array:
        return self.settings.bending(self.unknowns.values(x))
