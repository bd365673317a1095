"""Refinement ladders and their convergence: values, signed orders, Richardson value, grid convergence index.

Each observable is extrapolated from its values alone and compared with the finest front tracking. A level
that failed keeps its place.
"""

from __future__ import annotations

import math
import time
import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from contact_scene import Scene, Trace
from validation.cases import Case
from validation.measure.approach import is_located
from validation.measure.difference import of_numbers
from validation.measure.norms import distance
from validation.measure.scalars import measure
from validation.measure.scaling import Magnitudes
from validation.measure.windows import cycle_times
from validation.runs.run import Run
from validation.studies import schemes
from validation.studies.extrapolation import Extrapolation, extrapolate, fitted_slope, reference_orders
from validation.studies.ladders import Ladder, Level

SCALARS = (
    "start_force",
    "start_radius",
    "approach_force",
    "approach_radius",
    "pull_off_force",
    "detachment_penetration",
    "loop_energy",
    "dissipated_energy",
    "peak_cycle_loss",
)
NORMS = ("force, RMS", "force, mean", "force, largest", "radius, RMS")
"""Errors of curves, relative to the largest magnitude of the reference (:mod:`validation.measure.norms`)."""
REPEATS = 3
"""Largest number of runs of a timed level, of which the fastest counts."""
ENOUGH_SECONDS = 1.0
"""Wall time of all runs of a level after which it is not repeated: longer ones scatter little."""


@dataclass(frozen=True)
class LevelRun:
    """One level: its results, or why it has none.

    ``wall_seconds`` and ``cpu_seconds`` are the smallest of ``repeats`` runs, imports excluded, meshing and
    assembly included. ``errors`` are signed and relative (:func:`scales`); norms are relative to the
    largest magnitude of the reference. ``refused``: the scheme does not take the scene, which is no failure.
    """

    level: Level
    values: dict[str, float | None] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    counters: dict[str, int] = field(default_factory=dict)
    wall_seconds: float | None = None
    cpu_seconds: float | None = None
    repeats: int = 0
    outcome: str = ""
    failure: str = ""
    refused: bool = False
    details: str = ""

    @property
    def failed(self) -> bool:
        """Whether this level has no complete result."""
        return bool(self.failure)

    @property
    def breakdown(self) -> str:
        """Why there is no result, where another attempt may give one."""
        return "" if self.outcome else self.failure


@dataclass(frozen=True)
class Row:
    """One observable on one ladder.

    Parameters
    ----------
    values : tuple of float or None
        By level; ``None`` for norms, which have no value but their error.
    errors, orders : tuple of float or None
        Relative errors against the reference, and the signed order of every two neighbouring levels.
    fitted : float or None
        Slope of ``log |error|`` over ``log h`` through all levels.
    scale : float
        What errors and the index are relative to.
    alone : Extrapolation or None
        Observed orders and error bound from the values alone.
    """

    observable: str
    values: tuple[float | None, ...]
    errors: tuple[float | None, ...]
    orders: tuple[float | None, ...]
    fitted: float | None
    scale: float
    alone: Extrapolation | None


@dataclass(frozen=True)
class Convergence:
    """A ladder with its runs and observables."""

    ladder: Ladder
    nominal: float
    runs: tuple[LevelRun, ...]
    rows: tuple[Row, ...]


def solve_level(case: Case, scheme: str, level: Level, max_steps: int | None = None) -> Trace:
    """One run of one level.

    Parameters
    ----------
    case : Case
    scheme : str
        Name.
    level : Level
    max_steps : int or None
        ``None``: the solver's own bound.

    Returns
    -------
    Trace
    """
    stop_times = cycle_times(case.scene.loading)
    return schemes.scheme(scheme).solve(case.scene, level.settings, stop_times, max_steps)


def run_level(
    case: Case,
    scheme: str,
    level: Level,
    reference: Trace | None,
    max_steps: int | None = None,
    repeats: int = 1,
) -> LevelRun:
    """Run a level, repeatedly while that is cheap; a breakdown becomes part of the result.

    Parameters
    ----------
    case : Case
    scheme : str
        Name.
    level : Level
    reference : Trace or None
        Run that errors are measured against; ``None``: no errors.
    max_steps : int or None
        ``None``: the solver's own bound.
    repeats : int
        Largest number of runs, of which the fastest is timed.

    Returns
    -------
    LevelRun
    """
    try:
        schemes.scheme(scheme).solver.load()  # imports are not part of a run
        scene = schemes.with_zone(case.scene, level.settings.zone_factor)
        wall, cpu, trace = _timed(lambda: solve_level(case, scheme, level, max_steps), repeats)
    except Exception as error:
        failure = f"{type(error).__name__}: {' '.join(str(error).split())}"
        return LevelRun(level, failure=failure, details=traceback.format_exc())
    level_run = LevelRun(
        level,
        counters=asdict(trace.counters),
        wall_seconds=min(wall),
        cpu_seconds=min(cpu),
        repeats=len(wall),
        outcome=str(trace.outcome.kind),
    )
    if not trace.outcome.finished:
        return replace(level_run, failure=f"{trace.outcome.kind}: {trace.outcome.reason}")
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken:
        return replace(level_run, failure=f"not finite: {', '.join(broken)}")
    measured = measure(trace, scene, min(wall))
    values = {name: measured.get(name) for name in SCALARS}
    errors = {} if reference is None else errors_against(trace, values, reference, scene)
    return replace(level_run, values=values, errors=errors)


def _timed(call: Callable[[], Trace], repeats: int) -> tuple[list[float], list[float], Trace]:
    """Wall and processor seconds of up to ``repeats`` runs, and the answer, which is the same each time."""
    wall: list[float] = []
    cpu: list[float] = []
    while True:
        begin, spent = time.perf_counter(), time.process_time()
        trace = call()
        wall.append(time.perf_counter() - begin)
        cpu.append(time.process_time() - spent)
        if len(wall) >= repeats or sum(wall) > ENOUGH_SECONDS:
            return wall, cpu, trace


def errors_against(
    trace: Trace, values: dict[str, float | None], reference: Trace, scene: Scene
) -> dict[str, float]:
    """Signed relative errors of the scalars of a run, and norms of its curves (:data:`NORMS`)."""
    runs = (
        Run("", "", trace, measures=values),
        Run("", "", reference, measures=measure(reference, scene, 0.0)),
    )
    located = [name for name in SCALARS if is_located(name, reference, scene.loading)]
    errors = {one.quantity: one.error for one in of_numbers(*runs, located) if math.isfinite(one.error)}
    force, radius = distance(trace, reference, "force"), distance(trace, reference, "contact_radius")
    if force is not None and radius is not None:
        norms = (force.rms, force.mean, force.largest, radius.rms)
        errors |= dict(zip(NORMS, norms, strict=True))
    return errors


def scales(reference: Trace, scene: Scene) -> dict[str, float]:
    """What errors are relative to, by observable (see :mod:`validation.measure.scaling`)."""
    largest = Magnitudes.of_trace(reference)
    sizes = {}
    for name, value in measure(reference, scene, 0.0).items():
        if name not in SCALARS or value is None:
            continue
        if not is_located(name, reference, scene.loading):
            continue
        sizes[name] = largest.scale(name, value) or 1.0
    return sizes


def read(ladder: Ladder, runs: tuple[LevelRun, ...], reference_scales: dict[str, float]) -> Convergence:
    """Orders, extrapolations and bounds of every observable of a ladder.

    Without a reference an observable is relative to its own finest value.

    Parameters
    ----------
    ladder : Ladder
    runs : tuple of LevelRun
        By level, the coarsest first.
    reference_scales : dict of str to float
        What errors are relative to, by observable (:func:`scales`); empty without a reference.

    Returns
    -------
    Convergence
    """
    nominal = ladder.nominal or schemes.scheme(ladder.scheme).nominal
    sizes = [run.level.size for run in runs]
    rows = []
    for name in (*SCALARS, *NORMS):
        values = tuple(run.values.get(name) for run in runs)
        errors = tuple(run.errors.get(name) for run in runs)
        if all(entry is None for entry in (*values, *errors)):
            continue
        known = [abs(value) for value in values if value]
        size = reference_scales.get(name) or (known[-1] if known else 1.0)
        alone = None if name in NORMS else extrapolate(sizes, values, nominal, size)
        relative = [None if error is None else abs(error) for error in errors]
        orders = reference_orders(sizes, errors)
        rows.append(Row(name, values, errors, orders, fitted_slope(sizes, relative), size, alone))
    return Convergence(ladder, nominal, runs, tuple(rows))
