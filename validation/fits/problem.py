"""Residuals of several curves over their noise, and their derivatives by differences of runs.

For each curve: the force at the measured times, but for the rows around a jump; the moments of the jumps,
over the standard deviation of a moment within its sampling interval; the contact radius, where it was
measured. A run that loses contact early, or breaks down, leaves a force of zero behind: a large residual, no
error. Rows that for certain only one of run and record has in contact are not compared: there the force is
wrong by the whole of it, however right the parameters are but for the moment of the jump, which leads.

The background (level, drift, tilt, drag, a wave) is linear: it costs no run, and every point of the search
has the one that makes its residuals least (Golub and Pereyra, SIAM J. Numer. Anal. 10, 413, 1973). The time
offset is a shift of the same run. All other derivatives are differences of runs, which share no work and may
be carried out side by side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import SceneError
from validation.fits.contact import wave_columns, wave_length, white_noise
from validation.fits.model import NO_CONTACT, CurveModel, CurvePrediction, FitRun, run_of
from validation.fits.moments import Jump
from validation.fits.parameters import BACKGROUND, CONTACT_POINT, TIME_OFFSET, FitSettings, Unknowns
from validation.fits.record import Array
from validation.runs.pool import Task, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store

KEPT_RUNS = 2000
"""Runs kept in memory, some kB each: those of the last iterations."""
LEAST_RADIUS_NOISE = 1e-4
"""Noise of a measured contact radius over its range, at least."""
OWN_PART = 1e-3
"""Share of a part of the background that the parts before it do not make up, at least: in a record of an
approach alone the drag is a level, and the tilt a drift."""


@dataclass(frozen=True)
class Block:
    """Where residuals of one kind (``force``, ``contact_radius``, ``jump``) of one curve stand."""

    curve: int
    kind: str
    rows: slice


@dataclass(frozen=True)
class Point:
    """A point of the search: runs at the rows of the curves, residuals (R,) with the background that makes
    them least, its parts as columns over the noise (R, Q), and how much there is of each (Q,)."""

    predictions: list[CurvePrediction]
    residuals: Array
    compared: NDArray[np.bool_]
    columns: Array
    background: Array


@dataclass
class FitProblem:
    """Residuals and derivatives of curves; ``tolerance`` is that of the time steps where no resolution is
    asked for, ``step`` that of differences in numbers of the search, ``runs`` what was carried out."""

    models: Sequence[CurveModel]
    unknowns: Unknowns
    settings: FitSettings
    executor: Executor | None = None
    store: Store = field(default_factory=Store)
    tolerance: float | None = None
    step: float = 1e-3
    runs: int = 0
    _kept: dict[str, FitRun] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.compared = [model.moments.compared for model in self.models]
        self.radius_noise = [_radius_noise(model) for model in self.models]
        self.blocks: list[Block] = []
        at = 0
        for index, model in enumerate(self.models):
            rows = int(self.compared[index].sum())
            sizes = {
                "force": rows,
                "contact_radius": rows if self.radius_noise[index] else 0,
                "jump": len(_jumps(model)),
            }
            for kind, size in sizes.items():
                self.blocks.append(Block(index, kind, slice(at, at + size)))
                at += size
        self.force_rows = [block.rows for block in self.blocks if block.kind == "force"]
        self.size = at + self._penalties(self.unknowns.start).size
        self.background = [background_columns(model, self.settings.free) for model in self.models]
        self.parts: list[tuple[int, str]] = []  # curve and name of each part of the background
        columns = []
        for index, (model, own) in enumerate(zip(self.models, self.force_rows, strict=True)):
            for name, values in self.background[index].items():
                column = np.zeros(self.size)
                column[own] = values[self.compared[index]] / model.allowed
                self.parts.append((index, name))
                columns.append(column)
        self.columns = np.array(columns).reshape(-1, self.size).T

    def residuals(self, x: Array) -> Array:
        """Residuals at a point of the search, shape (R,)."""
        return self.at(x).residuals

    def at(self, x: Array) -> Point:
        """A point of the search."""
        predicted = self.predictions(list(enumerate(self._values(x))))
        raw = np.concatenate([*map(self._of_curve, range(len(predicted)), predicted), self._penalties(x)])
        compared = np.ones(self.size, bool)
        for block in self.blocks:
            if (block.kind != "jump" and self.radius_noise[block.curve]) or block.kind == "force":
                compared[block.rows] = ~self._contradicted(block.curve, predicted[block.curve])
        raw, columns = np.where(compared, raw, 0.0), np.where(compared[:, None], self.columns, 0.0)
        background = -_least_squares(columns, raw)
        return Point(predicted, raw + columns @ background, compared, columns, background)

    def jacobian(self, x: Array) -> Array:
        """Derivatives by the numbers of the search, the background following, shape (R, P)."""
        slopes, columns = self.derivatives(x), self.at(x).columns
        return slopes - columns @ _least_squares(columns, slopes)

    def derivatives(self, x: Array) -> Array:
        """Derivatives by the numbers of the search with the background held, shape (R, P)."""
        values = self._values(x)
        moves: list[tuple[int, int, float]] = []  # parameter, curve, step
        calls = list(enumerate(values))
        high = self.unknowns.bounds[1]
        result = np.zeros((self.size, len(self.unknowns)))
        for place, one in enumerate(self.unknowns.found):
            moved = x.copy()
            step = self.step if x[place] + self.step <= high[place] else -self.step
            moved[place] += step
            result[:, place][self.size - self._penalties(x).size :] = (
                self._penalties(moved) - self._penalties(x)
            ) / step
            for curve in range(len(values)) if one.curve is None else (one.curve,):
                moves.append((place, curve, step))
                calls.append((curve, self.unknowns.values(moved, curve)))
        predicted = self.predictions(calls)
        base = [self._of_curve(curve, predicted[curve]) for curve in range(len(values))]
        for (place, curve, step), other in zip(moves, predicted[len(values) :], strict=True):
            now = predicted[curve]
            change = (self._of_curve(curve, other) - base[curve]) / step
            # A row that comes into contact or loses it jumps; a derivative it has on either side only.
            fixed = (other.touching != now.touching)[self.compared[curve]] | self._contradicted(curve, now)
            fixed = np.tile(fixed, 2 if self.radius_noise[curve] else 1)
            change[: fixed.size][fixed] = 0.0
            begin = self.force_rows[curve].start
            result[begin : begin + change.size, place] = change
        return result

    def predictions(self, points: Sequence[tuple[int, Mapping[str, float]]]) -> list[CurvePrediction]:
        """Predictions for curves, each with its numbers by path; equal runs are done once."""
        settings = self.settings
        asked_of = settings.solver, settings.resolution, self.tolerance, settings.max_steps
        asked: list[tuple[str, float | None, str]] = []  # key of the run, start of its clock, failure
        tasks: dict[str, Task] = {}
        for curve, values in points:
            of_scene = {path: value for path, value in values.items() if "." in path}
            try:
                found = self.models[curve].scene_of(of_scene, values.get(CONTACT_POINT, 0.0))
            except SceneError as error:  # a corner of the search that no scene may have
                asked.append(("", None, str(error)))
                continue
            if found is None:
                asked.append(("", None, ""))
                continue
            scene, begin = found
            key = fingerprint("fit", scene, *asked_of)
            asked.append((key, begin, ""))
            if key not in self._kept:
                tasks[key] = Task(key, f"curve {curve + 1}", run_of, (scene, *asked_of), FitRun)
        executor = self.executor if len(tasks) > 1 else None
        for result in run_tasks(tasks.values(), executor, self.store):
            self._kept[result.task.key] = result.value or replace(NO_CONTACT, failure=result.failure)
            self.runs += 1
        made = [
            self.models[curve].prediction(
                self._kept[key] if key else replace(NO_CONTACT, failure=failure),
                begin,
                values.get(TIME_OFFSET, 0.0),
            )
            for (curve, values), (key, begin, failure) in zip(points, asked, strict=True)
        ]
        while len(self._kept) > KEPT_RUNS:
            del self._kept[next(iter(self._kept))]
        return made

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

    def _of_curve(self, index: int, prediction: CurvePrediction) -> Array:
        """Residuals of a curve without background."""
        model, kept = self.models[index], self.compared[index]
        curve = model.curve
        parts = [((prediction.force - curve.force) / model.allowed)[kept]]
        if self.radius_noise[index] and curve.contact_radius is not None:
            change = prediction.contact_radius - curve.contact_radius
            parts.append((change / self.radius_noise[index])[kept])
        found = {True: prediction.first_contact, False: prediction.lost}
        for begins, jump in _jumps(model):
            at = found[begins]
            missed = float(curve.time[-1] if at is None else at) - jump.time
            parts.append(np.array([missed / model.allowed_moment(jump)]))
        return np.concatenate(parts)

    def _contradicted(self, index: int, prediction: CurvePrediction) -> NDArray[np.bool_]:
        """Compared rows that for certain only one of record and run has in contact."""
        recorded, known = self.models[index].moments.contact
        return ((recorded != prediction.touching) & known)[self.compared[index]]

    def _penalties(self, x: Array) -> Array:
        bending = self.settings.bending
        return np.empty(0) if bending is None else bending(self.unknowns.values(x))


def background_columns(model: CurveModel, free: Sequence[str]) -> dict[str, Array]:
    """Parts of the background of a record, as far as each is more than the parts before it make up."""
    asked = {part for name in free for part in BACKGROUND.get(name, ())}
    curve = model.curve
    every = {
        "baseline": np.ones(curve.time.size),
        "drift": curve.time - curve.time[0],
        "tilt": curve.position - curve.position[0],
        "drag": curve.speed,
    }
    if "wave_cosine" in asked:
        every |= _wave(model, every)
    found: dict[str, Array] = {}
    for name, column in every.items():
        before = np.array(list(found.values())).reshape(-1, column.size).T
        left = column - before @ _least_squares(before, column)
        if name in asked and np.linalg.norm(left) > OWN_PART * np.linalg.norm(column):
            found[name] = column
    return found


def _wave(model: CurveModel, parts: Mapping[str, Array]) -> dict[str, Array]:
    """Cosine and sine of the wave that the rows before contact show over level and tilt, if any."""
    position, force, ahead = model.curve.position, model.curve.force, slice(0, model.moments.first)
    line = np.array([parts["baseline"], parts["tilt"]]).T[ahead]
    left = force[ahead] - line @ _least_squares(line, force[ahead])
    columns = wave_columns(position, wave_length(position[ahead], left))
    return dict(zip(("wave_cosine", "wave_sine"), columns, strict=False))


def _least_squares(columns: Array, values: Array) -> Array:
    """Multiples of the columns that come closest to the values, whatever the sizes of the columns."""
    size = np.maximum(np.abs(columns).max(axis=0, initial=0.0), np.finfo(float).tiny)
    found = np.linalg.lstsq(columns / size, values, rcond=None)[0]
    return found / (size if values.ndim == 1 else size[:, None])


def _jumps(model: CurveModel) -> list[tuple[bool, Jump]]:
    """Jumps whose moments are compared, and whether contact begins there."""
    seen = model.moments
    both = ((True, seen.snap_in), (False, seen.pull_off))
    return [(begins, jump) for begins, jump in both if jump is not None and jump.timed]


def _radius_noise(model: CurveModel) -> float:
    """Standard deviation of the measured contact radius, 0 if it was not measured."""
    radius, seen = model.curve.contact_radius, model.moments
    if radius is None:
        return 0.0
    inside = radius[seen.first : seen.last]
    noise = white_noise(inside if inside.size > 4 else radius)
    return max(noise, LEAST_RADIUS_NOISE * float(np.ptp(radius)))
