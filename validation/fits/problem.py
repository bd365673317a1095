"""Residuals of curves by the numbers of a search, and the search for those that make them least.

The background is linear and no number of the search, and the time offset is a shift of the same run. All
other derivatives are differences of runs, which share no work and may be carried out side by side. Where the
batch solver takes the runs, those of a point and of its differences are one batch: its steps depend on the
numbers that are varied by powers of two alone, so hardly does its error, while steps that are chosen anew for
each run may turn a difference into one of errors.

The first start of the search is the scene's own values. If it leads to a model that explains the data there
is nothing better to be found; otherwise more are drawn in its neighbourhood, each is followed a few
iterations, and the best of all to its end. Where the batch solver takes the runs all this is done with it,
and a last search from there has the residuals of the reference; if the two disagree, all is done again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from contact_scene import Hold, Ramp, Scene, SceneError, Table
from validation.fits.contact import Array, least_squares
from validation.fits.model import (
    NO_CONTACT,
    SMALLEST,
    CurveModel,
    FitRun,
    FittedCurve,
    Residuals,
    first_passing,
    rms,
    run_of,
)
from validation.fits.parameters import CONTACT_POINT, TIME_OFFSET, FitSettings, Unknown
from validation.fits.result import CHI_SQUARED, goodness, independent
from validation.reference import batch
from validation.runs.pool import Task, TaskResult, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store
from validation.solvers import REFERENCE

ERROR_SHARE = 0.05
"""Error of a run over the noise, at most: as much of its deviation moves a parameter if the error is unlike
all derivatives; what is along one moves it by up to the root of the number of rows times as much."""
ORDER_TWO = 4.0 / 3.0
"""Error of a run over its difference from a run of half the step, for a method of second order."""
SETTLED = 0.01
"""Change of the sum of squares, over the variance of a residual, at which a search ends, and up to which two
solvers agree: the cost of a parameter that is off by a tenth of its deviation."""
TOLERANCES = (1.6e-4, 4e-5, 1e-5, 2.5e-6)
"""Tolerances of the reference's time steps that are tried: each is half the step of the one before, the first
is four steps per process zone, the fewest that resolve one."""
SMALLEST_STEP, LARGEST_STEP = 1e-4, 1e-2
"""Bounds of the step of differences, the root of the relative error of a run: the best if the errors of two
neighbouring runs have nothing in common."""
SPREAD, DRAWN_BEFORE = np.log(3.0), 4
"""Starts are drawn within a factor of three about the scene's values (whoever knows less states bounds); of
so many points the one of least misfit is taken."""
EXPLORING, MOST_EVALUATIONS, PROFILING = 4, 40, 6
"""Evaluations, behind the first, of a start before starts are compared, of the last search, and with one
parameter held."""
STEPS, WIDEST = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0), 1.0
"""Distances from the best value at which a profile fits the others, in standard deviations of at most one: a
factor of 20 on each side."""


@dataclass
class FitProblem:
    """Residuals of curves, and last those of a regularisation, with their derivatives, and the best point of
    all that were tried; ``tolerance`` is that of time steps where no resolution is asked for, ``step`` that
    of differences, ``runs`` what was carried out. All runs are ``batched``, or only those of derivatives,
    where the problem in batches, ``quick``, is ``trusted``."""

    models: Sequence[CurveModel]
    unknowns: Sequence[Unknown]
    settings: FitSettings
    executor: Executor | None = None
    store: Store = field(default_factory=Store)
    tell: Callable[[str], None] = lambda text: None
    tolerance: float | None = None
    step: float = 1e-3
    batched: bool = False
    quick: FitProblem | None = None
    trusted: bool = False

    def __post_init__(self) -> None:
        self.names = [one.name for one in self.unknowns]
        start, low, high = (
            np.array([one.plain(getattr(one, at)) for one in self.unknowns])
            for at in ("start", "low", "high")
        )
        self.start, self.bounds, self.kept = start, (low, high), dict[str, FitRun]()
        self.best, self.least, self.points, self.runs, self.stage = start, np.inf, 0, 0, "first guess"
        self.starts, self.ended, self.converged = list[float](), "interrupted", False
        # Second differences of logarithms, which are numbers of the search; without weight they are no rows.
        weight = self.settings.regularisation or 0.0
        bent = [self.names.index(name) for name in self.settings.grid if weight > 0.0]
        self._bending = math.sqrt(weight) * np.diff(np.eye(len(self.names))[bent], 2, axis=0)

    @property
    def all_runs(self) -> int:
        """How many were carried out, in batches or by themselves."""
        return self.runs + (self.quick.runs if self.quick else 0)

    def values(self, x: Array, curve: int | None = None) -> dict[str, float]:
        """What a point sets by path: for a curve, or only what all curves share."""
        return {
            path: ratio * one.value(at)
            for one, at in zip(self.unknowns, x.tolist(), strict=True)
            if one.curve in (None, curve)
            for path, ratio in one.sets.items()
        }

    def residuals(self, x: Array) -> Array:
        """Residuals at a point of the search, shape (R,)."""
        return np.concatenate([one.values for one in self.at(x)])

    def curves_at(self, x: Array) -> list[FittedCurve]:
        """The curves beside their runs at a point."""
        return [one for one in self.at(x) if isinstance(one, FittedCurve)]

    def at(self, x: Array) -> Sequence[Residuals]:
        """Residuals of each curve, and of the regularisation."""
        return self.beside(x)[1][0] if self.batched else self.all_at([x])[0]

    def beside(self, x: Array) -> tuple[Array, list[Sequence[Residuals]]]:
        """Steps of the numbers of the search; the point, and those a step beside it."""
        steps = np.where(x + self.step <= self.bounds[1], self.step, -self.step)
        return steps, self.all_at([x, *(x + np.diag(steps))])

    def all_at(self, points: Iterable[Array]) -> list[Sequence[Residuals]]:
        """Residuals of some points, whose runs are carried out together, equal ones once."""
        settings, asked, tasks = self.settings, [], {}
        how = settings.solver, settings.resolution, self.tolerance, settings.max_steps
        places = list(points)
        for x in places:
            for curve, model in enumerate(self.models):
                values = self.values(x, curve)
                zero, offset = (values.pop(name, 0.0) for name in (CONTACT_POINT, TIME_OFFSET))
                try:
                    scene, begin = model.scene_of(values, zero)
                    key = fingerprint("fit", scene, *how)
                    if key not in self.kept:
                        tasks[key] = Task(key, f"curve {curve + 1}", run_of, (scene, *how), FitRun)
                except SceneError as error:  # a corner of the search that no scene may have
                    key, begin = str(error), float(model.curve.time[-1])
                    self.kept[key] = replace(NO_CONTACT, failure=key)
                asked.append((model, key, begin, offset, zero))
        self._carry_out(tasks)
        made = iter([model.beside(self.kept[key], *clock) for model, key, *clock in asked])
        found: list[Sequence[Residuals]] = []
        for x in places:
            bending = self._bending @ x
            rows = np.ones(bending.size, bool)
            last = Residuals(bending, np.empty((bending.size, 0)), ~rows, rows)
            found.append([*(next(made) for _ in self.models), last])
        return found

    def _carry_out(self, tasks: Mapping[str, Task]) -> None:
        """Runs that are kept, by their keys, side by side or in a batch."""

        def keep(key: str, run: FitRun) -> None:
            self.kept[key] = run
            self.runs += 1
            if not np.isfinite(self.least):  # it moves before there is a point
                self.tell(f"{self.stage}, run {self.runs}")

        def keep_result(result: TaskResult) -> None:
            keep(result.task.key, result.value or replace(NO_CONTACT, failure=result.failure))

        if not self.batched:
            executor = self.executor if len(tasks) > 1 else None
            run_tasks(tasks.values(), executor, self.store, on_result=keep_result)
            return
        scenes = [as_ramps(task.arguments[0]) for task in tasks.values()]
        for key, one in zip(tasks, batch.solve(scenes), strict=True):
            run = replace(NO_CONTACT, failure=one.reason)
            if one.answered:
                lost = float(one.time[-1]) if one.detached or one.reason else None
                run = FitRun(one.time, one.force, one.contact_radius, one.penetration, lost, one.reason)
            keep(key, run)

    def derivatives(self, x: Array, following: bool = False) -> Array:
        """Derivatives by the numbers of the search, the background held or ``following``, shape (R, P); a row
        that comes into contact or loses it on the way has one on either side only."""
        steps, (now, *others) = (self.quick if self.quick and self.trusted else self).beside(x)
        found = []
        for own, *beside in zip(now, *others, strict=True):
            moved = zip(steps, beside, strict=True)
            slopes = [
                np.where(own.touching == one.touching, one.raw - own.raw, 0.0) / at for at, one in moved
            ]
            found.append(np.column_stack(slopes))
        if following:
            parts = zip(found, (one.columns for one in self.at(x)), strict=True)
            found = [slopes - columns @ least_squares(columns, slopes) for slopes, columns in parts]
        return np.concatenate(found)

    def in_batches(self) -> FitProblem | None:
        """The problem in batches, if all runs of the first guess can be; some may end early."""
        found = replace(self, batched=True)
        solved = self.settings.solver == REFERENCE and found.curves_at(found.start)
        return found if solved and all(one.touching.any() for one in solved) else None

    def agrees(self, quick: FitProblem, x: Array) -> bool:
        """Whether all batched runs of a point and of its differences came to their end, and residuals in
        batches have their least, but for what a search leaves, with the same parameters."""
        own, slopes = quick.residuals(x), quick.derivatives(x, following=True)
        along = slopes @ least_squares(slopes, own - self.residuals(x))
        runs = (one for point in quick.beside(x)[1] for one in point if isinstance(one, FittedCurve))
        return not any(one.failure for one in runs) and bool(along @ along <= SETTLED * np.mean(own**2))

    def choose_steps(self, x: Array) -> float | None:
        """Give the runs the coarsest time steps with an error small beside the noise, and differences a step;
        the error over the noise at a point comes back, if it was for the fit to choose."""
        if self.settings.resolution is not None or self.settings.solver != REFERENCE:
            return None
        data = np.concatenate([one.curve.force / one.allowed for one in self.models])
        self.stage, self.tolerance = "choosing time steps", TOLERANCES[0]
        coarse = self.curves_at(x)
        for kept, finer in pairwise(TOLERANCES):
            self.tolerance = finer
            fine = self.curves_at(x)
            pairs = zip(fine, coarse, strict=True)
            change = np.concatenate([(one.values - two.values)[: one.of_run.size] for one, two in pairs])
            share, coarse = ORDER_TWO * rms(change), fine
            self.tolerance = kept
            if share <= ERROR_SHARE:
                break
        self.step = float(np.clip(np.sqrt(share / rms(data)), SMALLEST_STEP, LARGEST_STEP))
        return share

    def search(self) -> float | None:
        """Find the parameters, from as many starts as it takes; the error of runs over the noise."""
        if (quick := self.in_batches()) is not None:
            self.quick = quick
            try:
                quick.follow_starts("first start")
            finally:
                self.best, self.least, self.starts = quick.best, quick.least, quick.starts
        share, stage = self.choose_steps(self.best), "by the reference"
        self.trusted = quick is not None and self.agrees(quick, self.best)
        self.least = np.inf
        if not self.trusted:
            self.best, self.starts, stage = self.start, [], "first start"
        self.follow_starts(stage)
        return share

    def follow_starts(self, stage: str) -> None:
        """The search from the best point so far, and, if that explains too little and one of them is better,
        from the best of further starts, each the best of a few points drawn about the scene's values."""
        self.stage, settings = stage, self.settings
        nowhere = [one for one in self.curves_at(self.best) if not one.touching.any()]
        if nowhere or not self.derivatives(self.best).any():
            reason = "".join(f": {one.failure}" for one in nowhere[:1])
            told = f"no parameter changes the force at the first guess{reason}"
            raise SceneError("vary", told, "a first guess that comes to contact and can be run")
        followed = self.followed(self.best, MOST_EVALUATIONS)
        free = [one.logarithmic for one in self.unknowns]
        if len(self.starts) < 2:  # or more were followed in batches
            self.starts = [2.0 * followed.cost]
            good = goodness(self.curves_at(self.best), self.residuals(self.best), settings, len(free))
            more = 0 if good.explained or not any(free) else settings.starts - 1
            shape = more, DRAWN_BEFORE, len(free)
            drawn = np.random.default_rng(settings.seed).uniform(-SPREAD, SPREAD, shape)
            groups, first = np.clip(self.start + drawn * free, *self.bounds), self.least
            starts = [min(points, key=lambda x: float(np.sum(self.tried(x) ** 2))) for points in groups]
            for number, x in enumerate(starts, 2):
                self.stage = f"start {number} of {settings.starts}"
                self.starts.append(2.0 * self.followed(x, EXPLORING).cost)
            if self.least < first:
                self.stage = "best start"
                followed = self.followed(self.best, MOST_EVALUATIONS)
        self.ended, self.converged = followed.message, bool(followed.success)

    def tried(self, x: Array) -> Array:
        """Residuals at a point, which is noted."""
        found = self.residuals(x)
        self.points += 1
        total = float(found @ found)
        if total < self.least:
            self.best, self.least = x.copy(), total
        now, best = (np.sqrt(value / found.size) for value in (total, self.least))
        self.tell(f"{self.stage}, point {self.points}: misfit {now:.4g}, best {best:.4g}")
        return found

    def followed(self, x: Array, evaluations: int, held: int | None = None) -> Any:
        """Least squares from a point, of all parameters but one that is held."""
        from scipy import optimize

        varied, at = np.arange(x.size) != held, x.copy()

        def whole(values: Array) -> Array:
            at[varied] = values
            return at

        found = optimize.least_squares(
            lambda values: self.tried(whole(values)),
            x[varied],
            lambda values: self.derivatives(whole(values), following=True)[:, varied],
            tuple(ends[varied] for ends in self.bounds),
            x_scale="jac",
            ftol=SETTLED / self.residuals(x).size,
            xtol=1e-6,
            gtol=None,
            max_nfev=1 + evaluations,
        )
        found.x = whole(found.x)
        return found

    def profile(self, place: int, best: Array, deviation: float, variance: float) -> dict[str, Any]:
        """Profile likelihood of a parameter, whose interval ends where the least sum of squares has grown by
        the 95 % point of chi-squared (Venzon and Moolgavkar, Appl. Stat. 37, 87, 1988)."""
        one, points, weights = self.unknowns[place], {float(best[place]): 0.0}, independent(self.at(best))
        size = min(deviation if one.logarithmic else deviation / one.scale, WIDEST)

        def weighed(x: Array) -> float:
            return float(np.sum((self.residuals(x) * weights) ** 2))

        least = weighed(best)
        for sign in (-1.0, 1.0):
            x = best.copy()
            for step in STEPS:
                x[place] = best[place] + sign * step * size
                x = np.clip(x, *self.bounds)
                self.stage = f"profile of {one.name} at {one.value(x[place]):.4g}"
                if len(x) > 1:
                    x = self.followed(x, PROFILING, held=place).x
                points[float(x[place])] = max((weighed(x) - least) / variance, 0.0)
        at, increases = np.array(sorted(points.items())).T
        middle = int(np.searchsorted(at, best[place]))
        sides = slice(middle, None, -1), slice(middle, None)
        plain = (first_passing(at[s], np.sqrt(increases[s]), np.sqrt(CHI_SQUARED)) for s in sides)
        low, high = (None if end is None else one.value(end) for end in plain)
        values = [one.value(here) for here in at.tolist()]
        return {"name": one.name, "values": values, "increases": increases, "low": low, "high": high}


def as_ramps(scene: Scene) -> Scene:
    """The scene with its table of the motion as ramps and holds."""
    [table] = scene.loading.steps
    assert isinstance(table, Table)
    least, at = SMALLEST * float(np.ptp(table.values)), table.values[0]
    steps: list[Ramp | Hold] = []
    for (begin, end), to in zip(pairwise(table.times), table.values[1:], strict=True):
        rise, lasts = abs(to - at), end - begin
        steps.append(Hold(lasts) if rise <= least else Ramp(to, rise / lasts))
        at = at if rise <= least else to
    return replace(scene, loading=replace(scene.loading, steps=tuple(steps)))
