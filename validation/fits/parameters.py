"""What is asked of a fit: numbers of the scene by dotted path, and of the instrument.

A search sees plain numbers of order one within bounds: the logarithm of a positive number, any other over its
scale. Each sets the number it stands for, and at a ratio those that are tied to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from contact_scene import Branch, Machine, Scene, SceneError
from contact_scene.checked import Checked, NotNegative, Positive
from contact_scene.errors import shown
from contact_scene.scene import value_at
from contact_scene.value_checks import Range, low_and_high, one_of, whole_from
from validation.fits.model import PARTS, CurveModel
from validation.fits.record import MeasuredCurve
from validation.runs.provenance import hashed
from validation.solvers import REFERENCE, SOLVERS

CONTACT_POINT, TIME_OFFSET = "contact_point", "time_offset"
INSTRUMENT = (CONTACT_POINT, *PARTS, TIME_OFFSET)
SPRING = ("machine.stiffness", "loading.machine.stiffness")
"""Paths of the spring between stage and indenter."""
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
    ties = [(path, other) for path, _, other in (entry.partition("=") for entry in settings.tie)]
    shared = (*settings.vary, *settings.grid)
    varied = [entry.partition("=")[0] for entry in (*shared, *settings.per_curve)]
    for path, other in ties:
        if not path or path == other or not other:
            problem = f"{shown(path)} is tied to {'itself' if path == other else shown(other)}"
            raise SceneError("tie", problem, "PATH=OTHER, two numbers of the scene")
        if other not in varied:
            raise SceneError("tie", f"{other} is not varied", "ties to a number that is")
    for path in (*varied, *(path for path, _ in ties)):
        if path.startswith("loading.steps"):
            problem = "plays no part: the measured motion takes the place of the loading steps"
            raise SceneError(path, problem, "numbers of material, adhesion, indenter or machine")
        for one in models:
            if path in SPRING and one.scene.machine is None:
                problem = "plays no part: the motion of the indenter is recorded, not that of a stage"
                raise SceneError(path, problem, "curves with a column stage", one.curve.name)
    found = [_of_scene(scene, entry, ties) for entry in shared]
    for index, one in enumerate(models):
        found += [_of_scene(one.scene, entry, ties, index, one.curve.name) for entry in settings.per_curve]
        kinds = [kind for kind in dict.fromkeys(settings.free) if kind not in PARTS]
        found += [_of_instrument(one, index, kind) for kind in kinds]
    if not found:
        raise SceneError("vary", "is empty", "at least one number of the scene")
    for curve in (None, *range(len(models))):
        paths = [path for one in found if one.curve in (None, curve) for path in one.sets]
        for path in paths:
            if paths.count(path) > 1:
                raise SceneError(path, "is varied twice", "each number once")
    return tuple(found)


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
