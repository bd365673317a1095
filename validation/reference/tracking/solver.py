"""``solve(scene, options) -> Trace`` by front tracking.

Signs and units are the scene's: penetration and pressure positive downwards and in compression.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import (
    COLUMNS,
    Counters,
    Event,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    SurfaceProfile,
    Trace,
    UnsupportedScene,
)
from contact_scene.machine import machine_columns
from contact_scene.run_control import outcome_of_loss, single_threaded
from validation.reference.tracking.equilibrium import start_surface
from validation.reference.tracking.estimate import estimated_errors
from validation.reference.tracking.located import extrema
from validation.reference.tracking.options import Fineness, Options
from validation.reference.tracking.problem import FrontProblem, front_problem, with_elastic_travel
from validation.reference.tracking.recorder import EXTRA_COLUMNS
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step import RowTolerances
from validation.reference.tracking.stepping import NAME, FrontStepper, beyond_floating_point
from validation.reference.tracking.surface import Surface

Array = NDArray[np.float64]

ROW_TOLERANCES = RowTolerances(1.0, 12.0)
"""Deviations from straight lines between the rows of a trace, in allowed deviations of a step."""
DENSE_ROW_TOLERANCES = RowTolerances(0.25, 0.25)
"""The same for the coarser run of an error estimate, whose curves another run is compared with."""


def refusal(scene: Scene) -> UnsupportedScene | None:
    """Why front tracking does not take a scene; ``None`` if it does."""
    if scene.material.bulk is None:
        return None
    return UnsupportedScene(
        "material.bulk",
        "the Abel transform needs bulk and shear to relax alike",
        "no bulk entry, or the finite-element solver",
    )


@single_threaded()
def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    monitor: RunMonitor | None = None,
) -> Trace:
    """Run a scene.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable(fraction), optional
        Called after each step with the share of the loading that is done.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue; not in the second run for error estimates.

    Returns
    -------
    Trace
        Extra columns ``stress_intensity_factor``, ``energy_release_rate``, ``branch_dissipation``. Curved
        steps have interpolated rows, by cubics in time, so that straight lines through the rows are accurate
        to the tolerance (to 12 tolerances under a sinusoidal load). If contact is lost the last row is the
        free surface (force and radius 0) at the time of the row before, unless a given force takes the
        indenter with it: what that works no row can tell. If contact shrinks to the process zone the
        last row is the contact as long as the zone.

    Raises
    ------
    UnsupportedScene
        Separate bulk relaxation: the Abel transform does not make local.
    SceneError
        A process zone longer than the contact it starts from.
    """
    options = options or Options()
    began = time.perf_counter()
    unsupported = refusal(scene)
    if unsupported is not None:
        raise unsupported
    fineness = options.fineness(scene.is_adhesive)
    result = _run(scene, options, fineness, ROW_TOLERANCES, progress, monitor)
    errors: dict[str, float] = {}
    if options.estimate_errors and result.outcome.finished:
        stops = replace(options, stop_times=options.stop_times + options.profile_times, profile_times=())
        coarser = _run(scene, stops, fineness.coarser(), DENSE_ROW_TOLERANCES, start=result.start)
        kinds = {result.outcome.kind, coarser.outcome.kind}
        detached = kinds == {OutcomeKind.DETACHED}
        if coarser.outcome.kind is not OutcomeKind.BREAKDOWN:
            ratio = result.counters.steps / max(coarser.counters.steps, 1)
            point = scene.ends_in_a_point
            errors = estimated_errors(result.columns, coarser.columns, ratio, detached, point)
    return Trace(
        solver=NAME,
        **{name: result.columns[name] for name in COLUMNS},
        outcome=result.outcome,
        counters=result.counters,
        extra={name: column for name, column in result.columns.items() if name not in COLUMNS},
        events=tuple(result.events),
        located=tuple(extrema(result.columns, result.extrema)),
        profiles=tuple(result.profiles),
        errors=errors,
        wall_seconds=time.perf_counter() - began,
    )


@dataclass(frozen=True)
class _Result:
    """What a run has computed.

    ``start``: the surface it has started from.
    """

    columns: dict[str, Array]
    outcome: Outcome
    counters: Counters = field(default_factory=Counters)
    events: list[Event] = field(default_factory=list)
    extrema: list[float] = field(default_factory=list)
    profiles: list[SurfaceProfile] = field(default_factory=list)
    start: Surface | None = None


def _run(
    scene: Scene,
    options: Options,
    fineness: Fineness,
    row_tolerances: RowTolerances,
    progress: Callable[[float], None] | None = None,
    monitor: RunMonitor | None = None,
    start: Surface | None = None,
) -> _Result:
    """A run; ``start`` is the surface it starts from, if it is known."""
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        try:
            problem = front_problem(scene, fineness)
            stepper = _stepper(problem, options, row_tolerances, progress, monitor, start)
        except ArithmeticError as error:
            return _Result(_no_rows(), beyond_floating_point(error, 0.0))
        if isinstance(stepper, Outcome):
            return _Result(_no_rows(), stepper)
        begun = stepper.state.surface
        outcome = stepper.run()
    interrupted = outcome.kind is OutcomeKind.INTERRUPTED
    with np.errstate(all="ignore"):
        columns = stepper.recorder.columns(whole=not interrupted)
    machine = scene.machine
    if machine is not None and machine.compliance > 0.0:
        columns |= machine_columns(columns, machine, stepper.state.events)
    columns, outcome = _finite_rows(columns, outcome)
    outcome = outcome_of_loss(outcome, scene.is_adhesive, columns["penetration"], columns["contact_radius"])
    if interrupted:
        outcome = replace(outcome, time=float(columns["time"][-1]))
    state = stepper.state
    return _Result(columns, outcome, state.counters, state.events, state.extrema, state.profiles, begun)


def _stepper(
    problem: FrontProblem,
    options: Options,
    row_tolerances: RowTolerances,
    progress: Callable[[float], None] | None,
    monitor: RunMonitor | None,
    start: Surface | None,
) -> FrontStepper | Outcome:
    """A run at its start; its outcome if there is no state to start from."""
    scene = problem.scene
    surface = start or start_surface(scene, problem.body, problem.condition)
    if surface is None:
        return Outcome(OutcomeKind.NO_EQUILIBRIUM, scene.loading.without_start, 0.0)
    problem = with_elastic_travel(problem, surface.radius)
    state = FrontState(
        surface,
        force=surface.force(problem.body),
        largest_radius=problem.radius,
        largest_force=problem.force,
        largest_depth=problem.depth,
        travel=problem.longest_travel(surface.radius),
        displaced_to=surface.radius,
    )
    return FrontStepper(problem, options, row_tolerances, state, progress=progress, monitor=monitor)


def _no_rows() -> dict[str, Array]:
    return {name: np.empty(0) for name in (*COLUMNS, *EXTRA_COLUMNS)}


def _finite_rows(columns: dict[str, Array], outcome: Outcome) -> tuple[dict[str, Array], Outcome]:
    """The rows before the first that is beyond the range of floating point in one of its columns."""
    finite = np.logical_and.reduce([np.isfinite(column) for column in columns.values()])
    if finite.all():
        return columns, outcome
    first = int(np.argmin(finite))
    reason = "energies are beyond the range of floating point"
    failure = Outcome(OutcomeKind.OUT_OF_RANGE, reason, float(columns["time"][first]))
    return {name: column[:first] for name, column in columns.items()}, failure
