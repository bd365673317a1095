"""``solve(scene, options) -> Trace``: the paper's boundary-element solver.

Penetration and surface displacement positive downwards, force and pressure positive in compression, radii
from the axis; units of the scene.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_solver.annuli import Annuli
from bem_solver.closure import ClosureRule
from bem_solver.creep import Chain
from bem_solver.loading_intervals import follow_loading
from bem_solver.options import Options
from bem_solver.paper_scheme.solver import refusal_of_uniform, solve_uniform
from bem_solver.problem import LONG_ZONE, Problem
from bem_solver.recorder import TraceRecorder, trace_without_start
from bem_solver.run_state import GradedState, StepSettings
from bem_solver.size_estimates import (
    FEWEST_ANNULI,
    annuli_needed,
    edge_step,
    graded_annuli,
    largest_contact,
    thinnest_layer,
)
from bem_solver.start import contact_scale, start_state
from bem_solver.stepping import GradedRun
from contact_scene import (
    Adhesion,
    Cone,
    Counters,
    Indenter,
    Outcome,
    OutcomeKind,
    PowerLaw,
    RunMonitor,
    Scene,
    Trace,
    UnsupportedScene,
)
from contact_scene.machine import on_machine
from contact_scene.run_control import LoadingCursor, outcome_of_loss, single_threaded

_SMOOTH_SHARE = 0.01
"""Part of the largest radius that is resolved where nothing varies faster than over the radius, but for the
root at the edge, which is taken out: without adhesion, and in an elastic contact, whatever its zone."""

_FINER_OF_LONG_ZONE = 2
"""By how much annuli are finer at the centre where the zone is long: fields vary over a few zones there."""


def refusal(scene: Scene) -> UnsupportedScene | None:
    """Why the boundary elements do not take a scene; ``None`` if they do."""
    if scene.material.bulk is None:
        return None
    return UnsupportedScene(
        "material.bulk",
        "the boundary elements assume a constant Poisson's ratio",
        "no bulk key, or --solver reference or fem",
    )


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
        For a bulk modulus that relaxes apart from shear: the half-space is then no longer a convolution in
        time with one kernel in space (Eq. convolution). Also where uniform annuli would be too many.
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    options = options or Options()
    unsupported = refusal(scene) or (refusal_of_uniform(scene) if options.annuli == "uniform" else None)
    if unsupported is not None:
        raise unsupported
    began = clock.perf_counter()
    if options.annuli == "uniform" and scene.adhesion is not None:
        _check_paper_adhesion(scene.adhesion)
    run = solve_uniform if options.annuli == "uniform" else _solve_graded
    with np.errstate(all="ignore"):  # non-finite numbers are looked for where state is committed
        trace = run(scene, options, progress, monitor)
    outcome = outcome_of_loss(trace.outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    return replace(trace, outcome=outcome, wall_seconds=clock.perf_counter() - began)


def _check_paper_adhesion(adhesion: Adhesion) -> None:
    """Refuse what the paper's own discretisation leaves out."""
    for key in ("work_closing", "rate", "stress"):
        if getattr(adhesion, key) is not None:
            raise UnsupportedScene(
                f"adhesion.{key}",
                "uniform annuli know one work of adhesion and one process zone",
                'annuli "graded"',
            )


def _solve_graded(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    counters, cursor = Counters(factorisations=1), LoadingCursor()
    try:
        problem, scale = _discretised(scene, options, counters)
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
    trace = state.record.trace(outcome, counters, problem.work, problem.irreversible is None)
    return on_machine(trace, scene.machine)


def _started(problem: Problem, scale: float) -> GradedState | None:
    """The state at the start, and its row of the trace; ``None`` without a stable contact."""
    started = start_state(problem, scale)
    if started is None:
        return None
    contact, energies = started
    record = TraceRecorder(
        shortest=float(problem.chain.relaxation.min(initial=math.inf)), retardation=problem.chain.retardation
    )
    record.row(problem.chain, contact, energies)
    return GradedState(contact, energies, record, abs(contact.surface.force), contact.edge)


def _without_start(scene: Scene, counters: Counters, reason: str) -> Trace:
    """The trace of a scene that has no state to start from."""
    return on_machine(trace_without_start(reason, counters), scene.machine)


def _beyond_floating_point(error: ArithmeticError) -> str:
    """Why a run ends in which a number overflows or loses its meaning."""
    return f"a number is beyond the range of floating point ({error})"


def _exponent(indenter: Indenter) -> float:
    """Exponent of the indenter's profile; 2, the smooth one, where it has none."""
    match indenter:
        case Cone():
            return 1.0
        case PowerLaw():
            return indenter.exponent
    return 2.0


def _discretised(scene: Scene, options: Options, counters: Counters) -> tuple[Problem, float]:
    """The problem on annuli that resolve process zone and boundary layer, and the scale of its contact."""
    chain = Chain(scene.material, options.scheme == "backward-euler")
    adhesion = scene.adhesion if scene.is_adhesive else None
    zone, work = (adhesion.zone, adhesion.work) if adhesion else (0.0, 0.0)
    divisions = options.divisions
    rule = ClosureRule.resolving(divisions)
    coarse = Problem(scene, Annuli(FEWEST_ANNULI), chain, zone, work, 1.0, Counters(), rule)
    initial = contact_scale(scene, scene.loading.penetration)
    largest = largest_contact(scene, coarse) or initial
    layer = 0.0
    if zone > 0.0 and largest > 0.0 and len(chain):
        share = min(zone / largest, 1.0)
        layer = thinnest_layer(scene, chain, largest, zone, divisions)
        step = edge_step(divisions, share, largest, layer)
        finer = 1 if zone < LONG_ZONE * largest else _FINER_OF_LONG_ZONE
        annuli = Annuli(*graded_annuli(finer * divisions, step), _exponent(scene.indenter))
        at_edge = np.arccos(1.0 - share) / step  # more than the annuli in the zone where they resolve a layer
        rule = ClosureRule.resolving(int(max(annuli.number_within(share), at_edge)))
    else:
        annuli = Annuli(annuli_needed(divisions, _SMOOTH_SHARE), exponent=_exponent(scene.indenter))
    problem = Problem(scene, annuli, chain, zone, work, zone or 0.01 * largest, counters, rule, layer)
    return problem, max(largest, initial)
