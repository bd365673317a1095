"""Residuals of several curves over their noise, and their derivatives by differences of runs.

For each curve: the force at the measured times, but for the rows around a jump; the moments of the jumps,
over the standard deviation of a moment within its sampling interval; the contact radius, where it was
measured. A run that loses contact early, or breaks down, leaves a force of zero behind: a large residual, no
error.

Rows that one of run and record has in contact and the other not are residuals without derivatives: the
moments of the jumps, which have them, lead the search there.

Baseline and drift are linear and cost no run, the time offset is a shift of the same run. All other
derivatives are differences of runs, which share no work and may be carried out side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SceneError
from validation.fits.curve_model import CurveModel, CurvePrediction
from validation.fits.fit_run import NO_CONTACT, FitRun, run_of
from validation.fits.parameters import BASELINE, CONTACT_POINT, DRIFT, TIME_OFFSET, ParameterSet
from validation.fits.record import Array
from validation.fits.residual_blocks import RowBlock, radius_noise
from validation.runs.pool import Task, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store

KEPT_RUNS = 2000
"""Runs kept in memory, some kB each: those of the last iterations."""
Values = tuple[dict[str, float], dict[str, float]]


@dataclass
class FitProblem:
    """Residuals and derivatives.

    Parameters
    ----------
    models : sequence of CurveModel
    parameters : ParameterSet
    solver : str
    resolution : int or None
    tolerance : float or None
        Of the time steps, where no resolution is given.
    step : float
        Of differences, in numbers of the search.
    executor : Executor or None
        Carries out runs; ``None``: one after the other, here.
    store : Store
        Holds the runs of an interrupted fit.
    penalty : callable, optional
        Further residuals of the values by name, and nothing else (regularisation).
    max_steps : int or None
        Of every run; ``None``: the solver's own bound.

    Attributes
    ----------
    runs : int
        Runs carried out.
    """

    models: Sequence[CurveModel]
    parameters: ParameterSet
    solver: str
    resolution: int | None
    tolerance: float | None = None
    step: float = 1e-3
    executor: Executor | None = None
    store: Store = field(default_factory=Store)
    penalty: Callable[[Mapping[str, float]], Array] | None = None
    max_steps: int | None = None
    runs: int = 0
    _kept: dict[str, FitRun] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.compared = [model.features.compared(model.curve.time.size) for model in self.models]
        self.radius_noise = [radius_noise(model) for model in self.models]

    def residuals(self, x: Array) -> Array:
        """Residuals at a point of the search, shape (R,)."""
        points = [self.parameters.of_curve(x, index) for index in range(len(self.models))]
        predicted = self.predictions(list(enumerate(points)))
        parts = [self._of_curve(index, predicted[index], points[index][1]) for index in range(len(points))]
        return np.concatenate([*parts, self._penalties(x)])

    def jacobian(self, x: Array) -> Array:
        """Derivatives by the numbers of the search, shape (R, P)."""
        count = len(self.models)
        points = [self.parameters.of_curve(x, index) for index in range(count)]
        columns: list[tuple[int, int, float]] = []  # parameter, curve, step
        calls = list(enumerate(points))
        high = self.parameters.bounds[1]
        for place, one in enumerate(self.parameters.parameters):
            step = self.step if x[place] + self.step <= high[place] else -self.step
            if one.kind in (BASELINE, DRIFT):
                continue
            moved = x.copy()
            moved[place] += step
            for curve in range(count) if one.curve is None else (one.curve,):
                columns.append((place, curve, step))
                calls.append((curve, self.parameters.of_curve(moved, curve)))
        predicted = self.predictions(calls)
        base = [self._of_curve(index, predicted[index], points[index][1]) for index in range(count)]
        starts = np.concatenate([[0], np.cumsum([part.size for part in base])])
        contradicted = [self._contradicted(index, predicted[index]) for index in range(count)]
        penalties = self._penalties(x)
        result = np.zeros((int(starts[-1]) + penalties.size, len(self.parameters)))
        for (place, curve, step), (_, point), moved_to in zip(
            columns, calls[count:], predicted[count:], strict=True
        ):
            other = self._of_curve(curve, moved_to, point[1])
            change = (other - base[curve]) / step
            # A row that comes into contact or loses it jumps; a derivative it has on either side only.
            flipped = (moved_to.touching != predicted[curve].touching)[self.compared[curve]]
            change[: flipped.size][flipped] = 0.0
            change[: flipped.size][contradicted[curve]] = 0.0
            result[starts[curve] : starts[curve + 1], place] = change
        for place, one in enumerate(self.parameters.parameters):
            if one.curve is not None and one.kind in (BASELINE, DRIFT):
                model, kept = self.models[one.curve], self.compared[one.curve]
                since = model.curve.time - model.curve.time[0] if one.kind == DRIFT else np.ones(kept.size)
                begin = starts[one.curve]
                rows = slice(begin, begin + int(kept.sum()))
                slope = since[kept] * one.scale / model.features.noise
                result[rows, place] = np.where(contradicted[one.curve], 0.0, slope)
        if penalties.size:
            for place in range(len(self.parameters)):
                moved = x.copy()
                moved[place] += self.step
                result[starts[-1] :, place] = (self._penalties(moved) - penalties) / self.step
        return result

    def blocks(self) -> list[RowBlock]:
        """What stands where in the vector of residuals."""
        found, at = [], 0
        for index, model in enumerate(self.models):
            times = model.curve.time[self.compared[index]]
            seen = model.features
            jumps = [j.time for j in (seen.snap_in, seen.pull_off) if j is not None and j.timed]
            parts: list[tuple[str, Array]] = [("force", times)]
            parts += [("contact_radius", times)] if self.radius_noise[index] else []
            parts += [("jump", np.array(jumps))] if jumps else []
            for kind, own in parts:
                found.append(RowBlock(index, kind, slice(at, at + own.size), own))
                at += own.size
        extra = self._penalties(self.parameters.start).size
        if extra:
            found.append(RowBlock(-1, "regularisation", slice(at, at + extra), np.zeros(extra)))
        return found

    def predictions(self, points: Sequence[tuple[int, Values]]) -> list[CurvePrediction]:
        """Predictions for curves, each with its numbers of scene and instrument; equal runs are done once."""
        scenes: list[tuple[Scene, float] | None] = []
        keys: list[str] = []
        failures: dict[int, str] = {}
        tasks: dict[str, Task] = {}
        for place, (curve, (values, instrument)) in enumerate(points):
            try:
                asked = self.models[curve].scene_of(values, instrument[CONTACT_POINT])
            except SceneError as error:  # a corner of the search that no scene may have
                asked, failures[place] = None, str(error)
            scenes.append(asked)
            asked_of = self.solver, self.resolution, self.tolerance, self.max_steps
            keys.append("" if asked is None else fingerprint("fit", asked[0], *asked_of))
            if asked is not None and keys[-1] not in self._kept:
                arguments = (asked[0], *asked_of)
                tasks[keys[-1]] = Task(keys[-1], f"curve {curve + 1}", run_of, arguments, FitRun)
        executor = self.executor if len(tasks) > 1 else None
        for result in run_tasks(tasks.values(), executor, self.store):
            run = result.value or replace(NO_CONTACT, failure=result.failure)
            self._kept[result.task.key] = run
            self.runs += 1
        made = []
        for place, (curve, (_, instrument)) in enumerate(points):
            asked = scenes[place]
            run = NO_CONTACT if asked is None else self._kept[keys[place]]
            if place in failures:
                run = replace(NO_CONTACT, failure=failures[place])
            begin = None if asked is None else asked[1]
            made.append(self.models[curve].prediction(run, begin, instrument[TIME_OFFSET]))
        while len(self._kept) > KEPT_RUNS:
            del self._kept[next(iter(self._kept))]
        return made

    def check_first_guess(self) -> None:
        """Raise what the solver refuses of the first guess, from which no search could then set out."""
        x = self.parameters.start
        self.predictions([(index, self.parameters.of_curve(x, index)) for index in range(len(self.models))])
        for run in self._kept.values():
            if run.refused:
                reason, _, allowed = run.failure.partition("; allowed: ")
                raise SceneError("solver", f"{self.solver} does not take the first guess: {reason}", allowed)

    def predicted_force(
        self, index: int, prediction: CurvePrediction, instrument: Mapping[str, float]
    ) -> Array:
        """Force as the instrument would record it.

        Parameters
        ----------
        index : int
            Of the curve.
        prediction : CurvePrediction
        instrument : mapping of str to float
            Baseline (force), drift (force per time).

        Returns
        -------
        ndarray, shape (N,)
        """
        time = self.models[index].curve.time
        return prediction.force + instrument[BASELINE] + instrument[DRIFT] * (time - time[0])

    def _of_curve(self, index: int, prediction: CurvePrediction, instrument: Mapping[str, float]) -> Array:
        model, kept = self.models[index], self.compared[index]
        curve, seen = model.curve, model.features
        force = self.predicted_force(index, prediction, instrument)
        parts = [((force - curve.force) / seen.noise)[kept]]
        if self.radius_noise[index] and curve.contact_radius is not None:
            parts.append(
                ((prediction.contact_radius - curve.contact_radius) / self.radius_noise[index])[kept]
            )
        moments = [
            ((end if found is None else found) - jump.time) / jump.deviation
            for jump, found, end in (
                (seen.snap_in, prediction.first_contact, curve.time[-1]),
                (seen.pull_off, prediction.lost, curve.time[-1]),
            )
            if jump is not None and jump.timed
        ]
        return np.concatenate([*parts, np.array(moments, float)])

    def _contradicted(self, index: int, prediction: CurvePrediction) -> NDArray[np.bool_]:
        """Compared rows where the record is in contact for certain and the run is not, or the other way.

        There the force is wrong by the whole of it, however right the parameters are but for the moment of
        the jump, which has a residual of its own: what they seem to say of baseline and modulus leads astray.
        """
        recorded, known = self.models[index].features.contact(prediction.touching.size)
        return ((recorded != prediction.touching) & known)[self.compared[index]]

    def _penalties(self, x: Array) -> Array:
        return np.empty(0) if self.penalty is None else self.penalty(self.parameters.values(x))
