"""``solve(scene, options) -> Trace``: the paper's boundary-element solver.

Penetration and surface displacement positive downwards, force and pressure positive in compression, radii
from the axis; units of the scene.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_solver.control import GradedState, StepSettings
from bem_solver.creep import surface_material
from bem_solver.loop import GradedRun
from bem_solver.options import Options
from bem_solver.paper_scheme.solver import refusal_of_uniform, solve_uniform
from bem_solver.problem import Problem
from bem_solver.recorder import GradedRecord, trace_without_start
from bem_solver.size_estimates import discretised
from bem_solver.start import start_state
from contact_scene import (
    Counters,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    Trace,
)
from contact_scene.machine import on_machine
from contact_scene.run_control import LoadingCursor, follow_loading, outcome_of_loss, single_threaded


@single_threaded()
def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    monitor: RunMonitor | None = None,
) -> Trace:
    """Solve a scene with the boundary-element method of the paper.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable, optional
        Called with the share of the run that is done, 0 to 1.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue.

    Returns
    -------
    Trace
        ``outcome`` says how the run ended; a run that could not finish keeps what it computed.

    Raises
    ------
    UnsupportedScene
        Where uniform annuli would be too many, or the body is a layer.
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    options = options or Options()
    scene = replace(scene, material=surface_material(scene.material))
    unsupported = refusal_of_uniform(scene) if options.annuli == "uniform" else None
    if unsupported is not None:
        raise unsupported
    began = clock.perf_counter()
    run = solve_uniform if options.annuli == "uniform" else _solve_graded
    with np.errstate(all="ignore"):  # non-finite numbers are looked for where state is committed
        trace = run(scene, options, progress, monitor)
    outcome = outcome_of_loss(trace.outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    return replace(trace, outcome=outcome, wall_seconds=clock.perf_counter() - began)


def _solve_graded(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    counters, cursor = Counters(factorisations=1), LoadingCursor()
    try:
        problem, scale = discretised(scene, options, counters)
        state = _started(problem, scale)
    except (ZeroDivisionError, OverflowError) as error:
        return _without_start(scene, counters, _beyond_floating_point(error))
    if state is None:
        return _without_start(scene, counters, scene.loading.without_start)
    settings = StepSettings(options.step_tolerance, options.divisions, scale)
    run = GradedRun(problem, settings, options.max_steps, cursor, state, monitor)
    try:
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except FloatingPointError as error:
        outcome = Outcome(OutcomeKind.NOT_FINITE, str(error), state.contact.time)
    except (ZeroDivisionError, OverflowError) as error:
        outcome = Outcome(OutcomeKind.OUT_OF_RANGE, _beyond_floating_point(error), state.contact.time)
    trace = state.record.trace(problem, outcome)
    return on_machine(trace, scene.machine)


def _started(problem: Problem, scale: float) -> GradedState | None:
    """The state at the start, and its row of the trace; ``None`` without a stable contact."""
    contact = start_state(problem, scale)
    if contact is None:
        return None
    record = GradedRecord()
    record.row(contact)
    return GradedState(contact, record, abs(contact.surface.force), contact.edge)


def _without_start(scene: Scene, counters: Counters, reason: str) -> Trace:
    """The trace of a scene that has no state to start from."""
    return on_machine(trace_without_start(reason, counters), scene.machine)


def _beyond_floating_point(error: ArithmeticError) -> str:
    """Why a run ends in which a number overflows or loses its meaning."""
    return f"a number is beyond the range of floating point ({error})"
