"""What is asked of a fit: numbers of the scene by dotted path, and of the instrument; and its residuals.

A search sees plain numbers of order one within bounds: the logarithm of a positive number, any other over its
scale. Each sets the number it stands for, and at a ratio those that are tied to it.

The background (level, drift, tilt, drag, a wave) is linear and no parameter of the search: it costs no run,
and every point has the one that makes its residuals least (Golub and Pereyra, SIAM J. Numer. Anal. 10, 413,
1973). The time offset is a shift of the same run. All other derivatives are differences of runs, which share
no work and may be carried out side by side. Where the batch solver takes the runs, those of a point and of
its differences are one batch: its steps depend on the numbers that are varied by powers of two alone, so
hardly does its error, while steps that are chosen anew for each run may turn a difference into one of errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from contact_scene import Branch, Hold, Machine, Ramp, Scene, SceneError, Table
from contact_scene.checked import Checked, NotNegative, Positive
from contact_scene.errors import shown
from contact_scene.scene import value_at
from contact_scene.value_checks import Range, low_and_high, one_of, whole_from
from validation.fits.contact import Array
from validation.fits.model import (
    BACKGROUND,
    NO_CONTACT,
    CurveModel,
    FitRun,
    Prediction,
    least_squares,
    run_of,
)
from validation.fits.moments import SMALLEST
from validation.fits.record import MeasuredCurve
from validation.reference import batch
from validation.runs.pool import Task, TaskResult, run_tasks
from validation.runs.provenance import fingerprint, hashed
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS

CONTACT_POINT, TIME_OFFSET = "contact_point", "time_offset"
INSTRUMENT = (CONTACT_POINT, *BACKGROUND, TIME_OFFSET)
SPRING = ("machine.stiffness", "loading.machine.stiffness")
"""Paths of the spring between stage and indenter."""
ERROR_SHARE = 0.05
"""Error of a run over the noise, at most: as much of its deviation moves a parameter if the error is unlike
all derivatives; what is along one moves it by up to the root of the number of rows times as much."""
SETTLED = 0.01
"""Change of the sum of squares, over the variance of a residual, at which a search ends, and up to which two
solvers agree: the cost of a parameter that is off by a tenth of its deviation."""
TOLERANCES = (1.6e-4, 4e-5, 1e-5, 2.5e-6)
"""Tolerances of the reference's time steps that are tried: each is half the step of the one before, the first
is four steps per process zone, the fewest that resolve one."""
RANGE, TIME_SHARE = 1e3, 0.1
"""Factor about the scene's value within which a positive parameter is searched, if no bounds are given; and
time offset over the duration of a record, at most."""
LIMITED = {"material.poisson": (0.0, 0.5)}
"""Numbers that may not leave an interval, by path."""
REGULARISATION = 0.1
"""Weight of the squared second differences of the logarithms of Prony weights, beside squares of residuals:
neighbours on the grid may bend by a factor of exp(3) at the cost of one standard deviation."""

SHARE = Range("a share of the range between 0 and 1", 0.0, 1.0, open=True)


@dataclass(frozen=True)
class FitSettings(Checked):
    """What to fit and how: see :func:`crosscontact.fit`; one name needs no sequence around it."""

    vary: tuple[str, ...] = ()
    tie: tuple[str, ...] = ()
    per_curve: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    prony: tuple[Positive, ...] = ()
    regularisation: NotNegative | None = REGULARISATION
    starts: Annotated[int, whole_from(1)] = 3
    seed: Annotated[int, whole_from(0)] = 0
    profile: tuple[str, ...] = ()
    solver: str = REFERENCE
    resolution: Annotated[int, whole_from(1)] | None = None
    check_solver: str | None = "bem"
    max_steps: Annotated[int, whole_from(1)] | None = None
    within: Annotated[float, SHARE] | None = None
    posterior: bool = False

    def __post_init__(self) -> None:
        plain = {"regularisation": REGULARISATION} if self.regularisation is None else {}
        names = ("vary", "tie", "per_curve", "free", "profile")
        alone = {name: (at,) for name in names if isinstance(at := getattr(self, name), str)}
        for name, value in (plain | alone).items():
            object.__setattr__(self, name, value)
        super().__post_init__()

    def rules(self) -> None:
        for name in self.free:
            one_of(name, "free", INSTRUMENT)
        one_of(self.solver, "solver", tuple(SOLVERS))
        one_of(self.check_solver or "none", "check_solver", ("none", *SOLVERS))
        if list(self.prony) != sorted(set(self.prony)):
            raise SceneError("prony", f"got {shown(self.prony)}", "rising relaxation times")

    @property
    def grid(self) -> tuple[str, ...]:
        """Paths of the moduli on the fixed relaxation times."""
        return tuple(f"material.branches[{index}].modulus" for index in range(len(self.prony)))


def question(curves: Sequence[MeasuredCurve], scene: Scene, settings: FitSettings) -> dict[str, str]:
    """Hashes of curves, first guess and parameters; not of how the fit is carried out."""
    varied = settings.vary, settings.tie, settings.per_curve, settings.free, settings.prony
    return {
        "curves": hashed([replace(curve, name="") for curve in curves]),
        "first guess": hashed(scene),
        "parameters": hashed(varied if settings.within is None else (*varied, settings.within)),
    }


def first_guess(curves: Sequence[MeasuredCurve], scene: Scene, settings: FitSettings) -> Scene:
    """The scene on the spring of the curves, where it has none and they share one, with the Prony series."""
    springs = {None if curve.stage is None else curve.stiffness for curve in curves}
    [spring] = springs if len(springs) == 1 else [None]
    if scene.machine is None and spring is not None:
        scene = replace(scene, loading=replace(scene.loading, machine=Machine(spring)))
    if not settings.prony:
        return scene
    relaxing = scene.material.glassy_modulus - scene.material.modulus or scene.material.modulus
    branches = tuple(Branch(relaxing / len(settings.prony), time) for time in settings.prony)
    return replace(scene, material=replace(scene.material, branches=branches))


@dataclass(frozen=True)
class Unknown:
    """One number that is searched, with its first guess and bounds; of one curve alone it bears its name. It
    ``sets`` numbers by path, each at a ratio to its value."""

    name: str
    start: float
    low: float
    high: float
    logarithmic: bool = False
    scale: float = 1.0
    curve: int | None = None
    sets: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.low <= self.start <= self.high or self.low >= self.high:
            problem = f"starts at {self.start:.6g}, with bounds {self.low:.6g} to {self.high:.6g}"
            raise SceneError(self.name, problem, "bounds with the value of the scene between them")

    def plain(self, value: float) -> float:
        """The number that the search sees."""
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, plain: float) -> float:
        """The parameter of a number of the search."""
        return math.exp(plain) if self.logarithmic else plain * self.scale


def unknowns(models: Sequence[CurveModel], scene: Scene, settings: FitSettings) -> tuple[Unknown, ...]:
    """All parameters of a fit with their first guesses: shared ones, then those of each curve."""
    shared = (*settings.vary, *settings.grid)
    varied = [entry.partition("=")[0] for entry in (*shared, *settings.per_curve)]
    ties = [(path, other) for path, _, other in (entry.partition("=") for entry in settings.tie)]
    for path, other in ties:
        if not path or path == other or not other:
            problem = f"{shown(path)} is tied to {'itself' if path == other else shown(other)}"
            raise SceneError("tie", problem, "PATH=OTHER, two numbers of the scene")
        if other not in varied:
            raise SceneError("tie", f"{other} is not varied", "ties to a number that is")
    for path in (*varied, *(path for path, _ in ties)):
        _check_part(path, models)
    found = [_of_scene(scene, entry, ties) for entry in shared]
    for index, model in enumerate(models):
        found += [
            _of_scene(model.scene, entry, ties, index, model.curve.name) for entry in settings.per_curve
        ]
        kinds = [kind for kind in dict.fromkeys(settings.free) if kind not in BACKGROUND]
        found += [_of_instrument(model, index, kind) for kind in kinds]
    if not found:
        raise SceneError("vary", "is empty", "at least one number of the scene")
    for curve in (None, *range(len(models))):
        paths = [path for one in found if one.curve in (None, curve) for path in one.sets]
        for path in paths:
            if paths.count(path) > 1:
                raise SceneError(path, "is varied twice", "each number once")
    return tuple(found)


def _check_part(path: str, models: Sequence[CurveModel]) -> None:
    """Refuse a number of the scene that plays no part in the model of a curve."""
    if path.startswith("loading.steps"):
        problem = "plays no part: the measured motion takes the place of the loading steps"
        raise SceneError(path, problem, "numbers of material, adhesion, indenter or machine")
    for model in models:
        if path in SPRING and model.scene.machine is None:
            problem = "plays no part: the motion of the indenter is recorded, not that of a stage"
            raise SceneError(path, problem, "curves with a column stage", model.curve.name)


def _of_scene(
    scene: Scene, entry: str, ties: Iterable[tuple[str, str]], curve: int | None = None, of: str = ""
) -> Unknown:
    """The unknown of ``PATH``, ``PATH=LOW:HIGH`` or ``PATH=LOW:HIGH:linear``, with the paths tied to it."""
    path, _, limits = entry.partition("=")
    start, tied = value_at(scene, path), [tie for tie, other in ties if other == path]
    linear = limits.endswith(":linear")
    low, high = low_and_high(limits.removesuffix(":linear"), path) if limits else (None, None)
    least, most = LIMITED.get(path, (-math.inf, math.inf))
    logarithmic = not linear and start > 0.0 and path not in LIMITED and (low is None or low > 0.0)
    reach = RANGE * max(abs(start), 1e-3)
    widest = (start / RANGE, start * RANGE) if logarithmic else (start - reach, start + reach)
    low = max(widest[0] if low is None else low, least)
    high = min(widest[1] if high is None else high, most)
    if start == 0.0 and tied:
        raise SceneError(path, "is zero, and others are tied to it", "a value that ratios refer to")
    ratios = {path: 1.0} | {tie: value_at(scene, tie) / start for tie in tied}
    name = path if curve is None else f"{path}@{of}"
    return Unknown(name, start, low, high, logarithmic, abs(start) or high - low, curve, ratios)


def _of_instrument(model: CurveModel, index: int, kind: str) -> Unknown:
    """Contact point or time offset of a curve, with its first guess from the record."""
    curve, seen = model.curve, model.moments
    start, scale = 0.0, float(np.ptp(curve.time if kind == TIME_OFFSET else curve.position))
    reach = TIME_SHARE * scale if kind == TIME_OFFSET else scale
    if kind == CONTACT_POINT and 0 < seen.first < seen.last and model.scene.loading.start != "relaxed":
        first_touch = float(curve.position[seen.first - 1 : seen.first + 1].mean())
        start = first_touch - model.scene.loading.penetration
    name = f"{kind}@{curve.name}"
    return Unknown(name, start, start - reach, start + reach, False, scale, index, {kind: 1.0})


@dataclass(frozen=True)
class Point:
    """A point of the search: runs at the rows of the curves; residuals (R,) ``raw``, and with the background
    that makes them least; which ``hold``, which are of rows in contact; parts of the background as columns
    over the noise (R, Q), and how much there is of each (Q,)."""

    predictions: Sequence[Prediction]
    raw: Array
    residuals: Array
    hold: NDArray[np.bool_]
    touching: NDArray[np.bool_]
    columns: Array
    background: Array


@dataclass
class FitProblem:
    """Residuals and derivatives of curves, and last those of a regularisation; ``tolerance`` is that of time
    steps where no resolution is asked for, ``step`` that of differences, ``runs`` what was carried out;
    ``quick`` has its runs in batches, if they can be."""

    models: Sequence[CurveModel]
    unknowns: Sequence[Unknown]
    settings: FitSettings
    executor: Executor | None = None
    store: Store = field(default_factory=Store)
    tolerance: float | None = None
    step: float = 1e-3
    runs: int = 0
    on_run: Callable[[], None] = lambda: None
    quick: BatchProblem | None = None
    _kept: dict[str, FitRun] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.names = [one.name for one in self.unknowns]
        self.start = np.array([one.plain(one.start) for one in self.unknowns])
        self.bounds = tuple(
            np.array([one.plain(at) for one, at in zip(self.unknowns, ends, strict=True)])
            for ends in ([one.low for one in self.unknowns], [one.high for one in self.unknowns])
        )
        # Second differences of logarithms, which are numbers of the search; without weight they are no rows.
        weight = self.settings.regularisation or 0.0
        bent = [self.names.index(name) for name in self.settings.grid if weight > 0.0]
        self._bending = math.sqrt(weight) * np.diff(np.eye(len(self.names))[bent], 2, axis=0)
        sizes = [model.prediction(NO_CONTACT, 0.0).residuals.size for model in self.models]
        begins = np.cumsum([0, *sizes]).tolist()
        self.size = begins[-1] + len(self._bending)
        rows = [(begin, begin + one.curve.time.size) for begin, one in zip(begins, self.models, strict=False)]
        self.force_rows = [slice(*both) for both in rows]
        backgrounds = [model.background(self.settings.free) for model in self.models]
        self.parts = [(curve, name) for curve, own in enumerate(backgrounds) for name in own]
        self.columns = np.zeros((self.size, len(self.parts)))
        for place, (curve, name) in enumerate(self.parts):
            column = backgrounds[curve][name] / self.models[curve].allowed
            self.columns[self.force_rows[curve], place] = column

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
        return self.at(x).residuals

    def at(self, x: Array) -> Point:
        """A point of the search."""
        return self.all_at([x])[0]

    def all_at(self, points: Iterable[Array]) -> list[Point]:
        """Points of the search, whose runs are carried out together, equal ones once."""
        settings, asked, tasks = self.settings, [], {}
        how = settings.solver, settings.resolution, self.tolerance, settings.max_steps
        places = list(points)
        for x in places:
            for curve, model in enumerate(self.models):
                values = self.values(x, curve)
                contact, offset = (values.pop(name, 0.0) for name in (CONTACT_POINT, TIME_OFFSET))
                try:
                    scene, begin = model.scene_of(values, contact)
                    key = fingerprint("fit", scene, *how)
                    if key not in self._kept:
                        tasks[key] = Task(key, f"curve {curve + 1}", run_of, (scene, *how), FitRun)
                except SceneError as error:  # a corner of the search that no scene may have
                    key, begin = str(error), float(model.curve.time[-1])
                    self._kept[key] = replace(NO_CONTACT, failure=key)
                asked.append((model, key, begin, offset))
        self.carry_out(tasks)
        made = [model.prediction(self._kept[key], begin, offset) for model, key, begin, offset in asked]
        count = len(self.models)
        return [self._point(x, made[n * count : (n + 1) * count]) for n, x in enumerate(places)]

    def _point(self, x: Array, predicted: Sequence[Prediction]) -> Point:
        """A point with its runs and the background that makes its residuals least."""
        bending = self._bending @ x
        hold = np.concatenate([*(one.hold for one in predicted), np.ones(bending.size, bool)])
        touching = np.concatenate([*(one.touching for one in predicted), np.zeros(bending.size, bool)])
        raw = np.where(hold, np.concatenate([*(one.residuals for one in predicted), bending]), 0.0)
        columns = np.where(hold[:, None], self.columns, 0.0)
        background = -least_squares(columns, raw)
        return Point(predicted, raw, raw + columns @ background, hold, touching, columns, background)

    def beside(self, x: Array) -> tuple[Array, list[Point]]:
        """Steps of the numbers of the search; the point, and those a step beside it."""
        steps = np.where(x + self.step <= self.bounds[1], self.step, -self.step)
        return steps, self.all_at([x, *(x + np.diag(steps))])

    def derivatives(self, x: Array) -> Array:
        """Derivatives by the numbers of the search with the background held, shape (R, P); a row that comes
        into contact or loses it on the way has one on either side only."""
        if self.quick is not None:
            return self.quick.derivatives(x)
        steps, (now, *others) = self.beside(x)
        slopes = [
            np.where(now.touching == one.touching, one.raw - now.raw, 0.0) / step
            for step, one in zip(steps, others, strict=True)
        ]
        return np.column_stack(slopes)

    def jacobian(self, x: Array) -> Array:
        """Derivatives by the numbers of the search, the background following, shape (R, P)."""
        slopes, columns = self.derivatives(x), self.at(x).columns
        return slopes - columns @ least_squares(columns, slopes)

    def carry_out(self, tasks: Mapping[str, Task]) -> None:
        """Runs that are kept, by their keys, side by side."""

        def keep(result: TaskResult) -> None:
            self.keep(result.task.key, result.value or replace(NO_CONTACT, failure=result.failure))

        executor = self.executor if len(tasks) > 1 else None
        run_tasks(tasks.values(), executor, self.store, on_result=keep)

    def keep(self, key: str, run: FitRun) -> None:
        """Keep a run that was carried out."""
        self._kept[key] = run
        self.runs += 1
        self.on_run()

    def forget(self) -> None:
        """Keep no run any more."""
        self._kept.clear()


class BatchProblem(FitProblem):
    """A problem whose runs are those of the batch solver."""

    @classmethod
    def of(cls, problem: FitProblem) -> BatchProblem | None:
        """The problem in batches, if all runs of the first guess can be; some may end early."""
        if problem.settings.solver != REFERENCE:
            return None
        found = cls(**{one.name: getattr(problem, one.name) for one in fields(problem)} | {"_kept": {}})
        answered = all(one.touching.any() for one in found.at(found.start).predictions)
        return found if answered else None

    def agrees(self, other: FitProblem, x: Array) -> bool:
        """Whether all runs of a point and of its differences came to their end, and residuals of the other
        problem have their least, but for what a search leaves, with the same parameters."""
        own, slopes = self.residuals(x), self.jacobian(x)
        along = slopes @ least_squares(slopes, own - other.residuals(x))
        failed = any(one.failure for point in self.beside(x)[1] for one in point.predictions)
        return not failed and bool(along @ along <= SETTLED * np.mean(own**2))

    def at(self, x: Array) -> Point:
        return self.beside(x)[1][0]  # in one batch

    def carry_out(self, tasks: Mapping[str, Task]) -> None:
        scenes = [as_ramps(task.arguments[0]) for task in tasks.values()]
        for key, one in zip(tasks, batch.solve(scenes), strict=True):
            run = replace(NO_CONTACT, failure=one.reason)
            if one.answered:
                lost = float(one.time[-1]) if one.detached or one.reason else None
                run = FitRun(one.time, one.force, one.contact_radius, one.penetration, lost, one.reason)
            self.keep(key, run)


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
